#include "collision_node/geometry/bvh.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>

#include "collision_node/geometry/grid_order.h"
#include "collision_node/geometry/round_to_float.h"

namespace collision_node::geometry {
namespace {

/// Entries [begin, end) and the box around them.
struct Range {
  std::uint32_t begin, end;
  std::int32_t known;  ///< how the grid splits them
  RegisterBox box;

  std::uint32_t count() const { return end - begin; }
};

/// Boxes of the entries of a range, by where their centres lie along the range's longest axis.
class Bins {
 public:
  Bins(const RegisterBox& all, const Entry* entries, std::uint32_t held)
      : axis_(all.longestAxis()), count_(held < 32 ? 8 : kMost), low_(2.0F * all.lower[axis_]) {
    const float extent = 2.0F * (all.upper[axis_] - all.lower[axis_]);
    scale_ = static_cast<float>(count_) / extent;
    if (!(scale_ < RegisterBox::kFar)) scale_ = 0.0F;
    std::fill(box_, box_ + count_, RegisterBox::none());
    std::fill(held_, held_ + count_, 0U);
    for (std::uint32_t i = 0; i < held; ++i) {
      const int bin = of(entries[i]);
      box_[bin].add(entries[i].box);
      ++held_[bin];
    }
  }

  int axis() const { return axis_; }
  int of(const Entry& e) const {
    return std::clamp(static_cast<int>((e.box.twiceCentre(axis_) - low_) * scale_), 0, count_ - 1);
  }

  /// Splits `range`, which they were made from, where area times number is smallest, and returns the last bin
  /// of the first half; < 0: all are in one bin.
  int cut(Range& range, Range& behind) const {
    RegisterBox after[kMost];  // everything in bin b and behind it
    after[count_ - 1] = box_[count_ - 1];
    for (int b = count_ - 2; b > 0; --b) {
      after[b] = after[b + 1];
      after[b].add(box_[b]);
    }
    RegisterBox sweep = RegisterBox::none();
    const std::uint32_t all = range.count();
    std::uint32_t count = 0, left = 0;
    int best_bin = -1;
    float best = RegisterBox::kFar;
    for (int b = 0; b + 1 < count_; ++b) {
      sweep.add(box_[b]);
      count += held_[b];
      if (count == 0 || count == all) continue;
      const float cost = static_cast<float>(count) * sweep.halfArea() +
                         static_cast<float>(all - count) * after[b + 1].halfArea();
      if (cost < best) {
        best = cost;
        best_bin = b;
        left = count;
        range.box = sweep;
        behind.box = after[b + 1];
      }
    }
    behind.begin = range.begin + left;
    behind.end = range.end;
    behind.known = GridOrder::kNone;
    if (best_bin >= 0) range.end = behind.begin;
    return best_bin;
  }

 private:
  static constexpr int kMost = 16;

  int axis_, count_;
  float low_, scale_;
  RegisterBox box_[kMost];
  std::uint32_t held_[kMost];
};

/// Makes blocks depth first.
class Builder {
 public:
  Builder(Entry* entries, const Elements& elements, const GridOrder& grid, std::vector<BvhBlock>& blocks)
      : entries_(entries), aside_(new Entry[grid.largestCell()]), grid_(grid), blocks_(blocks) {
    for (int k = 0; k < 3; ++k) {
      near_origin_[k] = static_cast<float>(elements.origin()[k]);
      origin_error_[k] = std::abs(near_origin_[k]) * 0x1p-22F;
    }
    // Surfaces need 0.38 to 0.4 blocks an element: memory is asked for, and touched, once.
    blocks_.reserve(elements.size() * 2 / 5 + 8);
    const Range all{0, static_cast<std::uint32_t>(elements.size()), grid.root(), elements.around()};
    blocks_.emplace_back();
    setBoxes(0, 1, [&](int) -> const RegisterBox& { return all.box; });
    const std::int32_t link = linkOf(all);
    blocks_[0].link[0] = link;
  }

 private:
  static constexpr int kWidth = BvhBlock::kWidth;
  static constexpr std::uint32_t kFew = 16;

  /// Sets the boxes, and the reaches, of a block's first `count` lanes.
  ///
  /// A difference or a sum of two floats is off by 2^-24 of itself at most, and the origin, as a float, by
  /// that of itself: each is given four times that. What the images are off by comes on top.
  template <typename BoxOf>
  void setBoxes(std::int32_t block, int count, const BoxOf& box_of) {
    BvhBlock& b = blocks_[static_cast<std::size_t>(block)];
    FourFloats low[4] = {}, high[4] = {};
    for (int lane = 0; lane < count; ++lane) {
      low[lane] = box_of(lane).lower;
      high[lane] = box_of(lane).upper;
    }
    transpose(low);
    transpose(high);
    double reach2[kWidth] = {};
    for (int k = 0; k < 3; ++k) {
      const FourFloats centre = 0.5F * low[k] + 0.5F * high[k];
      const FourFloats error =
          larger(high[k], -low[k]) * Elements::kRounding + (FourFloats{} + Elements::kLeast);
      FourFloats half = larger(high[k] - centre, centre - low[k]);
      half += half * 0x1p-22F + error;
      const FourFloats far =
          larger(near_origin_[k] + high[k], -(near_origin_[k] + low[k])) + (error + origin_error_[k]);
      storeFour(b.centre[k], centre);
      storeFour(b.half[k], half);
      for (int lane = 0; lane < kWidth; ++lane)
        reach2[lane] += static_cast<double>(far[lane]) * static_cast<double>(far[lane]);
    }
    for (int lane = 0; lane < kWidth; ++lane)
      b.reach[lane] = roundedUp(std::sqrt(reach2[lane]) * (1.0 + 0x1p-22));
    std::memset(b.plate_middle, 0, sizeof b.plate_middle + sizeof b.plate_half + sizeof b.plate);
    for (int lane = count; lane < kWidth; ++lane) {
      for (float(&half)[kWidth] : b.half) half[lane] = -0.25F * std::numeric_limits<float>::max();
      b.reach[lane] = 0.0F;
      b.link[lane] = -1;
    }
  }

  std::int32_t linkOf(const Range& range) {
    if (range.count() == 1) return ~static_cast<std::int32_t>(range.begin);
    return range.count() <= kWidth ? leaves(range) : split(range);
  }

  std::int32_t addBlock() {
    blocks_.emplace_back();
    return static_cast<std::int32_t>(blocks_.size()) - 1;
  }

  /// A block of leaves, one for each entry.
  std::int32_t leaves(const Range& range) {
    const std::int32_t block = addBlock();
    const int count = static_cast<int>(range.count());
    for (int lane = 0; lane < count; ++lane)
      blocks_.back().link[lane] = ~(static_cast<std::int32_t>(range.begin) + lane);
    setBoxes(block, count, [&](int lane) -> const RegisterBox& { return entries_[range.begin + lane].box; });
    return block;
  }

  /// A block of two to four nodes for the range: the largest is halved until there are four.
  std::int32_t split(const Range& range) {
    Range ranges[kWidth] = {range, {}, {}, {}};
    int count = 1;
    while (count < kWidth) {
      int largest = -1;
      float area = 0.0F;
      for (int i = 0; i < count; ++i) {
        if (ranges[i].count() <= kWidth) continue;  // a block of leaves stays together
        const float own = ranges[i].box.halfArea();
        if (largest >= 0 && !(own > area)) continue;
        largest = i;
        area = own;
      }
      if (largest < 0) break;
      halve(ranges[largest], ranges[count++]);
    }
    const std::int32_t block = addBlock();
    setBoxes(block, count, [&](int lane) -> const RegisterBox& { return ranges[lane].box; });
    for (int i = 0; i < count; ++i) {
      const std::int32_t link = linkOf(ranges[i]);
      blocks_[static_cast<std::size_t>(block)].link[i] = link;
    }
    return block;
  }

  /// Leaves the first half in `range`, puts the other into `behind`.
  void halve(Range& range, Range& behind) {
    if (range.count() <= kFew) {
      halveFew(range, behind);
    } else if (range.known != GridOrder::kNone) {
      halveAsKnown(range, behind);
    } else {
      const Bins bins(range.box, &entries_[range.begin], range.count());
      const int last = bins.cut(range, behind);
      if (last >= 0) {
        partition(range, behind, bins, last);
      } else {
        halveByCount(range, behind, bins.axis());
      }
    }
  }

  void halveAsKnown(Range& range, Range& behind) const {
    const GridOrder::Split& split = grid_[range.known];
    const auto middle = static_cast<std::uint32_t>(split.middle);
    behind = {middle, range.end, split.below[1], split.box[1]};
    range = {range.begin, middle, split.below[0], split.box[0]};
  }

  /// Those of the second half go aside; which half it is costs no branch.
  void partition(const Range& range, const Range& behind, const Bins& bins, int last) {
    Entry* to[2] = {&entries_[range.begin], aside_.get()};
    for (std::uint32_t i = range.begin; i < behind.end; ++i) {
      const int half = bins.of(entries_[i]) > last;
      *to[half]++ = entries_[i];
    }
    std::copy(aside_.get(), to[1], &entries_[behind.begin]);
  }

  /// Few elements: the best of the places that leave whole blocks of leaves, so that lanes and memory are not
  /// spent on nothing.
  void halveFew(Range& range, Range& behind) {
    const std::uint32_t count = range.count();
    Entry* const e = &entries_[range.begin];
    Entry sorted[kFew];
    sortFew(e, count, range.box.longestAxis(), sorted);
    RegisterBox after[kFew / kWidth + 1];  // everything from entry i kWidth on
    RegisterBox box = RegisterBox::none();
    for (std::uint32_t i = count; i-- > kWidth;) {
      box.add(sorted[i].box);
      e[i] = sorted[i];
      if (i % kWidth == 0) after[i / kWidth] = box;
    }
    box = RegisterBox::none();
    float best = RegisterBox::kFar;
    behind.begin = range.begin;
    for (std::uint32_t left = kWidth; left < count; left += kWidth) {
      for (std::uint32_t i = left - kWidth; i < left; ++i) box.add(sorted[i].box);
      const float cost = static_cast<float>(left) * box.halfArea() +
                         static_cast<float>(count - left) * after[left / kWidth].halfArea();
      if (behind.begin != range.begin && !(cost < best)) continue;
      best = cost;
      behind.begin = range.begin + left;
      behind.box = after[left / kWidth];
      range.box = box;
    }
    for (std::uint32_t i = 0; i < kWidth; ++i) e[i] = sorted[i];
    behind.end = range.end;
    behind.known = GridOrder::kNone;
    range.end = behind.begin;
  }

  /// Counts for each how many come first, without a branch; of equals the one that is first already.
  static void sortFew(const Entry* e, std::uint32_t count, int axis, Entry sorted[kFew]) {
    constexpr int kWords = kFew / kWidth;
    typedef std::int32_t Words __attribute__((vector_size(16)));
    alignas(16) float at[kFew];
    std::fill(at, at + kFew, RegisterBox::kFar);
    for (std::uint32_t i = 0; i < count; ++i) {
      const float own = e[i].box.twiceCentre(axis);
      at[i] = own == own ? own : 0.0F;  // from one end of the floats to the other: no number
    }
    FourFloats all[kWords];
    for (int w = 0; w < kWords; ++w) all[w] = loadFour(at + kWidth * w);
    for (std::uint32_t i = 0; i < count; ++i) {
      const FourFloats own = FourFloats{} + at[i];
      const auto number = static_cast<std::int32_t>(i);
      Words before = {}, place = {0, 1, 2, 3};
      for (int w = 0; w < kWords; ++w, place += kWidth)
        before -= (all[w] < own) | ((all[w] == own) & (place < number));
      sorted[before[0] + before[1] + before[2] + before[3]] = e[i];
    }
  }

  /// A total order: the same tree everywhere.
  void halveByCount(Range& range, Range& behind, int axis) {
    const std::uint32_t middle = range.begin + range.count() / 2;
    std::nth_element(&entries_[range.begin], &entries_[middle], &entries_[range.begin] + range.count(),
                     [axis](const Entry& x, const Entry& y) {
                       const float a = x.box.twiceCentre(axis), b = y.box.twiceCentre(axis);
                       return a != b ? a < b : x.element() < y.element();
                     });
    behind = {middle, range.end, GridOrder::kNone, RegisterBox::none()};
    range.end = middle;
    for (Range* half : {&range, &behind}) {
      half->box = RegisterBox::none();
      for (std::uint32_t i = half->begin; i < half->end; ++i) half->box.add(entries_[i].box);
    }
  }

  Entry* const entries_;
  const std::unique_ptr<Entry[]> aside_;  ///< room for what nothing is known of
  const GridOrder& grid_;
  FourFloats near_origin_ = {}, origin_error_ = {};
  std::vector<BvhBlock>& blocks_;
};

}  // namespace

Bvh::Bvh(const std::vector<Vec3>& vertices, const std::vector<Triangle>& triangles,
         const std::vector<Bounds>& others, std::vector<std::int32_t>& order) {
  const Elements elements(vertices, triangles, others);
  origin_ = elements.origin();
  const std::unique_ptr<Entry[]> entries(new Entry[elements.size()]);
  {
    const GridOrder grid(elements, entries.get());
    Builder(entries.get(), elements, grid, blocks_);
  }
  if (blocks_.capacity() > blocks_.size() + blocks_.size() / 32) blocks_.shrink_to_fit();

  // Leaves have the places of their entries.
  order.reserve(triangles.size());
  std::vector<std::int32_t> id_at;
  for (std::size_t i = 0; i < elements.size(); ++i) {
    const std::int32_t element = entries[i].element();
    const bool triangle = static_cast<std::size_t>(element) < triangles.size();
    if (!others.empty()) id_at.push_back(triangle ? static_cast<std::int32_t>(order.size()) : element);
    if (triangle) order.push_back(element);
  }
  if (others.empty()) return;
  for (BvhBlock& block : blocks_) {
    for (int i = 0; i < BvhBlock::kWidth; ++i) {
      if (block.half[0][i] >= 0.0F && block.link[i] < 0)
        block.link[i] = ~id_at[static_cast<std::size_t>(~block.link[i])];
    }
  }
}

/// The centre is the origin, exactly; half extents and reach are rounded up twice, as doubles and as floats.
void Bvh::replaceOnly(const Bounds& box) {
  origin_ = 0.5 * (box.lower + box.upper);
  const Vec3 half = (box.upper - origin_).cwiseMax(origin_ - box.lower) * (1.0 + 0x1p-50);
  BvhBlock& root = blocks_.front();
  for (int k = 0; k < 3; ++k) {
    root.centre[k][0] = 0.0F;
    root.half[k][0] = roundedUp(half[k]);
  }
  root.reach[0] = roundedUp(box.lower.cwiseAbs().cwiseMax(box.upper.cwiseAbs()).norm() * (1.0 + 0x1p-50));
}

bool Bvh::exists(std::int32_t node) const { return (*this)[node].half[0] >= 0.0F; }

Vec3 Bvh::centre(std::int32_t node) const {
  const BvhNode n = (*this)[node];
  return origin_ + Vec3(n.centre[0], n.centre[1], n.centre[2]);
}

Vec3 Bvh::half(std::int32_t node) const {
  const BvhNode n = (*this)[node];
  return {n.half[0], n.half[1], n.half[2]};
}

}  // namespace collision_node::geometry

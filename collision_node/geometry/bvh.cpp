#include "collision_node/geometry/bvh.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "collision_node/geometry/grid_order.h"
#include "collision_node/geometry/round_to_float.h"

namespace collision_node::geometry {
namespace {

/// Boxes of the entries of a range, by where their centres lie along the range's longest axis.
struct Bins {
  static constexpr int kMost = 16;
  int axis = 0, count = 0;  ///< count 0: not used
  float low = 0.0F, scale = 0.0F;
  RegisterBox box[kMost];
  std::int32_t held[kMost];

  void prepare(const RegisterBox& all, std::size_t entries) {
    axis = all.longestAxis();
    low = 2.0F * all.lower[axis];
    const float extent = 2.0F * (all.upper[axis] - all.lower[axis]);
    count = entries < 32 ? 8 : kMost;
    scale = static_cast<float>(count) / extent;
    if (!(scale < RegisterBox::kFar)) scale = 0.0F;
    std::fill(box, box + count, RegisterBox());
    std::fill(held, held + count, 0);
  }
  int of(const Entry& e) const {
    return std::clamp(static_cast<int>((e.box.twiceCentre(axis) - low) * scale), 0, count - 1);
  }
  void add(const Entry& e) {
    const int bin = of(e);
    box[bin].add(e.box);
    ++held[bin];
  }
};

/// Entries [begin, end) and the box around them.
struct Part {
  std::size_t begin = 0, end = 0;
  RegisterBox box;

  std::size_t count() const { return end - begin; }
};

/// Many entries, and how they lie in the box; not counted where a split is known.
struct Range : Part {
  std::int32_t known = GridOrder::kNone;
  Bins bins;
};

/// Makes blocks depth first. Each level reads the entries once: what goes to a half is counted into the
/// half's own bins on the way. `holds(node, begin, end)` is told which entries a node holds.
template <typename Holds>
class Builder {
 public:
  Builder(std::vector<Entry>& entries, const Vec3& origin, std::vector<BvhBlock>& blocks, Holds holds)
      : entries_(entries), aside_(entries.size()), blocks_(blocks), holds_(std::move(holds)) {
    for (int k = 0; k < 3; ++k) {
      near_origin_[k] = static_cast<float>(origin[k]);
      origin_error_[k] = std::abs(near_origin_[k]) * 0x1p-22F;
    }
    blocks_.reserve(entries.size() / 2 + 2);
    Range all;
    all.end = entries.size();
    for (const Entry& e : entries) all.box.add(e.box);
    const GridOrder grid(entries_, aside_, all.box);
    grid_ = &grid;
    all.known = grid.root();
    countBins(all);
    addBlock();
    setNode(0, 0, all);
  }

 private:
  static constexpr std::size_t kWidth = BvhBlock::kWidth, kFew = 16;

  std::int32_t addBlock() {
    static const BvhBlock empty = [] {
      BvhBlock block{};
      for (float(&half)[BvhBlock::kWidth] : block.half)
        std::fill(half, half + BvhBlock::kWidth, -0.25F * std::numeric_limits<float>::max());
      std::fill(block.link, block.link + BvhBlock::kWidth, -1);
      return block;
    }();
    blocks_.push_back(empty);
    return static_cast<std::int32_t>(blocks_.size()) - 1;
  }

  /// Sets box and reach. A difference or a sum of two floats is off by 2^-24 of itself at most, and the
  /// origin, as a float, by that of itself. Each is given four times that.
  void setBox(std::int32_t block, int lane, const RegisterBox& box, std::size_t begin, std::size_t end) {
    holds_(BvhBlock::kWidth * block + lane, begin, end);
    const FourFloats centre = 0.5F * box.lower + 0.5F * box.upper;
    const FourFloats above = box.upper - centre, below = centre - box.lower;
    FourFloats half = above > below ? above : below;
    half += half * 0x1p-22F;
    const FourFloats lower = near_origin_ + box.lower, upper = near_origin_ + box.upper;
    const FourFloats far = (upper > -lower ? upper : -lower) + origin_error_;
    BvhBlock& b = blocks_[block];
    double reach2 = 0.0;
    for (int k = 0; k < 3; ++k) {
      b.centre[k][lane] = centre[k];
      b.half[k][lane] = half[k];
      reach2 += static_cast<double>(far[k]) * static_cast<double>(far[k]);
    }
    b.reach[lane] = roundedUp(std::sqrt(reach2) * (1.0 + 0x1p-22));
  }

  /// Sets box, reach and link, and builds what lies below.
  template <typename Any>
  void setNode(std::int32_t block, int lane, Any& range) {
    setBox(block, lane, range.box, range.begin, range.end);
    const std::int32_t link = linkOf(range);
    blocks_[block].link[lane] = link;
  }
  std::int32_t linkOf(Range& range) {
    return range.count() > kFew ? split(range) : linkOf(static_cast<Part&>(range));
  }
  std::int32_t linkOf(Part& part) {
    if (part.count() == 1) return ~entries_[part.begin].element();
    return part.count() <= kWidth ? leaves(part) : split(part);
  }

  /// A block of leaves, one for each entry.
  std::int32_t leaves(const Part& range) {
    const std::int32_t block = addBlock();
    for (std::size_t i = range.begin; i < range.end; ++i) {
      const int lane = static_cast<int>(i - range.begin);
      setBox(block, lane, entries_[i].box, i, i + 1);
      blocks_[block].link[lane] = ~entries_[i].element();
    }
    return block;
  }

  /// A block of two to four nodes for the range: the largest is halved until there are four.
  template <typename Any>
  std::int32_t split(const Any& range) {
    Any ranges[BvhBlock::kWidth];
    ranges[0] = range;
    int count = 1;
    while (count < BvhBlock::kWidth) {
      int largest = -1;
      for (int i = 0; i < count; ++i) {
        if (ranges[i].count() > kWidth &&  // a block of leaves stays together
            (largest < 0 || ranges[i].box.halfArea() > ranges[largest].box.halfArea()))
          largest = i;
      }
      if (largest < 0) break;
      halve(ranges[largest], ranges[count++]);
    }
    const std::int32_t block = addBlock();
    for (int i = 0; i < count; ++i) setNode(block, i, ranges[i]);
    return block;
  }

  void countBins(Range& range) {
    if (range.count() <= kFew || range.known != GridOrder::kNone) return;
    range.bins.prepare(range.box, range.count());
    for (std::size_t i = range.begin; i < range.end; ++i) range.bins.add(entries_[i]);
  }

  /// Leaves the first half in `range`, puts the other into `behind`.
  void halve(Range& range, Range& behind) {
    if (range.count() <= kFew) {
      halve(static_cast<Part&>(range), static_cast<Part&>(behind));
    } else if (range.known != GridOrder::kNone) {
      halveAsKnown(range, behind);
    } else if (!halveByArea(range, behind)) {
      halveByCount(range, behind);
    }
  }

  void halveAsKnown(Range& range, Range& behind) {
    const GridOrder::Split& split = (*grid_)[range.known];
    behind.begin = split.middle;
    behind.end = range.end;
    range.end = split.middle;
    Range* const halves[2] = {&range, &behind};
    for (int i = 0; i < 2; ++i) {
      halves[i]->box = split.box[i];
      halves[i]->known = split.below[i];
      countBins(*halves[i]);
    }
  }

  /// Few elements: the best of the places that leave whole blocks of leaves, so that lanes and memory are not
  /// spent on nothing.
  void halve(Part& range, Part& behind) {
    const std::size_t count = range.count();
    Entry* const e = &entries_[range.begin];
    const auto before = ordered(range.box.longestAxis());
    for (std::size_t i = 1; i < count; ++i) {
      const Entry moved = e[i];
      std::size_t place = i;
      for (; place > 0 && before(moved, e[place - 1]); --place) e[place] = e[place - 1];
      e[place] = moved;
    }
    RegisterBox after[kFew];  // everything from entry i on
    after[count - 1] = e[count - 1].box;
    for (std::size_t i = count - 1; i > 0; --i) {
      after[i - 1] = after[i];
      after[i - 1].add(e[i - 1].box);
    }
    RegisterBox first;
    float best = RegisterBox::kFar;
    std::size_t left = 0;
    for (std::size_t i = 0; i + 1 < count; ++i) {
      first.add(e[i].box);
      if ((i + 1) % kWidth != 0) continue;
      const float cost = static_cast<float>(i + 1) * first.halfArea() +
                         static_cast<float>(count - i - 1) * after[i + 1].halfArea();
      if (left != 0 && !(cost < best)) continue;
      best = cost;
      left = i + 1;
      range.box = first;
    }
    behind.begin = range.begin + left;
    behind.end = range.end;
    behind.box = after[left];
    range.end = behind.begin;
  }

  /// A total order: the same tree everywhere.
  static auto ordered(int axis) {
    return [axis](const Entry& x, const Entry& y) {
      const float a = x.box.twiceCentre(axis), b = y.box.twiceCentre(axis);
      return a != b ? a < b : x.element() < y.element();
    };
  }

  void halveByCount(Range& range, Range& behind) {
    const std::size_t middle = range.begin + range.count() / 2;
    const auto at = [&](std::size_t i) { return entries_.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(at(range.begin), at(middle), at(range.end), ordered(range.bins.axis));
    behind.begin = middle;
    behind.end = range.end;
    range.end = middle;
    for (Range* half : {&range, &behind}) {
      half->box = RegisterBox();
      for (std::size_t i = half->begin; i < half->end; ++i) half->box.add(entries_[i].box);
      countBins(*half);
    }
  }

  /// False where all centres lie in one bin.
  bool halveByArea(Range& range, Range& behind) {
    const Bins bins = range.bins;
    RegisterBox after[Bins::kMost];  // everything in bin b and behind it
    std::int32_t count_after[Bins::kMost];
    after[bins.count - 1] = bins.box[bins.count - 1];
    count_after[bins.count - 1] = bins.held[bins.count - 1];
    for (int b = bins.count - 2; b > 0; --b) {
      after[b] = after[b + 1];
      after[b].add(bins.box[b]);
      count_after[b] = count_after[b + 1] + bins.held[b];
    }
    RegisterBox sweep;
    std::int32_t count = 0, left = 0;
    int best_bin = -1;
    float best = RegisterBox::kFar;
    for (int b = 0; b + 1 < bins.count; ++b) {
      sweep.add(bins.box[b]);
      count += bins.held[b];
      if (count == 0 || count_after[b + 1] == 0) continue;
      const float cost = static_cast<float>(count) * sweep.halfArea() +
                         static_cast<float>(count_after[b + 1]) * after[b + 1].halfArea();
      if (cost < best) {
        best = cost;
        best_bin = b;
        left = count;
        range.box = sweep;
        behind.box = after[b + 1];
      }
    }
    if (best_bin < 0) return false;
    behind.begin = range.begin + static_cast<std::size_t>(left);
    behind.end = range.end;
    range.end = behind.begin;
    Range* const halves[2] = {&range, &behind};
    for (Range* half : halves) {
      if (half->count() > kFew) half->bins.prepare(half->box, half->count());
    }
    // Those of the second half go aside; which half it is costs no branch.
    Entry* to[2] = {&entries_[range.begin], aside_.data()};
    for (std::size_t i = range.begin; i < behind.end; ++i) {
      const Entry e = entries_[i];
      const int half = bins.of(e) > best_bin;
      *to[half]++ = e;
      if (halves[half]->count() > kFew) halves[half]->bins.add(e);
    }
    std::copy(aside_.data(), to[1], &entries_[behind.begin]);
    return true;
  }

  std::vector<Entry>& entries_;
  std::vector<Entry> aside_;
  const GridOrder* grid_ = nullptr;  ///< while the constructor runs
  FourFloats near_origin_ = {}, origin_error_ = {};
  std::vector<BvhBlock>& blocks_;
  const Holds holds_;
};

}  // namespace

Bvh::Bvh(const std::vector<Bounds>& boxes) {
  Vec3 lower = boxes[0].lower, upper = boxes[0].upper;
  for (const Bounds& b : boxes) {
    lower = lower.cwiseMin(b.lower);
    upper = upper.cwiseMax(b.upper);
  }
  origin_ = 0.5 * lower + 0.5 * upper;
  std::vector<Entry> entries(boxes.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      // The difference is rounded once: relative to its own size, which the factor covers.
      const double low = boxes[i].lower[k] - origin_[k], high = boxes[i].upper[k] - origin_[k];
      entries[i].box.lower[k] = roundedDown(low - 2.3e-16 * std::abs(low));
      entries[i].box.upper[k] = roundedUp(high + 2.3e-16 * std::abs(high));
    }
    entries[i].box.lower[3] = 0.0F;
    entries[i].setElement(static_cast<std::int32_t>(i));
  }
  held_.reserve(2 * boxes.size());
  const auto holds = [this](std::int32_t node, std::size_t begin, std::size_t end) {
    if (held_.size() <= static_cast<std::size_t>(node)) held_.resize(node + BvhBlock::kWidth);
    held_[node] = {static_cast<std::int32_t>(begin), static_cast<std::int32_t>(end)};
  };
  Builder<decltype(holds)>(entries, origin_, blocks_, holds);
  held_.resize(size());
  blocks_.shrink_to_fit();
  order_.reserve(entries.size());
  for (const Entry& e : entries) order_.push_back(e.element());
}

void Bvh::renumber(const std::vector<std::int32_t>& new_id) {
  for (std::int32_t& element : order_) element = new_id[element];
  for (BvhBlock& block : blocks_) {
    for (int i = 0; i < BvhBlock::kWidth; ++i) {
      if (block.half[0][i] >= 0.0F && block.link[i] < 0) block.link[i] = ~new_id[~block.link[i]];
    }
  }
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

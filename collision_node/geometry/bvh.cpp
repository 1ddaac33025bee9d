#include "collision_node/geometry/bvh.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace collision_node::geometry {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

float roundedUp(double x) {
  const auto f = static_cast<float>(x);
  return static_cast<double>(f) < x ? std::nextafter(f, kInfinity) : f;
}

float roundedDown(double x) { return -roundedUp(-x); }

/// A box of floats, four lanes so that a compiler may use one register; the last is not looked at.
struct Box {
  float lower[4] = {kInfinity, kInfinity, kInfinity, kInfinity};
  float upper[4] = {-kInfinity, -kInfinity, -kInfinity, -kInfinity};

  void add(const Box& o) {
    for (int k = 0; k < 4; ++k) {
      lower[k] = o.lower[k] < lower[k] ? o.lower[k] : lower[k];
      upper[k] = o.upper[k] > upper[k] ? o.upper[k] : upper[k];
    }
  }
  float halfArea() const {
    const float x = upper[0] - lower[0], y = upper[1] - lower[1], z = upper[2] - lower[2];
    return x * y + y * z + z * x;
  }
};

struct Entry {
  Box box;
  std::int32_t element;

  float twiceCentre(int axis) const { return box.lower[axis] + box.upper[axis]; }
};

/// Entries [begin, end) and the box around them.
struct Range {
  std::size_t begin = 0, end = 0;
  Box box;

  std::size_t count() const { return end - begin; }
};

class Builder {
 public:
  using Holds = std::function<void(std::int32_t node, std::size_t begin, std::size_t end)>;

  Builder(std::vector<Entry>& entries, const Vec3& origin, std::vector<BvhBlock>& blocks, Holds holds)
      : entries_(entries), origin_(origin), blocks_(blocks), holds_(std::move(holds)) {
    blocks_.reserve(entries.size() / 2 + 2);
    Range all{0, entries.size(), {}};
    for (const Entry& e : entries) all.box.add(e.box);
    addBlock();
    setNode(0, 0, all);
  }

 private:
  static constexpr int kBins = 16;
  static constexpr std::size_t kWidth = BvhBlock::kWidth, kFew = 16;

  std::int32_t addBlock() {
    BvhBlock empty;
    for (int i = 0; i < BvhBlock::kWidth; ++i) {
      for (int k = 0; k < 3; ++k) {
        empty.centre[k][i] = 0.0F;
        empty.half[k][i] = -0.25F * std::numeric_limits<float>::max();
      }
      for (int k = 0; k < 3; ++k) empty.plate[k][i] = 0;
      empty.plate_middle[i] = empty.plate_half[i] = empty.reach[i] = 0.0F;
      empty.link[i] = -1;
    }
    blocks_.push_back(empty);
    return static_cast<std::int32_t>(blocks_.size()) - 1;
  }

  /// Sets box, reach and link, and builds what lies below.
  void setNode(std::int32_t block, int lane, const Range& range) {
    holds_(BvhBlock::kWidth * block + lane, range.begin, range.end);
    double reach2 = 0.0;
    for (int k = 0; k < 3; ++k) {
      const double lower = range.box.lower[k], upper = range.box.upper[k];
      const auto centre = static_cast<float>(0.5 * (lower + upper));
      const double c = centre;
      blocks_[block].centre[k][lane] = centre;
      blocks_[block].half[k][lane] = roundedUp(std::max(upper - c, c - lower) * (1.0 + 1e-15));
      const double far = std::max(std::abs(origin_[k] + lower), std::abs(origin_[k] + upper));
      reach2 += far * far;
    }
    blocks_[block].reach[lane] = roundedUp(std::sqrt(reach2) * (1.0 + 1e-15));
    blocks_[block].link[lane] = range.count() == 1 ? ~entries_[range.begin].element : split(range);
  }

  /// A block of two to four nodes for the range: the largest is halved until there are four.
  std::int32_t split(const Range& range) {
    Range ranges[BvhBlock::kWidth] = {range};
    int count = 1;
    const std::size_t most = range.count() > kWidth ? kWidth : 1;  // a block of leaves stays together
    while (count < BvhBlock::kWidth) {
      int largest = -1;
      for (int i = 0; i < count; ++i) {
        if (ranges[i].count() > most &&
            (largest < 0 || ranges[i].box.halfArea() > ranges[largest].box.halfArea()))
          largest = i;
      }
      if (largest < 0) break;
      Box halves[2];
      const std::size_t middle =
          halve(ranges[largest].begin, ranges[largest].end, ranges[largest].box, halves);
      ranges[count++] = {middle, ranges[largest].end, halves[1]};
      ranges[largest] = {ranges[largest].begin, middle, halves[0]};
    }
    const std::int32_t block = addBlock();
    for (int i = 0; i < count; ++i) setNode(block, i, ranges[i]);
    return block;
  }

  /// Puts the entries of the first child before those of the second; fills their boxes.
  std::size_t halve(std::size_t begin, std::size_t end, const Box& box, Box halves[2]) {
    int axis = 0;
    for (int k = 1; k < 3; ++k) {
      if (box.upper[k] - box.lower[k] > box.upper[axis] - box.lower[axis]) axis = k;
    }
    const float low = 2.0F * box.lower[axis], extent = 2.0F * (box.upper[axis] - box.lower[axis]);
    std::size_t middle = begin;
    const std::size_t count = end - begin;
    if (count > kWidth && extent > 0.0F) middle = splitByArea(begin, end, axis, low, extent, halves);
    if (middle == begin || middle == end) middle = splitByCount(begin, end, begin + count / 2, axis, halves);
    // Few elements: whole blocks of leaves, so that lanes and memory are not spent on nothing.
    if (count > kWidth && count <= kFew && (middle - begin) % kWidth != 0) {
      const std::size_t left = std::max<std::size_t>(kWidth, (middle - begin + kWidth / 2) / kWidth * kWidth);
      middle = splitByCount(begin, end, begin + (left < count ? left : left - kWidth), axis, halves);
    }
    return middle;
  }

  std::size_t splitByCount(std::size_t begin, std::size_t end, std::size_t middle, int axis, Box halves[2]) {
    const auto at = [&](std::size_t i) { return entries_.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(at(begin), at(middle), at(end), [axis](const Entry& x, const Entry& y) {
      const float a = x.twiceCentre(axis), b = y.twiceCentre(axis);
      return a != b ? a < b : x.element < y.element;  // a total order: the same tree everywhere
    });
    halves[0] = halves[1] = Box();
    for (std::size_t i = begin; i < end; ++i) halves[i < middle ? 0 : 1].add(entries_[i].box);
    return middle;
  }

  std::size_t splitByArea(std::size_t begin, std::size_t end, int axis, float low, float extent,
                          Box halves[2]) {
    const int bins = end - begin < 32 ? 8 : kBins;
    Box boxes[kBins];
    int counts[kBins] = {};
    const float scale = static_cast<float>(bins) / extent;
    const auto binOf = [&](const Entry& e) {
      return std::clamp(static_cast<int>((e.twiceCentre(axis) - low) * scale), 0, bins - 1);
    };
    for (std::size_t i = begin; i < end; ++i) {
      const int bin = binOf(entries_[i]);
      boxes[bin].add(entries_[i].box);
      ++counts[bin];
    }
    Box after[kBins];  // everything in bin b and behind it
    int count_after[kBins];
    after[bins - 1] = boxes[bins - 1];
    count_after[bins - 1] = counts[bins - 1];
    for (int b = bins - 2; b > 0; --b) {
      after[b] = after[b + 1];
      after[b].add(boxes[b]);
      count_after[b] = count_after[b + 1] + counts[b];
    }
    Box sweep;
    int count = 0, best_bin = 0;
    float best = kInfinity;
    for (int b = 0; b + 1 < bins; ++b) {
      sweep.add(boxes[b]);
      count += counts[b];
      if (count == 0 || count_after[b + 1] == 0) continue;
      const float cost = static_cast<float>(count) * sweep.halfArea() +
                         static_cast<float>(count_after[b + 1]) * after[b + 1].halfArea();
      if (cost < best) {
        best = cost;
        best_bin = b;
        halves[0] = sweep;
        halves[1] = after[b + 1];
      }
    }
    if (!(best < kInfinity)) return begin;
    const auto middle = std::partition(entries_.begin() + static_cast<std::ptrdiff_t>(begin),
                                       entries_.begin() + static_cast<std::ptrdiff_t>(end),
                                       [&](const Entry& e) { return binOf(e) <= best_bin; });
    return static_cast<std::size_t>(middle - entries_.begin());
  }

  std::vector<Entry>& entries_;
  const Vec3 origin_;
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
    entries[i].box.lower[3] = entries[i].box.upper[3] = 0.0F;
    entries[i].element = static_cast<std::int32_t>(i);
  }
  held_.reserve(4 * boxes.size());
  Builder(entries, origin_, blocks_, [this](std::int32_t node, std::size_t begin, std::size_t end) {
    if (held_.size() <= static_cast<std::size_t>(node)) held_.resize(node + BvhBlock::kWidth);
    held_[node] = {static_cast<std::int32_t>(begin), static_cast<std::int32_t>(end)};
  });
  held_.resize(size());
  blocks_.shrink_to_fit();
  order_.reserve(entries.size());
  for (const Entry& e : entries) order_.push_back(e.element);
}

void Bvh::renumber(const std::vector<std::int32_t>& new_id) {
  for (BvhBlock& block : blocks_) {
    for (int i = 0; i < BvhBlock::kWidth; ++i) {
      if (block.half[0][i] >= 0.0F && block.link[i] < 0) block.link[i] = ~new_id[~block.link[i]];
    }
  }
}

void Bvh::addPlates(const std::function<Corners(std::int32_t)>& corners) {
  constexpr std::int32_t kMost = 1024;  // larger parts of a surface are rarely flat
  std::vector<Corners> triangles;
  triangles.reserve(order_.size());
  for (std::int32_t node = 0; node < size(); ++node) {
    if (exists(node) && (*this)[node].leaf()) order_[held_[node].begin] = (*this)[node].element();
  }
  // Sums of normals up to each triangle: those of a node are a difference of two. Rounding only tilts the
  // plate.
  std::vector<Vec3> normals = {Vec3::Zero()};
  std::vector<std::int32_t> others = {0};
  normals.reserve(order_.size() + 1);
  others.reserve(order_.size() + 1);
  for (const std::int32_t element : order_) {
    const Corners t = corners(element);
    triangles.push_back(t);
    const bool triangle = t[0] != nullptr;
    others.push_back(others.back() + (triangle ? 0 : 1));
    normals.push_back(triangle ? Vec3(normals.back() + (*t[1] - *t[0]).cross(*t[2] - *t[0]))
                               : normals.back());
  }
  for (std::int32_t node = 0; node < size(); ++node) {
    const Held held = held_[node];
    if (held.end == held.begin || held.end - held.begin > kMost) continue;
    const Vec3 normal = normals[held.end] - normals[held.begin];
    const double length = normal.norm();
    if (others[held.end] != others[held.begin] || !(length > 0.0)) continue;
    // Any direction is sound; short ones keep |plate| below its limit.
    const Vec3 axis = (normal * ((kPlateLength - 1.0) / length)).array().round();
    double low = std::numeric_limits<double>::infinity(), high = -low, scale = 0.0;
    for (std::int32_t i = held.begin; i < held.end; ++i) {
      for (const Vec3* p : triangles[i]) {
        const Vec3 x = *p - origin_;
        const double along = axis.dot(x);
        low = std::min(low, along);
        high = std::max(high, along);
        scale = std::max(scale, x.squaredNorm());
      }
    }
    // Each `along` is a sum of three rounded products of rounded differences.
    const double rounding = 16.0 * 1.2e-16 * kPlateLength * std::sqrt(scale);
    BvhBlock& block = blocks_[node / BvhBlock::kWidth];
    const int lane = node % BvhBlock::kWidth;
    for (int k = 0; k < 3; ++k) block.plate[k][lane] = static_cast<std::int8_t>(axis[k]);
    block.plate_middle[lane] = static_cast<float>(0.5 * (low + high));
    const double middle = block.plate_middle[lane];
    block.plate_half[lane] = roundedUp(std::max(high - middle, middle - low) + rounding);
  }
  order_ = std::vector<std::int32_t>();  // gives the memory back
  held_ = std::vector<Held>();
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

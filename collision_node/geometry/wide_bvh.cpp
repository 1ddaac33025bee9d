#include "collision_node/geometry/wide_bvh.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace collision_node::geometry {
namespace {

constexpr int kLeafSize = 4;
constexpr int kBins = 32;
constexpr int kCarefulDepth =
    64;  ///< deeper than this, halves: bounds the walk's stack whatever the triangles

struct Box {
  Vec3 lower = Vec3::Constant(std::numeric_limits<double>::infinity());
  Vec3 upper = Vec3::Constant(-std::numeric_limits<double>::infinity());

  void add(const Vec3& p) {
    lower = lower.cwiseMin(p);
    upper = upper.cwiseMax(p);
  }
  void add(const Box& o) {
    lower = lower.cwiseMin(o.lower);
    upper = upper.cwiseMax(o.upper);
  }
  Vec3 centre() const { return 0.5 * lower + 0.5 * upper; }
  double halfArea() const {
    const Vec3 e = (upper - lower).cwiseMax(0.0);
    return e.x() * e.y() + e.y() * e.z() + e.z() * e.x();
  }
};

/// A range of the order of triangles, and its box.
struct Range {
  int begin = 0, end = 0, depth = 0;
  Box box;
  int count() const { return end - begin; }
  bool leaf() const { return count() <= kLeafSize; }
};

/// Splits ranges of triangles where area times number of leaves is smallest.
class Splitter {
 public:
  explicit Splitter(const std::vector<Box>& boxes) : boxes_(boxes), order_(boxes.size()) {
    std::iota(order_.begin(), order_.end(), 0);
  }

  Range all() const { return range(0, static_cast<int>(order_.size()), 0); }
  int operator[](int place) const { return order_[static_cast<std::size_t>(place)]; }

  std::array<Range, 2> split(const Range& r) {
    const int middle = partition(r);
    return {range(r.begin, middle, r.depth + 1), range(middle, r.end, r.depth + 1)};
  }

 private:
  const Box& box(int place) const {
    return boxes_[static_cast<std::size_t>(order_[static_cast<std::size_t>(place)])];
  }

  Range range(int begin, int end, int depth) const {
    Range r{begin, end, depth, {}};
    for (int i = begin; i < end; ++i) r.box.add(box(i));
    return r;
  }

  int partition(const Range& r) {
    Box centres;
    for (int i = r.begin; i < r.end; ++i) centres.add(box(i).centre());
    const Vec3 extent = centres.upper - centres.lower;
    double best = std::numeric_limits<double>::infinity();
    int best_axis = 0, best_bin = -1;
    for (int axis = 0; axis < 3 && r.depth < kCarefulDepth; ++axis) {
      if (!(extent[axis] > 0.0)) continue;
      Box bins[kBins];
      int counts[kBins] = {};
      for (int i = r.begin; i < r.end; ++i) {
        const int bin = binOf(box(i), centres.lower[axis], extent[axis], axis);
        bins[bin].add(box(i));
        ++counts[bin];
      }
      const auto leaves = [](int count) { return (count + kLeafSize - 1) / kLeafSize; };
      double right_cost[kBins] = {};
      Box sweep;
      int count = 0;
      for (int b = kBins - 1; b > 0; --b) {
        sweep.add(bins[b]);
        count += counts[b];
        right_cost[b] = count > 0 ? leaves(count) * sweep.halfArea() : 0.0;
      }
      sweep = Box();
      count = 0;
      for (int b = 0; b + 1 < kBins; ++b) {
        sweep.add(bins[b]);
        count += counts[b];
        if (count == 0 || count == r.count()) continue;
        const double cost = leaves(count) * sweep.halfArea() + right_cost[b + 1];
        if (cost < best) {
          best = cost;
          best_axis = axis;
          best_bin = b;
        }
      }
    }
    const auto first = order_.begin() + r.begin, last = order_.begin() + r.end;
    if (best_bin >= 0) {
      const auto middle = std::stable_partition(first, last, [&](int i) {
        return binOf(boxes_[static_cast<std::size_t>(i)], centres.lower[best_axis], extent[best_axis],
                     best_axis) <= best_bin;
      });
      return static_cast<int>(middle - order_.begin());
    }
    int axis = 0;
    extent.maxCoeff(&axis);
    const int half = r.begin + r.count() / 2;
    std::nth_element(first, order_.begin() + half, last, [&](int i, int j) {
      const double a = boxes_[static_cast<std::size_t>(i)].centre()[axis],
                   b = boxes_[static_cast<std::size_t>(j)].centre()[axis];
      return a != b ? a < b : i < j;  // a total order: the same tree everywhere
    });
    return half;
  }

  static int binOf(const Box& b, double lower, double extent, int axis) {
    return std::clamp(static_cast<int>((b.centre()[axis] - lower) / extent * kBins), 0, kBins - 1);
  }

  const std::vector<Box>& boxes_;
  std::vector<int> order_;
};

/// A binary tree of ranges, and for each of its subtrees the cheapest way to hang it into a wide node.
class Halves {
 public:
  explicit Halves(const std::vector<Box>& boxes) : splitter_(boxes) { add(splitter_.all()); }

  /// The children of a wide node for a subtree, at most eight.
  std::vector<int> childrenOf(int subtree) const {
    std::vector<int> children;
    const Subtree& s = subtrees_[static_cast<std::size_t>(subtree)];
    if (s.range.leaf()) return {subtree};
    collect(s.left, s.to_left[0], children);
    collect(s.right, kLanes - s.to_left[0], children);
    return children;
  }
  const Range& operator[](int subtree) const { return subtrees_[static_cast<std::size_t>(subtree)].range; }
  int triangle(int place) const { return splitter_[place]; }

 private:
  static constexpr int kLanes = 8;
  static constexpr double kLeafCost = 1.0;  ///< of looking at a leaf's triangles, in those of a node's boxes

  struct Subtree {
    Range range;
    int left = -1, right = -1;
    double cost[kLanes + 1];  ///< expected, with at most so many children of one node
    int to_left[kLanes +
                1];  ///< how many of them the left half gets; 0: it is one child. [0]: of its own node
  };

  int add(const Range& range) {
    const int at = static_cast<int>(subtrees_.size());
    subtrees_.emplace_back();
    Subtree s;
    s.range = range;
    const double area = range.box.halfArea();
    std::fill_n(s.cost, kLanes + 1, area * kLeafCost);
    std::fill_n(s.to_left, kLanes + 1, 0);
    if (!range.leaf()) {
      const auto halves = splitter_.split(range);
      s.left = add(halves[0]);
      s.right = add(halves[1]);
      for (int lanes = kLanes; lanes > 1; --lanes) share(s, lanes);
      s.to_left[0] = s.to_left[kLanes];
      s.cost[1] = area + s.cost[kLanes];
      s.to_left[1] = 0;
      for (int lanes = 2; lanes <= kLanes; ++lanes) {
        if (s.cost[lanes] < s.cost[1]) continue;
        s.cost[lanes] = s.cost[1];
        s.to_left[lanes] = 0;
      }
    }
    subtrees_[static_cast<std::size_t>(at)] = s;
    return at;
  }

  void share(Subtree& s, int lanes) const {
    const Subtree &left = subtrees_[static_cast<std::size_t>(s.left)],
                  &right = subtrees_[static_cast<std::size_t>(s.right)];
    s.cost[lanes] = std::numeric_limits<double>::infinity();
    for (int k = 1; k < lanes; ++k) {
      const double cost = left.cost[k] + right.cost[lanes - k];
      if (!(cost < s.cost[lanes])) continue;
      s.cost[lanes] = cost;
      s.to_left[lanes] = k;
    }
  }

  void collect(int subtree, int lanes, std::vector<int>& children) const {
    const Subtree& s = subtrees_[static_cast<std::size_t>(subtree)];
    const int to_left = s.to_left[lanes];
    if (to_left == 0) {
      children.push_back(subtree);
      return;
    }
    collect(s.left, to_left, children);
    collect(s.right, lanes - to_left, children);
  }

  Splitter splitter_;
  std::vector<Subtree> subtrees_;  ///< [0] is the whole
};

WideLeaf leafOf(const Halves& halves, const Range& r, const std::vector<WideBvh::Corners>& triangles) {
  WideLeaf leaf;
  for (int lane = 0; lane < kLeafSize; ++lane) {
    const bool used = lane < r.count();
    const int element = halves.triangle(used ? r.begin + lane : r.begin);
    for (int k = 0; k < 3; ++k)
      leaf.vertex[k][lane] = triangles[static_cast<std::size_t>(element)][static_cast<std::size_t>(k)];
    leaf.element[lane] = used ? element : -1;
  }
  return leaf;
}

}  // namespace

void WideBvh::build(const std::vector<Corners>& triangles) {
  std::vector<Box> boxes(triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    for (const std::int32_t v : triangles[i]) boxes[i].add(vertices_[v]);
  }
  const Halves halves(boxes);
  const Range& root = halves[0];
  centre_ = root.box.centre();
  half_ = (root.box.upper - centre_).cwiseMax(centre_ - root.box.lower) * (1.0 + 1e-15);
  const double extent = half_.maxCoeff();
  scale_ = extent > 0.0 ? std::ldexp(1.0, -std::ilogb(extent) - 1) : 1.0;

  // A difference of doubles, its scaling (exact) and the rounding to float, each at most half a step of a
  // value below two: 2^-22 is generous, and smaller than what a path's own rounding adds.
  const auto outward = [&](double bound, int axis, double sign) {
    const double value = (bound - centre_[axis]) * scale_;
    return static_cast<float>(value + sign * std::ldexp(1.0, -22));
  };
  struct Open {
    std::int32_t node;
    int subtree;
  };
  std::vector<Open> open = {{0, 0}};
  nodes_.emplace_back();
  for (std::size_t next = 0; next < open.size(); ++next) {
    const Open now = open[next];
    const std::vector<int> children = halves.childrenOf(now.subtree);
    for (std::size_t lane = 0; lane < 8; ++lane) {
      const bool used = lane < children.size();
      const Range& range = halves[used ? children[lane] : now.subtree];
      std::int32_t child = -1;
      if (used && range.leaf()) {
        leaves_.push_back(leafOf(halves, range, triangles));
        child = ~static_cast<std::int32_t>(leaves_.size() - 1);
      } else if (used) {
        child = static_cast<std::int32_t>(nodes_.size());
        nodes_.emplace_back();
        open.push_back({child, children[lane]});
      }
      WideNode& node = nodes_[static_cast<std::size_t>(now.node)];
      node.child[lane] = child;
      for (int axis = 0; axis < 3; ++axis) {
        const float far = std::numeric_limits<float>::infinity();
        node.plane[axis][lane] = used ? outward(range.box.lower[axis], axis, -1.0) : far;
        node.plane[3 + axis][lane] = used ? outward(range.box.upper[axis], axis, 1.0) : -far;
      }
    }
  }
  nodes_.shrink_to_fit();
  leaves_.shrink_to_fit();
}

}  // namespace collision_node::geometry

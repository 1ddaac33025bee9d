/// A binary tree of balls over the parts of an oracle's model.
#pragma once

#include <algorithm>
#include <numeric>
#include <vector>

#include "test/oracle/model.h"

namespace collision_node::report {

struct Ball {
  oracle::V3 centre;        ///< object frame [m]
  oracle::Real radius = 0;  ///< holds all parts below [m]
  oracle::Real reach = 0;   ///< no point of them is farther from the object's origin [m]
  int left = -1, right = -1;
  int part = -1;  ///< a leaf's
  bool isLeaf() const { return part >= 0; }
};

/// balls[0] is the root.
class BallTree {
 public:
  explicit BallTree(const std::vector<oracle::Part>& parts) : parts_(parts), order_(parts.size()) {
    std::iota(order_.begin(), order_.end(), 0);
    balls.reserve(2 * parts.size());
    build(0, static_cast<int>(parts.size()));
  }

  std::vector<Ball> balls;

 private:
  int build(int from, int to) {
    const int index = static_cast<int>(balls.size());
    balls.emplace_back();
    if (to - from == 1) {
      const oracle::Part& part = parts_[order_[from]];
      balls[index].centre = part.centre, balls[index].radius = part.bound, balls[index].reach = part.reach;
      balls[index].part = order_[from];
      return index;
    }
    const auto coordinate = [](const oracle::V3& v, int k) { return k == 0 ? v.x : k == 1 ? v.y : v.z; };
    int axis = 0;
    oracle::Real widest = -1;
    oracle::V3 middle;
    for (int k = 0; k < 3; ++k) {
      const auto [lo, hi] = std::minmax_element(
          order_.begin() + from, order_.begin() + to,
          [&](int p, int q) { return coordinate(parts_[p].centre, k) < coordinate(parts_[q].centre, k); });
      const oracle::Real low = coordinate(parts_[*lo].centre, k), high = coordinate(parts_[*hi].centre, k);
      (k == 0 ? middle.x : k == 1 ? middle.y : middle.z) = (low + high) / 2;
      if (high - low > widest) widest = high - low, axis = k;
    }
    Ball ball;
    ball.centre = middle;
    for (int i = from; i < to; ++i) {
      const oracle::Part& part = parts_[order_[i]];
      ball.radius = std::max(ball.radius, norm(part.centre - middle) + part.bound);
      ball.reach = std::max(ball.reach, part.reach);
    }
    ball.radius *= 1 + 1e-18L;
    const int half = (from + to) / 2;
    std::nth_element(order_.begin() + from, order_.begin() + half, order_.begin() + to, [&](int p, int q) {
      return coordinate(parts_[p].centre, axis) < coordinate(parts_[q].centre, axis);
    });
    ball.left = build(from, half);
    ball.right = build(half, to);
    balls[index] = ball;
    return index;
  }

  const std::vector<oracle::Part>& parts_;
  std::vector<int> order_;
};

}  // namespace collision_node::report

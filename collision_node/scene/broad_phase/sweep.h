/// Where an object may be during a stretch of time, as the broad phase asks about it.
#pragma once

#include "collision_node/geometry/bvh.h"

namespace collision_node::scene {

using geometry::Bounds;
using geometry::Vec3;

inline bool meet(const Bounds& a, const Bounds& b) {
  return (a.lower.array() <= b.upper.array()).all() && (b.lower.array() <= a.upper.array()).all();
}

/// Rounded outward.
Bounds grown(const Bounds& box, double by);

/// A lower bound of the distance of two boxes; 0 when they meet. [m]
double distanceBetween(const Bounds& a, const Bounds& b);

/// All that is within `radius` of the straight line between two points.
struct Sweep {
  Vec3 from, to;
  double radius;  ///< [m]; has 2^-45 of the largest coordinate to spare for rounding

  Bounds box() const {
    const Vec3 out = Vec3::Constant(radius);
    return {from.cwiseMin(to) - out, from.cwiseMax(to) + out};
  }
  bool isLong() const { return (to - from).squaredNorm() > 4.0 * radius * radius; }
};

}  // namespace collision_node::scene

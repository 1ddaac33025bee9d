/// Cones about unit normals, as what is known of a contact's normal.
#pragma once

#include <algorithm>
#include <cmath>

#include "collision_node/geometry/types.h"

namespace collision_node::geometry {

/// The half angle of a cone about n that holds both the cone about n and the one about `other` [rad]; pi,
/// which says that nothing is known, also where either is not a number.
inline double coneOfBoth(const Vec3& n, double angle, const Vec3& other, double other_angle) {
  const double lean = 2.0 * std::asin(std::min(1.0, 0.5 * (n - other).norm()));
  const double needed = lean + other_angle;
  if (needed <= angle) return angle;
  return angle < needed && needed < M_PI ? needed : M_PI;
}

}  // namespace collision_node::geometry

/// Cones about unit normals, as what is known of a contact's normal.
#pragma once

#include <cmath>

#include "collision_node/geometry/rounding.h"
#include "collision_node/geometry/types.h"

namespace collision_node::geometry {

/// The half angle of a cone about n that holds both the cone about n and the one about `other` [rad]; pi,
/// which says that nothing is known, also where either is not a number.
///
/// The lean between the two is 2 atan(|n - other| / |n + other|), well conditioned up to half a turn (an arc
/// sine of half the difference is not). Differences, norms, quotient and arc are off by some 16 u of it. Unit
/// vectors whose lengths differ by up to 8 u lessen it by no more than that, where it is more than a right
/// angle.
inline double coneOfBoth(const Vec3& n, double angle, const Vec3& other, double other_angle) {
  const double lean = 2.0 * std::atan2((n - other).norm(), (n + other).norm());
  const double needed = (lean + other_angle) * kUp;
  if (needed <= angle) return angle;
  return angle < needed && needed < M_PI ? needed : M_PI;
}

}  // namespace collision_node::geometry

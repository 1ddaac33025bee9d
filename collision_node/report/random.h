/// Numbers that are the same on every machine and compiler, which std's distributions do not promise.
#pragma once

#include <cmath>
#include <cstdint>
#include <random>

#include "collision_node/geometry/types.h"

namespace collision_node::report {

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  double in(double lower, double upper) {
    return lower + (upper - lower) * (static_cast<double>(engine_() >> 11) * 0x1p-53);
  }
  geometry::Vec3 inBox(const geometry::Vec3& lower, const geometry::Vec3& upper) {
    const double x = in(lower.x(), upper.x()), y = in(lower.y(), upper.y()), z = in(lower.z(), upper.z());
    return {x, y, z};
  }
  /// Evenly on the unit sphere.
  geometry::Vec3 direction() {
    for (;;) {
      const geometry::Vec3 v = inBox(geometry::Vec3::Constant(-1.0), geometry::Vec3::Constant(1.0));
      const double norm = v.norm();
      if (norm > 0.1 && norm <= 1.0) return v / norm;
    }
  }
  /// Any direction, any length between the two. Draws stay in statements of their own: the order in which a
  /// compiler evaluates operands is its own affair.
  geometry::Vec3 vector(double shortest, double longest) {
    const double length = in(shortest, longest);
    return length * direction();
  }
  /// As vector(), but across `v`.
  geometry::Vec3 across(const geometry::Vec3& v, double shortest, double longest) {
    const double length = in(shortest, longest);
    return length * v.cross(direction()).normalized();
  }
  geometry::Quat orientation() { return turn(3.141592653589793); }
  /// A turn about any axis by up to `most` [rad].
  geometry::Quat turn(double most) {
    const geometry::Vec3 axis = direction();
    const double half = 0.5 * in(0.0, most);
    const geometry::Vec3 vec = std::sin(half) * axis;
    return geometry::Quat(std::cos(half), vec.x(), vec.y(), vec.z());
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace collision_node::report

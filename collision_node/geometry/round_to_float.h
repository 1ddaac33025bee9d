/// Doubles to floats on a chosen side.
#pragma once

#include <cstdint>
#include <cstring>

namespace collision_node::geometry {

/// The least float that is not below a finite x. No branch: half of all numbers need the step.
inline float roundedUp(double x) {
  float f = static_cast<float>(x) + 0.0F;  // never -0
  std::int32_t bits;
  std::memcpy(&bits, &f, sizeof bits);
  const std::int32_t away = static_cast<double>(f) < x ? 1 : 0;
  bits += bits < 0 ? -away : away;
  std::memcpy(&f, &bits, sizeof f);
  return f;
}

inline float roundedDown(double x) { return -roundedUp(-x); }

}  // namespace collision_node::geometry

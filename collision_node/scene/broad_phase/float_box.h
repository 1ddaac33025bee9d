/// Boxes in floats, as the broad phase keeps and compares them.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "collision_node/geometry/round_to_float.h"
#include "collision_node/scene/broad_phase/sweep.h"

namespace collision_node::scene {

struct FloatBox {
  float plane[6];  ///< lower x y z, upper x y z

  bool meets(const FloatBox& other) const {
    bool all = true;
    for (int k = 0; k < 3; ++k) all = all && plane[k] <= other.plane[3 + k] && other.plane[k] <= plane[3 + k];
    return all;
  }
  bool holds(const FloatBox& inner) const {
    bool all = true;
    for (int k = 0; k < 3; ++k) all = all && plane[k] <= inner.plane[k] && inner.plane[3 + k] <= plane[3 + k];
    return all;
  }
  /// And no two planes are the same.
  bool holdsInside(const FloatBox& inner) const {
    unsigned outside = 0;
    for (int k = 0; k < 3; ++k) {
      outside |= !(plane[k] < inner.plane[k]);
      outside |= !(inner.plane[3 + k] < plane[3 + k]);
    }
    return outside == 0;
  }
};

inline FloatBox around(const FloatBox& a, const FloatBox& b) {
  FloatBox both;
  for (int k = 0; k < 3; ++k) {
    both.plane[k] = std::min(a.plane[k], b.plane[k]);
    both.plane[3 + k] = std::max(a.plane[3 + k], b.plane[3 + k]);
  }
  return both;
}

/// `box` as seen from `origin`, rounded outward. Guarantee: images of boxes that meet do meet, and so does
/// any box that holds one of the images. A difference of doubles never falls when what it is taken of grows,
/// and what is rounded down is never above what is rounded up: the order of two planes stays. All planes are
/// finite; one that is out of a float's reach, or no number, is as far outside as there is.
inline FloatBox imageOf(const Bounds& box, const Vec3& origin) {
  constexpr double kMost = std::numeric_limits<float>::max();
  FloatBox image;
  for (int k = 0; k < 3; ++k) {
    const double lower = box.lower[k] - origin[k], upper = box.upper[k] - origin[k];
    image.plane[k] = geometry::roundedDown(lower > -kMost ? std::min(lower, kMost) : -kMost);
    image.plane[3 + k] = geometry::roundedUp(upper < kMost ? std::max(upper, -kMost) : kMost);
  }
  return image;
}

/// outer.holds(imageOf(inner, origin)), without rounding: a number is not below a float when it is not when
/// rounded down.
inline bool holdsImage(const FloatBox& outer, const Bounds& inner, const Vec3& origin) {
  unsigned outside = 0;
  for (int k = 0; k < 3; ++k) {
    outside |= !(static_cast<double>(outer.plane[k]) <= inner.lower[k] - origin[k]);
    outside |= !(inner.upper[k] - origin[k] <= static_cast<double>(outer.plane[3 + k]));
  }
  return outside == 0;
}

/// The surroundings of a straight line, for slabs as of T. Kay and J. Kajiya 1986: between the planes of an
/// axis it is from (near plane - enter_at) * inverse to (far plane - leave_at) * inverse, in shares of its
/// way.
///
/// Guarantee: whatever comes within the sweep's radius of the line has, over all axes,
/// enter <= leave * (1 + kWider) + kLater, with 0 <= enter and leave <= 1. A box that is inside out has not:
/// along every axis it is entered at infinity. What is subtracted is rounded outward; the difference, the
/// inverse and the product are each rounded by at most 2^-24 of themselves, and what is too small for that by
/// far less than kLater.
struct FloatLine {
  static constexpr float kWider = 0x1p-20F, kLater = 0x1p-100F;

  FloatBox box;
  float inverse[3], enter_at[3], leave_at[3];
  int near[3], far[3];  ///< planes of FloatBox

  FloatLine(const Sweep& sweep, const Vec3& origin) : box(imageOf(sweep.box(), origin)) {
    constexpr double kStill = 1e-30, kHuge = 1e30;  // [m]
    for (int k = 0; k < 3; ++k) {
      const double way = sweep.to[k] - sweep.from[k], from = sweep.from[k] - origin[k];
      const bool back = way < -kStill;
      near[k] = back ? 3 + k : k;
      far[k] = back ? k : 3 + k;
      if (!(std::abs(way) < kHuge && std::abs(from) < kHuge)) {  // nobody is apart along this axis
        near[k] = k;
        far[k] = 3 + k;
        inverse[k] = 1.0F;
        enter_at[k] = std::numeric_limits<float>::max();
        leave_at[k] = -std::numeric_limits<float>::infinity();
        continue;
      }
      // A shorter way is no way for who is larger by that much.
      inverse[k] = static_cast<float>(1.0 / (std::abs(way) > kStill ? way : kStill));
      const double radius = sweep.radius + 2.0 * kStill;
      const float below = geometry::roundedDown(from - radius), above = geometry::roundedUp(from + radius);
      enter_at[k] = back ? below : above;
      leave_at[k] = back ? above : below;
    }
  }
};

}  // namespace collision_node::scene

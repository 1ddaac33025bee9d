/// Roots of explicit functions of time, and turns, in 50 digits.
#pragma once

#include <stdexcept>

#include "collision_node/report/stability/exact_touch.h"

namespace collision_node::report {

/// The root of `gap`, which falls from above 0 at `lower` to 0 or less at `upper` and has but one root in
/// between.
template <typename Gap>
Exact rootOf(const Gap& gap, Exact lower, Exact upper) {
  if (gap(lower) <= Exact(0) || gap(upper) > Exact(0)) throw std::logic_error("no root in the bracket");
  for (int i = 0; i < 160; ++i) {
    const Exact middle = (lower + upper) / Exact(2);
    (gap(middle) > Exact(0) ? lower : upper) = middle;
  }
  return upper;
}

/// `v` turned by `angle` about the unit vector `axis`.
inline Vec<Exact> turnedBy(const Exact& angle, const Vec<Exact>& axis, const Vec<Exact>& v) {
  const Exact c = cos(angle), s = sin(angle);
  return c * v + s * axis.cross(v) + ((Exact(1) - c) * axis.dot(v)) * axis;
}

}  // namespace collision_node::report

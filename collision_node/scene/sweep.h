/// Where an object may be during a stretch of time, as the broad phase asks about it.
#pragma once

#include <algorithm>
#include <cmath>

#include "collision_node/geometry/bvh.h"

namespace collision_node::scene {

using geometry::Bounds;
using geometry::Vec3;

inline bool meet(const Bounds& a, const Bounds& b) {
  return (a.lower.array() <= b.upper.array()).all() && (b.lower.array() <= a.upper.array()).all();
}

inline bool holds(const Bounds& outer, const Bounds& inner) {
  return (outer.lower.array() <= inner.lower.array()).all() &&
         (inner.upper.array() <= outer.upper.array()).all();
}

/// Rounded outward.
Bounds grown(const Bounds& box, double by);

/// A lower bound of the distance of two boxes; 0 when they meet. [m]
double distanceBetween(const Bounds& a, const Bounds& b);

/// All that is within `radius` of the straight line between two points.
struct Sweep {
  Vec3 from, to;
  double radius;  ///< [m]
  Bounds box;     ///< holds all of it

  bool isLong() const { return (to - from).squaredNorm() > 4.0 * radius * radius; }
};

/// "Does this box meet mine?" Exact.
struct BoxQuestion {
  Bounds box;
  bool meets(const Bounds& other) const { return meet(box, other); }
};

/// "Does this box meet the line's surroundings?" Never false when it does, as long as the radius has 2^-45 of
/// the largest coordinate to spare: slabs as of T. Kay and J. Kajiya 1986, with the line's box first.
class LineQuestion {
 public:
  explicit LineQuestion(const Sweep& sweep) : sweep_(sweep) {
    const Vec3 way = sweep.to - sweep.from;
    for (int i = 0; i < 3; ++i) inverse_[i] = 1.0 / (std::abs(way[i]) > 1e-300 ? way[i] : 1e-300);
  }

  bool meets(const Bounds& box) const {
    if (!meet(sweep_.box, box)) return false;
    double enter = 0.0, leave = 1.0;
    for (int i = 0; i < 3; ++i) {
      const double first = (box.lower[i] - sweep_.radius - sweep_.from[i]) * inverse_[i];
      const double second = (box.upper[i] + sweep_.radius - sweep_.from[i]) * inverse_[i];
      enter = std::max(enter, std::min(first, second));
      leave = std::min(leave, std::max(first, second));
    }
    return enter <= leave * (1.0 + 0x1p-48);
  }

 private:
  const Sweep& sweep_;
  Vec3 inverse_;
};

}  // namespace collision_node::scene

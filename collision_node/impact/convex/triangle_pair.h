/// Two triangles at an instant: how long do the normals of their faces and edges keep them apart?
///
/// Guarantee: apartFor() returns s >= 0 such that the triangles are farther than the contact distance apart
/// at every time in [t, t + s]; 0 proves nothing. The bound is that of gap_model.h for the axes of the
/// separating axis theorem, with all six vertices posed once. Derivation: docs/solver.md, "The gap model".
#pragma once

#include "collision_node/impact/convex/gap_model.h"

namespace collision_node::impact {

class TrianglePair {
 public:
  TrianglePair(const PairPiece& piece, const Instant& now, const Element& a, const Element& b);

  /// The longest time, at most `span`, that one of the axes proves, and that axis, as it is now.
  double apartFor(double span, Axis* axis) const;

 private:
  double alongAxis(const Vec3& n, const Vec3& rate, double span) const;

  const PairPiece& piece_;
  const Instant& now_;
  Vec3 a_[3], b_[3];  ///< world axes, each relative to its own object's origin
  double reach_a_, reach_b_, curve_;
};

}  // namespace collision_node::impact

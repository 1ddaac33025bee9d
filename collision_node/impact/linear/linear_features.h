/// Vertex against face and edge against edge, every vertex on its own straight line: touching within [0, 1]?
///
/// Guarantee, in real arithmetic of the given doubles: kClear means no common point at any t of the closed
/// interval; kImpact means a common point at some t in [t_lo, t_hi] and none in [0, t_lo), wide where an
/// earlier touch without crossing could not be decided. kUndecided means only that every t with a common
/// point lies in [t_lo, t_hi]. Touching is contact. Features may be degenerate (needles, points) and may
/// change their shape as they move; rigid motion is not needed.
///
/// Not covered: coordinates so large that a difference overflows, or differences all below 2^-900: undecided.
///
/// Cost: bounded work, no allocation. First doubles, then about 106 bits from where doubles stop, then exact
/// arithmetic at a few rational times, for contacts that touch without crossing.
/// Source: docs/solver.md, "Vertices on straight lines".
#pragma once

#include <array>

#include "collision_node/geometry/types.h"

namespace collision_node::impact {

using geometry::Vec3;

/// x(t) = start + t (end - start), t in [0, 1].
struct LinearVertex {
  Vec3 start = Vec3::Zero();
  Vec3 end = Vec3::Zero();
};

enum class LinearVerdict { kClear, kImpact, kUndecided };

/// t_lo <= t_hi, both in [0, 1]; NaN when clear.
struct LinearContact {
  LinearVerdict verdict = LinearVerdict::kUndecided;
  double t_lo = 0.0, t_hi = 1.0;
};

LinearContact vertexFaceContact(const LinearVertex& vertex, const std::array<LinearVertex, 3>& face);

LinearContact edgeEdgeContact(const std::array<LinearVertex, 2>& a, const std::array<LinearVertex, 2>& b);

}  // namespace collision_node::impact

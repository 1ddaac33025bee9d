/// Fewer points with the same convex hull.
#pragma once

#include <vector>

#include "collision_node/geometry/types.h"

namespace collision_node::geometry {

/// Drops points that are provably strictly inside the hull of the others, and exact duplicates.
/// Guarantee: the hull of the result is the hull of the input, in exact arithmetic. The result may still hold
/// points that are no corners. Order of first appearance is kept. `points` must be finite. Cost: O(n) with a
/// factor of some hundred; the points of a mesh that is itself convex are all kept.
std::vector<Vec3> hullVertices(const std::vector<Vec3>& points);

}  // namespace collision_node::geometry

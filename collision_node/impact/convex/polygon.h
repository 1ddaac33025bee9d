/// Small convex polygons in the contact plane: hulls, what grown hulls have in common, discs. Results go into
/// the caller's memory, which keeps its capacity.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace collision_node::impact {

using Vec2 = Eigen::Vector2d;
using Polygon = std::vector<Vec2>;  ///< counter-clockwise; may be a point or a segment

/// Convex hull (Andrew's monotone chain). Sorts `points`.
void convexHull(Polygon& points, Polygon& hull);

/// A polygon that holds every point within `grow_p` of hull `p` and within `grow_q` of hull `q`; `grow_p` >
/// 0. Beyond a corner it reaches up to three times as far. Empty when there is no such point.
void grownIntersection(const Polygon& p, double grow_p, const Polygon& q, double grow_q, Polygon& both,
                       Polygon& scratch);

/// A disc that holds the points: their box's centre and the farthest one. Of none: infinite.
void enclosingDisc(const Polygon& points, Vec2* centre, double* radius);

/// Largest r such that the disc of radius r about the origin lies in the hull of `points`; 0 when outside.
/// Sorts `points`; `hull` receives their hull, `out` (may be null) the unit normal of the edge that is in the
/// way: with more points r is at most their farthest along it. Zero where there is no such edge.
double discInHull(Polygon& points, Polygon& hull, Vec2* out = nullptr);

/// A line between two points and what lies beside it.
struct Strip {
  Vec2 across = {1.0, 0.0};      ///< unit
  double low = 0.0, high = 0.0;  ///< of all points along it
  double length2 = 0.0;          ///< of the line, squared
};

/// Between the two points that are about farthest from each other.
Strip stripOf(const Polygon& points);

/// A disc that holds what two strips, each grown, have in common; false where they are nearly parallel.
bool crossing(const Strip& a, double grow_a, const Strip& b, double grow_b, Vec2* centre, double* radius);

}  // namespace collision_node::impact

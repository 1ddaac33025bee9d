/// Small convex polygons in the contact plane: hulls, grown hulls, intersections.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace collision_node::impact {

using Vec2 = Eigen::Vector2d;
using Polygon = std::vector<Vec2>;  ///< counter-clockwise; may be a point or a segment

/// Convex hull (Andrew's monotone chain).
Polygon convexHull(Polygon points);

/// A polygon that holds every point within `radius` of the hull of `points`.
Polygon grownHull(const Polygon& points, double radius);

/// Intersection of two convex polygons with area; empty when they do not meet.
Polygon intersection(const Polygon& p, const Polygon& q);

/// A disc that holds the polygon: the box's centre and the farthest corner.
void enclosingDisc(const Polygon& p, Vec2* centre, double* radius);

/// Largest r such that the disc of radius r about the origin lies in the hull of `points`; 0 when outside.
double discInHull(const Polygon& points);

}  // namespace collision_node::impact

/// Two cores, one of which was closest to the other with a known feature a moment ago: a vertex, an edge, a
/// cylinder's side or rim. Most often it still is; then the two slide along each other, and nothing need be
/// searched. A proposal: that no other point is closer, or that these touch, is for the caller to show.
#pragma once

#include <cmath>

#include "collision_node/impact/convex/closest_points.h"

namespace collision_node::impact {

/// The vertex, or the two ends of the edge, that hold all of one side's closest points; 0 where there are
/// more, or where some are no vertices.
int edgeOf(const Element& e, const Closest& closest, bool of_a, Vec3 (&ends)[2]);

/// Calls `accept(points, cores, radius)` with the closest points of such a feature and the whole other core,
/// until it returns true. `cores` are those of the points: a side is its axis there, grown by `radius`.
/// `before` are closest points of the two a moment ago, `direction` parted them, from A to B (null: none
/// did). `shrunk` [m] is taken off the other core all around.
template <typename Accept>
bool slideOnFeatures(const Instant& now, const Element& a, const Element& b, const Closest& before,
                     const Vec3* direction, double shrunk, Accept&& accept) {
  const auto slides = [&](const Element& curve, bool of_a, double radius) {
    const Element &ea = of_a ? curve : a, &eb = of_a ? b : curve;
    SlidingPoints points = SlidingPoints::ofCurve(ea, eb, of_a, shrunk);
    const Cores cores(now, ea, eb);
    points.find(cores);
    return (radius == 0.0 || points.insideEdge()) && accept(points, cores, radius);
  };
  for (const bool of_a : {true, false}) {
    const Element &e = of_a ? a : b, &other = of_a ? b : a;
    if (e.vertices == nullptr || other.frame == nullptr) continue;
    Vec3 ends[2];
    Element edge;
    edge.vertices = ends;
    edge.count = edgeOf(e, before, of_a, ends);
    if (edge.count > 0 && slides(edge, of_a, 0.0)) return true;
  }
  if (direction == nullptr) return false;
  for (const bool of_a : {true, false}) {
    const Element &e = of_a ? a : b, &other = of_a ? b : a;
    if (e.vertices != nullptr || other.frame == nullptr) continue;
    constexpr double kSide = 0.05;  // its normals are across the axis
    if (std::abs(((of_a ? now.ra : now.rb) * e.axis).dot(*direction)) < kSide) {
      const Vec3 arm = e.half_length * e.axis, ends[2] = {e.centre - arm, e.centre + arm};
      Element axis;
      axis.vertices = ends;
      axis.count = 2;
      if (slides(axis, of_a, e.rim_radius)) return true;
    }
    SlidingPoints points = SlidingPoints::ofCurve(a, b, of_a, shrunk);
    const Cores cores(now, a, b);
    if (points.findOnRim(cores, *direction) && accept(points, cores, 0.0)) return true;
  }
  return false;
}

}  // namespace collision_node::impact

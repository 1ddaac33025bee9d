/// A closed surface of triangles around the origin, over points of the difference of two cores.
#pragma once

#include <array>
#include <boost/container/static_vector.hpp>

#include "collision_node/impact/convex/gjk.h"

namespace collision_node::impact {

/// A closed oriented surface of triangles over points of B - A. Where every triangle sees the origin on its
/// inner side, the surface winds around the origin, so the origin lies in the hull of the points: the
/// elements share a point.
struct Wrap {
  static constexpr std::size_t kMostPoints = 96, kMostFaces = 2 * kMostPoints - 4;

  boost::container::static_vector<SupportPair, kMostPoints> points;
  boost::container::static_vector<std::array<std::int16_t, 3>, kMostFaces> faces;  ///< of points, outward
};

inline double det(const Vec3& a, const Vec3& b, const Vec3& c) { return a.dot(b.cross(c)); }

/// Builds a wrap whose faces are all at least `depth` away from the origin at this instant, or returns false.
/// A proposal (an expanding polytope, van den Bergen 2001); what it is worth is proved in contact_proof.cpp.
bool buildWrap(const Cores& cores, double depth, Wrap& wrap);

/// The surface of the tetrahedron in which closestPoints() found the origin; false where there is none.
bool wrapTetrahedron(const Closest& closest, Wrap& wrap);

}  // namespace collision_node::impact

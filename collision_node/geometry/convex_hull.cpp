#include "collision_node/geometry/convex_hull.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <tuple>

namespace collision_node::geometry {
namespace {

/// The sign of the volume of (a, b, c, p), or 0 when rounding might have decided it.
int certainSide(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p) {
  const Vec3 u = a - p, v = b - p, w = c - p;
  const double determinant = u.dot(v.cross(w));
  const Vec3 au = u.cwiseAbs(), av = v.cwiseAbs(), aw = w.cwiseAbs();
  const double permanent = au.x() * (av.y() * aw.z() + av.z() * aw.y()) +
                           au.y() * (av.z() * aw.x() + av.x() * aw.z()) +
                           au.z() * (av.x() * aw.y() + av.y() * aw.x());
  // Three differences, two products and three sums deep: under 8 units of 2^-53 of the permanent, doubled.
  // The absolute term covers underflow.
  const double doubt = 16.0 * 0x1p-53 * permanent + 1e-290;
  if (determinant > doubt) return 1;
  if (determinant < -doubt) return -1;
  return 0;
}

struct Tetrahedron {
  std::array<Vec3, 4> corner;

  bool certainlyHolds(const Vec3& p) const {
    const int first = certainSide(corner[1], corner[2], corner[3], p);
    if (first == 0) return false;
    // Replacing one corner after another by p keeps the orientation only for a point inside.
    return certainSide(corner[0], corner[3], corner[2], p) == first &&
           certainSide(corner[0], corner[1], corner[3], p) == first &&
           certainSide(corner[0], corner[2], corner[1], p) == first;
  }
};

/// The point of `points` that lies farthest along `direction`.
Vec3 farthest(const std::vector<Vec3>& points, const Vec3& direction) {
  return *std::max_element(points.begin(), points.end(),
                           [&](const Vec3& a, const Vec3& b) { return a.dot(direction) < b.dot(direction); });
}

/// Tetrahedra between input points that fill most of the hull: a fan, from one extreme point, over the
/// extreme points in 18 directions. Whatever rounding picked them, their corners are input points, so what
/// they hold is in the hull.
std::vector<Tetrahedron> innerTetrahedra(const std::vector<Vec3>& points) {
  std::vector<Tetrahedron> result;
  const Vec3 apex = farthest(points, Vec3(-0.3, -0.5, -0.8));
  for (int octant = 0; octant < 8; ++octant) {
    const Vec3 sign(octant & 1 ? -1 : 1, octant & 2 ? -1 : 1, octant & 4 ? -1 : 1);
    const std::array<Vec3, 3> axis = {Vec3(sign.x(), 0, 0), Vec3(0, sign.y(), 0), Vec3(0, 0, sign.z())};
    std::array<Vec3, 3> corner, middle;
    for (int i = 0; i < 3; ++i) {
      corner[i] = farthest(points, axis[i]);
      middle[i] = farthest(points, axis[i] + axis[(i + 1) % 3]);
    }
    for (int i = 0; i < 3; ++i) result.push_back({{apex, corner[i], middle[i], middle[(i + 2) % 3]}});
    result.push_back({{apex, middle[0], middle[1], middle[2]}});
  }
  return result;
}

}  // namespace

std::vector<Vec3> hullVertices(const std::vector<Vec3>& points) {
  if (points.empty()) return {};
  const auto position = [&](std::size_t i) {
    return std::make_tuple(points[i].x(), points[i].y(), points[i].z());
  };
  std::vector<std::size_t> order(points.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t i, std::size_t j) { return position(i) < position(j); });
  order.erase(std::unique(order.begin(), order.end(),
                          [&](std::size_t i, std::size_t j) { return position(i) == position(j); }),
              order.end());
  std::sort(order.begin(), order.end());

  // A point strictly inside a tetrahedron of input points is no corner of the hull, and dropping all points
  // that are no corners leaves the hull as it is.
  const std::vector<Tetrahedron> inner = innerTetrahedra(points);
  std::vector<Vec3> kept;
  for (const std::size_t i : order) {
    const bool inside = std::any_of(inner.begin(), inner.end(), [&](const Tetrahedron& tetrahedron) {
      return tetrahedron.certainlyHolds(points[i]);
    });
    if (!inside) kept.push_back(points[i]);
  }
  return kept;
}

}  // namespace collision_node::geometry

#include "collision_node/impact/polygon.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace collision_node::impact {
namespace {

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

}  // namespace

Polygon convexHull(Polygon points) {
  std::sort(points.begin(), points.end(),
            [](const Vec2& a, const Vec2& b) { return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y(); });
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() < 3) return points;
  Polygon hull;
  for (int pass = 0; pass < 2; ++pass) {
    const std::size_t base = hull.size();
    for (const Vec2& p : points) {
      while (hull.size() >= base + 2 && cross(hull.back() - hull[hull.size() - 2], p - hull.back()) <= 0.0) {
        hull.pop_back();
      }
      hull.push_back(p);
    }
    hull.pop_back();
    std::reverse(points.begin(), points.end());
  }
  return hull;
}

Polygon grownHull(const Polygon& points, double radius) {
  // The octagon around the disc: corners at (+-1, +-h) and (+-h, +-1) times the radius, h = tan(pi/8) rounded
  // up.
  const double outer = radius * (1.0 + 1e-12), inner = 0.41421356237309515 * outer;
  Polygon grown;
  grown.reserve(8 * points.size());
  for (const Vec2& p : points) {
    for (const double side : {-outer, outer}) {
      for (const double along : {-inner, inner}) {
        grown.push_back(p + Vec2(side, along));
        grown.push_back(p + Vec2(along, side));
      }
    }
  }
  return convexHull(std::move(grown));
}

Polygon intersection(const Polygon& p, const Polygon& q) {
  Polygon result = p;
  for (std::size_t i = 0; i < q.size() && !result.empty(); ++i) {  // Sutherland, Hodgman 1974
    const Vec2 &from = q[i], &to = q[(i + 1) % q.size()];
    const Vec2 edge = to - from;
    Polygon kept;
    for (std::size_t k = 0; k < result.size(); ++k) {
      const Vec2 &a = result[k], &b = result[(k + 1) % result.size()];
      const double side_a = cross(edge, a - from), side_b = cross(edge, b - from);
      if (side_a >= 0.0) kept.push_back(a);
      if ((side_a > 0.0 && side_b < 0.0) || (side_a < 0.0 && side_b > 0.0)) {
        kept.push_back(a + (b - a) * (side_a / (side_a - side_b)));
      }
    }
    result.swap(kept);
  }
  return result;
}

void enclosingDisc(const Polygon& p, Vec2* centre, double* radius) {
  Vec2 low = p[0], high = p[0];
  for (const Vec2& v : p) {
    low = low.cwiseMin(v);
    high = high.cwiseMax(v);
  }
  *centre = 0.5 * (low + high);
  *radius = 0.0;
  for (const Vec2& v : p) *radius = std::max(*radius, (v - *centre).norm());
}

double discInHull(const Polygon& points) {
  const Polygon hull = convexHull(points);
  if (hull.size() < 3) return 0.0;
  double radius = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const Vec2 edge = hull[(i + 1) % hull.size()] - hull[i];
    const double length = edge.norm();
    if (length > 0.0) radius = std::min(radius, cross(edge, -hull[i]) / length);
  }
  return std::max(0.0, radius);
}

}  // namespace collision_node::impact

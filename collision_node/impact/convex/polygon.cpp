#include "collision_node/impact/convex/polygon.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace collision_node::impact {
namespace {

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Keeps what lies left of the line through `from` along `edge`, or at most `beyond` |edge| right of it.
/// Source: Sutherland, Hodgman 1974.
void clip(const Vec2& from, const Vec2& edge, double beyond, Polygon& polygon, Polygon& kept) {
  kept.clear();
  if (polygon.empty()) return;
  const double allowed = beyond * edge.norm();
  const auto side = [&](const Vec2& x) { return cross(edge, x - from) + allowed; };
  Vec2 a = polygon.back();
  double side_a = side(a);
  for (const Vec2& b : polygon) {
    const double side_b = side(b);
    if ((side_a > 0.0 && side_b < 0.0) || (side_a < 0.0 && side_b > 0.0))
      kept.push_back(a + (b - a) * (side_a / (side_a - side_b)));
    if (side_b >= 0.0) kept.push_back(b);
    a = b;
    side_a = side_b;
  }
  polygon.swap(kept);
}

void boxOf(const Polygon& p, Vec2* low, Vec2* high) {
  *low = *high = p[0];
  for (const Vec2& v : p) {
    *low = low->cwiseMin(v);
    *high = high->cwiseMax(v);
  }
}

void clipToGrown(const Polygon& hull, double grow, Polygon& polygon, Polygon& scratch) {
  if (hull.size() < 2) return;
  for (std::size_t i = 0; i < hull.size(); ++i)
    clip(hull[i], hull[(i + 1) % hull.size()] - hull[i], grow, polygon, scratch);
}

}  // namespace

void convexHull(Polygon& points, Polygon& hull) {
  std::sort(points.begin(), points.end(),
            [](const Vec2& a, const Vec2& b) { return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y(); });
  points.erase(std::unique(points.begin(), points.end()), points.end());
  hull.clear();
  if (points.size() < 3) {
    hull = points;
    return;
  }
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
}

void grownIntersection(const Polygon& p, double grow_p, const Polygon& q, double grow_q, Polygon& both,
                       Polygon& scratch) {
  constexpr double kUp = 1.0 + 1e-12;
  Vec2 low_p, high_p, low_q, high_q;
  boxOf(p, &low_p, &high_p);
  boxOf(q, &low_q, &high_q);
  const Vec2 low = (low_p.array() - grow_p * kUp).max(low_q.array() - grow_q * kUp);
  const Vec2 high = (high_p.array() + grow_p * kUp).min(high_q.array() + grow_q * kUp);
  both.clear();
  if (!(low.x() <= high.x() && low.y() <= high.y())) return;
  both = {low, {high.x(), low.y()}, high, {low.x(), high.y()}};
  clipToGrown(p, grow_p * kUp, both, scratch);
  clipToGrown(q, grow_q * kUp, both, scratch);
}

void enclosingDisc(const Polygon& points, Vec2* centre, double* radius) {
  Vec2 low, high;
  boxOf(points, &low, &high);
  *centre = 0.5 * (low + high);
  *radius = 0.0;
  for (const Vec2& v : points) *radius = std::max(*radius, (v - *centre).norm());
}

double discInHull(Polygon& points, Polygon& hull, Vec2* out) {
  convexHull(points, hull);
  if (out != nullptr) out->setZero();
  if (hull.size() < 3) return 0.0;
  double radius = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const Vec2 edge = hull[(i + 1) % hull.size()] - hull[i];
    const double length = edge.norm();
    const double inside = length > 0.0 ? cross(edge, -hull[i]) / length : radius;
    if (!(inside < radius)) continue;
    radius = inside;
    if (out != nullptr) *out = Vec2(edge.y(), -edge.x()) / length;
  }
  return std::max(0.0, radius);
}

}  // namespace collision_node::impact

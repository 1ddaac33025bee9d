#include "collision_node/impact/convex/polygon.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "collision_node/geometry/rounding.h"

namespace collision_node::impact {
namespace {

using geometry::kUnit;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kAmply = 1.0 + 1e-12;  ///< more than all roundings on the way

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
  Vec2 low_p, high_p, low_q, high_q;
  boxOf(p, &low_p, &high_p);
  boxOf(q, &low_q, &high_q);
  const Vec2 low = (low_p.array() - grow_p * kAmply).max(low_q.array() - grow_q * kAmply);
  const Vec2 high = (high_p.array() + grow_p * kAmply).min(high_q.array() + grow_q * kAmply);
  both.clear();
  if (!(low.x() <= high.x() && low.y() <= high.y())) return;
  both = {low, {high.x(), low.y()}, high, {low.x(), high.y()}};
  clipToGrown(p, grow_p * kAmply, both, scratch);
  clipToGrown(q, grow_q * kAmply, both, scratch);
}

void enclosingDisc(const Polygon& points, Vec2* centre, double* radius) {
  Vec2 low, high;
  if (points.empty()) {
    centre->setZero();
    *radius = kInfinity;
    return;
  }
  boxOf(points, &low, &high);
  *centre = 0.5 * (low + high);
  *radius = 0.0;
  for (const Vec2& v : points) *radius = std::max(*radius, (v - *centre).norm());
}

double discInHull(Polygon& points, Polygon& hull, Vec2* out) {
  convexHull(points, hull);
  if (out != nullptr) out->setZero();
  if (hull.size() < 3) return 0.0;
  double radius = kInfinity;
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

Strip stripOf(const Polygon& points) {
  Strip s;
  const auto farthest = [&](const Vec2& from) {
    const Vec2* best = &points[0];
    s.length2 = 0.0;
    for (const Vec2& p : points) {
      const double length2 = (p - from).squaredNorm();
      if (!(length2 > s.length2)) continue;
      s.length2 = length2;
      best = &p;
    }
    return *best;
  };
  const Vec2 end = farthest(points[0]), along = farthest(end) - end;
  s.across = s.length2 > 0.0 ? Vec2(Vec2(-along.y(), along.x()) / std::sqrt(s.length2)) : Vec2(1.0, 0.0);
  s.low = kInfinity;
  s.high = -kInfinity;
  for (const Vec2& p : points) {
    const double x = s.across.dot(p);
    s.low = std::min(s.low, x);
    s.high = std::max(s.high, x);
  }
  return s;
}

bool crossing(const Strip& a, double grow_a, const Strip& b, double grow_b, Vec2* centre, double* radius) {
  constexpr double kLeastSine = 1e-3;
  const double sine = a.across.x() * b.across.y() - a.across.y() * b.across.x();
  const double cosine = a.across.dot(b.across);
  if (!(std::abs(sine) > kLeastSine)) return false;
  const double middle_a = 0.5 * (a.low + a.high), middle_b = 0.5 * (b.low + b.high);
  const double half_a = 0.5 * (a.high - a.low) + grow_a, half_b = 0.5 * (b.high - b.low) + grow_b;
  *centre = Vec2(middle_a * b.across.y() - middle_b * a.across.y(),
                 middle_b * a.across.x() - middle_a * b.across.x()) /
            sine;
  const double rounding = 64.0 * kUnit * (std::abs(middle_a) + std::abs(middle_b)) / std::abs(sine);
  *radius = std::sqrt(half_a * half_a + half_b * half_b + 2.0 * half_a * half_b * std::abs(cosine)) /
                std::abs(sine) * kAmply +
            rounding;
  return true;
}

}  // namespace collision_node::impact

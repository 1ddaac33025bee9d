#include "collision_node/impact/straight/closest_on_triangle.h"

#include <algorithm>

namespace collision_node::impact {
namespace {

using geometry::Vec3;

/// For a triangle without area.
Vec3 closestOnSegment(const Vec3& x, const Vec3& a, const Vec3& b) {
  const Vec3 e = b - a;
  const double length2 = e.squaredNorm();
  return length2 > 0.0 ? Vec3(a + std::clamp((x - a).dot(e) / length2, 0.0, 1.0) * e) : a;
}

}  // namespace

Vec3 closestOnTriangle(const Vec3& x, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, ax = x - a;
  const double d1 = ab.dot(ax), d2 = ac.dot(ax);
  if (d1 <= 0.0 && d2 <= 0.0) return a;
  const Vec3 bx = x - b;
  const double d3 = ab.dot(bx), d4 = ac.dot(bx);
  if (d3 >= 0.0 && d4 <= d3) return b;
  const Vec3 cx = x - c;
  const double d5 = ab.dot(cx), d6 = ac.dot(cx);
  if (d6 >= 0.0 && d5 <= d6) return c;
  const double wc = d1 * d4 - d3 * d2, wb = d5 * d2 - d1 * d6, wa = d3 * d6 - d5 * d4;
  const double whole = wa + wb + wc;
  if (wa > 0.0 && wb > 0.0 && wc > 0.0 && whole > 0.0) return a + (wb / whole) * ab + (wc / whole) * ac;
  Vec3 best = closestOnSegment(x, a, b);
  for (const Vec3& q : {closestOnSegment(x, b, c), closestOnSegment(x, c, a)}) {
    if ((x - q).squaredNorm() < (x - best).squaredNorm()) best = q;
  }
  return best;
}

}  // namespace collision_node::impact

#include "collision_node/impact/proof/inside.h"

#include <algorithm>
#include <boost/container/small_vector.hpp>
#include <cmath>
#include <limits>

namespace collision_node::impact {
namespace {

/// Fixed directions in general position; another is tried when a sign is uncertain.
const Vec3 kDirections[] = {
    {0.5773, 0.5613, 0.5930},   {-0.2715, 0.8437, -0.4632}, {0.1234, -0.3987, 0.9088},
    {0.8461, -0.5102, -0.1543}, {-0.6621, -0.2113, 0.719},  {-0.3301, 0.2902, 0.8982},
    {0.0417, 0.9913, 0.1247},   {-0.9411, 0.1871, -0.2817}, {0.2931, -0.9122, -0.287},
    {0.6617, 0.1123, -0.7413},  {-0.1107, -0.7093, -0.696}, {0.3719, 0.7121, -0.5955}};

/// Could the line through `p` along `u`, thickened by `error`, meet the box ahead of p?
bool meetsBox(const Vec3& p, const Vec3& u, const geometry::Bvh& bvh, std::int32_t node, double error) {
  const Vec3 centre = bvh.centre(node), half_box = bvh.half(node);
  double low = -1e-300, high = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) {
    const double half = half_box[k] + error + 1e-12 * (half_box[k] + std::abs(centre[k]) + std::abs(p[k]));
    const double near = (centre[k] - p[k] - half) / u[k], far = (centre[k] - p[k] + half) / u[k];
    low = std::max(low, std::min(near, far));
    high = std::min(high, std::max(near, far));
  }
  return low <= high * (1.0 + 1e-12) + 1e-300;
}

/// Six times the volume of p and a triangle, positive where p is behind it, and a bound of its error. The
/// corners are exact, so an error of p counts along the normal only; the two shortest edges keep the digits
/// of slivers.
double volumeOf(const Vec3& p, const Element& t, double error, double* slack) {
  int corner = 0;
  double shortest = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) {
    const Vec3& x = t.vertices[k];
    const double product = (t.vertices[(k + 1) % 3] - x).norm() * (t.vertices[(k + 2) % 3] - x).norm();
    if (product < shortest) shortest = product, corner = k;
  }
  const Vec3& x = t.vertices[corner];
  const Vec3 n = (t.vertices[(corner + 1) % 3] - x).cross(t.vertices[(corner + 2) % 3] - x), away = x - p;
  *slack = error * (n.norm() + 16.0 * kUnit * shortest) + 32.0 * kUnit * away.norm() * shortest;
  return away.dot(n);
}

/// Crossing of one triangle: +-1, 0, or uncertain. p off by e changes u.(a x b) by |u| |b - a| e.
bool crossing(const Vec3& p, const Vec3& u, const Element& t, double error, int* sign) {
  const Vec3 a = t.vertices[0] - p, b = t.vertices[1] - p, c = t.vertices[2] - p;
  const double na = a.norm(), nb = b.norm(), nc = c.norm(), length = (1.0 + 16.0 * kUnit) * u.norm();
  const double slack_ab = length * (error * (b - a).norm() + 32.0 * kUnit * na * nb);
  const double slack_bc = length * (error * (c - b).norm() + 32.0 * kUnit * nb * nc);
  const double slack_ca = length * (error * (a - c).norm() + 32.0 * kUnit * nc * na);
  const double ab = u.dot(a.cross(b)), bc = u.dot(b.cross(c)), ca = u.dot(c.cross(a));
  *sign = 0;
  const bool all_positive = ab > slack_ab && bc > slack_bc && ca > slack_ca;
  const bool all_negative = ab < -slack_ab && bc < -slack_bc && ca < -slack_ca;
  if (!all_positive && !all_negative) {
    const bool some_positive = ab > slack_ab || bc > slack_bc || ca > slack_ca;
    const bool some_negative = ab < -slack_ab || bc < -slack_bc || ca < -slack_ca;
    return some_positive && some_negative;  // certainly misses
  }
  // Ahead of or behind p: the side of p seen from the triangle.
  double slack = 0.0;
  const double volume = volumeOf(p, t, error, &slack);
  if (std::abs(volume) <= slack) return false;
  const bool ahead = (volume > 0.0) == all_positive;
  if (ahead) *sign = all_positive ? 1 : -1;
  return true;
}

bool windingAlong(const Body& body, int solid, const Vec3& p, const Vec3& u, double error, int* winding) {
  const geometry::Bvh& bvh = body.bvh();
  boost::container::small_vector<std::int32_t, 256> stack = {geometry::Bvh::kRoot};
  Vec3 buffer[3];
  *winding = 0;
  while (!stack.empty()) {
    const std::int32_t id = stack.back();
    stack.pop_back();
    if (!bvh.exists(id) || !meetsBox(p, u, bvh, id, error)) continue;
    const geometry::BvhNode node = bvh[id];
    if (!node.leaf()) {
      for (int i = 0; i < geometry::BvhBlock::kWidth; ++i)
        stack.push_back(geometry::BvhBlock::kWidth * node.link + i);
      continue;
    }
    const Element element = body.element(node.element(), buffer);
    if (element.shape != solid) continue;
    int sign = 0;
    if (!crossing(p, u, element, error, &sign)) return false;
    *winding += sign;
  }
  return true;
}

/// A point of one body, turned into the other's frame: off by the pose errors, times the other's reach where
/// it is within that; farther out its distance alone proves it outside.
Vec3 seenByOther(const Instant& now, bool of_a, const Vec3& x) {
  return of_a ? Vec3(now.rb.transpose() * (now.ra * x - now.d))
              : Vec3(now.ra.transpose() * (now.d + now.rb * x));
}

Where inAnySolid(const PairPiece& piece, const Instant& now, bool of_a, const Vec3& x, Vec3* held) {
  const Body& other = of_a ? piece.b : piece.a;
  const Vec3 p = seenByOther(now, of_a, x);
  Where answer = Where::kOutside;
  for (const int solid : other.solids()) {
    const Where where = whereIn(other, solid, p, piece.point_error);
    if (where == Where::kInside) {
      *held = of_a ? Vec3(now.d + now.rb * p) : Vec3(now.ra * p);
      return where;
    }
    if (where == Where::kUnknown) answer = where;
  }
  return answer;
}

/// [m] Where it is narrowest, or more if it is no triangle.
double widthOf(const Element& e) {
  if (e.vertices == nullptr) return 2.0 * (e.rim_radius + e.half_length);
  double longest = 0.0;
  for (int i = 1; i < e.count; ++i) longest = std::max(longest, (e.vertices[i] - e.vertices[0]).norm());
  if (e.count != 3) return 2.0 * (longest + e.radius);
  const Vec3 u = e.vertices[1] - e.vertices[0], v = e.vertices[2] - e.vertices[0];
  longest = std::max(longest, (u - v).norm());
  return longest > 0.0 ? u.cross(v).norm() / longest : 0.0;
}

bool isNarrow(const PairPiece& piece, const Element& e) {
  constexpr double kNarrow = 16.0;
  return widthOf(e) <= kNarrow * piece.point_error;
}

}  // namespace

Where whereIn(const Body& body, int solid, const Vec3& point, double error) {
  const Vec3 off = (point - body.bvh().centre(0)).cwiseAbs() - body.bvh().half(0);
  if (off.maxCoeff() > error + 1e-12 * (body.reach() + point.norm())) return Where::kOutside;
  for (const Vec3& u : kDirections) {
    int winding = 0;
    if (windingAlong(body, solid, point, u, error, &winding))
      return winding != 0 ? Where::kInside : Where::kOutside;
  }
  return Where::kUnknown;
}

void HiddenPoints::offer(const Point& point) {
  const auto is_same = [&](const Point& p) { return p.of_a == point.of_a && p.x == point.x; };
  if (std::any_of(deepest_.begin(), deepest_.end(), is_same)) return;
  if (deepest_.size() < deepest_.capacity()) {
    deepest_.push_back(point);
    return;
  }
  const auto shallowest = std::min_element(deepest_.begin(), deepest_.end(),
                                           [](const Point& p, const Point& q) { return p.depth < q.depth; });
  if (point.depth > shallowest->depth) *shallowest = point;
}

void HiddenPoints::add(const PairPiece& piece, const Instant& now, const Element& a, const Element& b) {
  for (const bool of_a : {true, false}) {
    const Element& e = of_a ? a : b;
    if ((of_a ? piece.b : piece.a).solids().empty() || !isNarrow(piece, e)) continue;
    const Vec3* const points = e.vertices != nullptr ? e.vertices : &e.centre;
    for (int i = 0; i < std::max(e.count, 1); ++i) {
      const double along = towards_.dot(of_a ? Vec3(now.ra * points[i]) : Vec3(now.d + now.rb * points[i]));
      offer({points[i], of_a, of_a ? along : -along});
    }
  }
}

bool HiddenPoints::areHeld(const PairPiece& piece, const Instant& now, Vec3* held) const {
  return std::any_of(deepest_.begin(), deepest_.end(), [&](const Point& p) {
    return inAnySolid(piece, now, p.of_a, p.x, held) == Where::kInside;
  });
}

Where containment(const PairPiece& piece, const Instant& now, Vec3* held) {
  Where answer = Where::kOutside;
  for (const bool of_a : {true, false}) {
    if ((of_a ? piece.b : piece.a).solids().empty()) continue;
    for (const Vec3& x : (of_a ? piece.a : piece.b).representatives()) {
      const Where where = inAnySolid(piece, now, of_a, x, held);
      if (where == Where::kInside) return where;
      if (where == Where::kUnknown) answer = where;
    }
  }
  return answer;
}

}  // namespace collision_node::impact

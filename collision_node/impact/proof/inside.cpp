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

/// `place` takes the other body's points into this one's frame.
template <typename Place>
Where anyInside(const Body& body, const Body& other, const Place& place, double error, Vec3* found) {
  Where answer = Where::kOutside;
  for (const int solid : body.solids()) {
    for (const Vec3& x : other.representatives()) {
      const Vec3 p = place(x);
      const Where where = whereIn(body, solid, p, error);
      if (where == Where::kInside) {
        *found = p;
        return where;
      }
      if (where == Where::kUnknown) answer = where;
    }
  }
  return answer;
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

Where containment(const PairPiece& piece, const Instant& now, Vec3* held) {
  if (piece.a.solids().empty() && piece.b.solids().empty()) return Where::kOutside;
  // A point of the one, turned into the other's frame: off by the pose errors, times the other's reach where
  // it is within that; farther out its distance alone proves it outside.
  const double error = piece.point_error;
  Where answer = Where::kOutside;
  Vec3 found;
  if (!piece.b.solids().empty()) {
    const auto place = [&](const Vec3& x) -> Vec3 { return now.rb.transpose() * (now.ra * x - now.d); };
    answer = anyInside(piece.b, piece.a, place, error, &found);
    if (answer == Where::kInside) {
      *held = now.d + now.rb * found;
      return answer;
    }
  }
  if (!piece.a.solids().empty()) {
    const auto place = [&](const Vec3& y) -> Vec3 { return now.ra.transpose() * (now.d + now.rb * y); };
    const Where other = anyInside(piece.a, piece.b, place, error, &found);
    if (other == Where::kInside) {
      *held = now.ra * found;
      return other;
    }
    if (other == Where::kUnknown) answer = other;
  }
  return answer;
}

}  // namespace collision_node::impact

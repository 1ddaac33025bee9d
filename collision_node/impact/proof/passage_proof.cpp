#include "collision_node/impact/proof/passage_proof.h"

#include <algorithm>
#include <cmath>

namespace collision_node::impact {

bool passesThrough(const PairPiece& piece, const Instant& from, const Instant& to, bool point_is_a,
                   const Vec3& point, const TrianglePatch& patch) {
  // In the triangles' frame, relative to where the point is at `from`: the triangles stand still.
  const auto pointAt = [&](const Instant& now) -> Vec3 {
    if (point_is_a) return now.rb.transpose() * (now.ra * point - now.d);
    return now.ra.transpose() * (now.d + now.rb * point);
  };
  const Vec3 x0 = pointAt(from), x1 = pointAt(to);
  double size = 0.0;
  for (const auto& t : patch) {
    for (const Vec3& v : t) size = std::max({size, (v - x0).norm(), (v - x1).norm()});
  }
  const double dt = to.t - from.t;
  const double spin = point_is_a ? piece.motion.spinB() : piece.motion.spinA();
  const double e = 2.0 * piece.point_error + 16.0 * kUnit * size;
  // The point's path in that frame has a length m <= dt (speed + spin (size + m/2)): relative speed, and the
  // frame's own turn, half of the path away from one of its ends at most.
  if (!(spin * dt < 1.0)) return false;
  const double move = (piece.speed + spin * size) * dt * (1.0 + spin * dt) * (1.0 + 16.0 * kUnit) + e;
  const double reach = size + move;
  // From its chord it strays by dt^2/8 of its acceleration there, in terms of the turning frame.
  const RelativeMotion& m = piece.motion;
  const double own = (point_is_a ? m.spinA() : m.spinB()) * point.norm();
  const double fastest = m.maxSpeed() + own, farthest = x0.norm() + fastest * dt;
  const double bend = m.maxAcceleration() + (point_is_a ? m.spinA() : m.spinB()) * own +
                      spin * (2.0 * fastest + spin * farthest);
  const double strays = 0.125 * dt * dt * bend * (1.0 + 64.0 * kUnit) + e;

  Vec3 up = Vec3::Zero();
  for (const auto& t : patch) {
    const Vec3 n = (t[1] - t[0]).cross(t[2] - t[0]);
    if (n.squaredNorm() > up.squaredNorm()) up = n;
  }
  if (!(up.norm() > 0.0)) return false;
  up.normalize();

  // The patch is a graph over the plane across `up`: every triangle, wound to face it, leans clearly towards
  // it.
  TrianglePatch faces;
  bool above = true, below = true;
  for (auto t : patch) {
    Vec3 n = (t[1] - t[0]).cross(t[2] - t[0]);
    if (n.dot(up) < 0.0) {
      std::swap(t[1], t[2]);
      n = -n;
    }
    // The same triangle again, with either sense, adds nothing.
    const auto isCorner = [&](const Vec3& v) { return v == t[0] || v == t[1] || v == t[2]; };
    if (std::any_of(faces.begin(), faces.end(),
                    [&](const auto& other) { return std::all_of(other.begin(), other.end(), isCorner); }))
      continue;
    const double edges = (t[1] - t[0]).norm() * (t[2] - t[0]).norm();
    if (!(n.dot(up) > 64.0 * kUnit * edges)) return false;
    const double slack = n.norm() * e + 64.0 * kUnit * edges * size;
    const double h0 = n.dot(x0 - t[0]), h1 = n.dot(x1 - t[0]);
    above &= h0 > slack && h1 < -slack;
    below &= h0 < -slack && h1 > slack;
    faces.push_back(t);
  }
  // On one side of every plane at first, on the other at last: it changes the graph's side ...
  if (!above && !below) return false;
  // ... and stays over it all the time: left of every edge of the patch's border, seen along `up`.
  bool has_border = false;
  for (const auto& t : faces) {
    for (int k = 0; k < 3; ++k) {
      const Vec3 &i = t[k], &j = t[(k + 1) % 3];
      int same = 0, reverse = 0;
      for (const auto& other : faces) {
        for (int l = 0; l < 3; ++l) {
          same += other[l] == i && other[(l + 1) % 3] == j;
          reverse += other[l] == j && other[(l + 1) % 3] == i;
        }
      }
      if (same > 1 || reverse > 1) return false;  // no graph where three triangles share an edge
      if (reverse == 1) continue;
      has_border = true;
      const auto isLeft = [&](const Vec3& x, double by) {
        return up.dot((i - x).cross(j - x)) > by * (j - i).norm() + 64.0 * kUnit * reach * reach;
      };
      if (!(isLeft(x0, move) || (isLeft(x0, strays) && isLeft(x1, strays)))) return false;
    }
  }
  return has_border;
}

}  // namespace collision_node::impact

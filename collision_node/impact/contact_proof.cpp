#include "collision_node/impact/contact_proof.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace collision_node::impact {
namespace {

constexpr std::size_t kMaxWrapPoints = 48;

/// The relative position of a material point pair at another instant.
Vec3 differenceAt(const Instant& now, const SupportPair& p) { return now.d + now.rb * p.local_b - now.ra * p.local_a; }

/// Bound of |w(t) - chord| between two instants: the exact path's second derivative, and the points' own errors.
double chordError(const PairPiece& piece, double dt) {
  const RelativeMotion& m = piece.motion;
  const double acceleration = m.maxAcceleration() + m.spinA() * m.spinA() * piece.a.reach() +
                              m.spinB() * m.spinB() * piece.b.reach();
  return 0.125 * dt * dt * acceleration * (1.0 + 16.0 * kUnit) + piece.point_error;
}

double det(const Vec3& a, const Vec3& b, const Vec3& c) { return a.dot(b.cross(c)); }

/// Every face at a known side of the origin between the two instants: Bernstein coefficients of the determinant of
/// three chords, minus what the true paths can differ from them.
bool wrapHolds(const PairPiece& piece, const Instant& from, const Instant& to, const Wrap& wrap) {
  const double e = chordError(piece, to.t - from.t);
  std::vector<Vec3> p(wrap.points.size()), q(wrap.points.size());
  std::vector<double> size(wrap.points.size());
  for (std::size_t i = 0; i < p.size(); ++i) {
    p[i] = differenceAt(from, wrap.points[i]);
    q[i] = differenceAt(to, wrap.points[i]);
    size[i] = std::max(p[i].norm(), q[i].norm()) * (1.0 + 16.0 * kUnit) + e;
  }
  for (const auto& f : wrap.faces) {
    const int i = f[0], j = f[1], k = f[2];
    // |det(u + e) - det(u)| <= e (|v||w| + |u||w| + |u||v|) with sizes that already hold e; 32u for the arithmetic.
    const double slack = e * (size[i] * size[j] + size[j] * size[k] + size[i] * size[k]) +
                         32.0 * kUnit * size[i] * size[j] * size[k];
    const double b0 = det(p[i], p[j], p[k]);
    const double b3 = det(q[i], q[j], q[k]);
    const double b1 = det(q[i], p[j], p[k]) + det(p[i], q[j], p[k]) + det(p[i], p[j], q[k]);
    const double b2 = det(p[i], q[j], q[k]) + det(q[i], p[j], q[k]) + det(q[i], q[j], p[k]);
    if (!(b0 > slack && b3 > slack && b1 > 3.0 * slack && b2 > 3.0 * slack)) return false;
  }
  return true;
}

/// Every directed edge once, its reverse once: the premise of the winding argument.
bool isClosed(const Wrap& wrap) {
  for (const auto& f : wrap.faces) {
    for (int k = 0; k < 3; ++k) {
      int same = 0, reverse = 0;
      for (const auto& g : wrap.faces) {
        for (int l = 0; l < 3; ++l) {
          same += g[l] == f[k] && g[(l + 1) % 3] == f[(k + 1) % 3];
          reverse += g[l] == f[(k + 1) % 3] && g[(l + 1) % 3] == f[k];
        }
      }
      if (same != 1 || reverse != 1) return false;
    }
  }
  return !wrap.faces.empty();
}

struct Face {
  Vec3 normal;     ///< unit, outward
  double depth;    ///< signed distance of the origin inside its plane
};

Face faceOf(const Wrap& wrap, const std::array<int, 3>& f) {
  const Vec3 &a = wrap.points[f[0]].w, &b = wrap.points[f[1]].w, &c = wrap.points[f[2]].w;
  const Vec3 n = (b - a).cross(c - a);
  const double length = n.norm();
  if (!(length > 0.0)) return {Vec3::Zero(), std::numeric_limits<double>::infinity()};
  const Vec3 unit = n / length;
  return {unit, unit.dot(a)};
}

/// A first tetrahedron: farthest points along, across and above one another.
bool firstTetrahedron(const Cores& cores, Wrap& wrap) {
  const auto add = [&](const Vec3& direction) {
    wrap.points.push_back(cores.support(direction));
    return wrap.points.back().w;
  };
  Vec3 first = add(Vec3(1.0, 0.3, 0.2));
  Vec3 second = add(-first);
  Vec3 edge = second - first;
  if (!(edge.norm() > 0.0)) {
    wrap.points.pop_back();
    second = add(Vec3(-1.0, -0.3, -0.2));
    edge = second - first;
  }
  if (!(edge.norm() > 0.0)) return false;
  int axis = 0;
  edge.cwiseAbs().minCoeff(&axis);
  Vec3 side = edge.cross(Vec3::Unit(axis));
  const double size = edge.norm();
  // The side that faces the origin first: the wrap should close around it.
  const Vec3 toward = -(first - edge * (first.dot(edge) / edge.squaredNorm()));
  if (toward.norm() > 1e-9 * size) side = toward;
  Vec3 third = add(side);
  Vec3 normal = edge.cross(third - first);
  if (!(normal.norm() > 1e-12 * size * size)) {
    for (const Vec3& other : {Vec3(-side), Vec3(edge.cross(side)), Vec3(-edge.cross(side))}) {
      wrap.points.pop_back();
      third = add(other);
      normal = edge.cross(third - first);
      if (normal.norm() > 1e-12 * size * size) break;
    }
  }
  if (!(normal.norm() > 0.0)) return false;
  if (normal.dot(first) > 0.0) normal = -normal;  // toward the origin
  Vec3 fourth = add(normal);
  double height = normal.normalized().dot(fourth - first);
  if (!(std::abs(height) > 0.0)) {
    wrap.points.pop_back();
    fourth = add(-normal);
    height = normal.normalized().dot(fourth - first);
  }
  if (!(std::abs(height) > 0.0)) return false;
  const bool flip = det(second - first, third - first, fourth - first) > 0.0;
  // outward faces of the tetrahedron 0 1 2 3
  if (flip) {
    wrap.faces = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  } else {
    wrap.faces = {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}};
  }
  return true;
}

/// Replaces what `w` sees by a cone over the horizon.
bool addPoint(Wrap& wrap, const SupportPair& point, std::size_t seed) {
  const int id = static_cast<int>(wrap.points.size());
  std::vector<char> seen(wrap.faces.size(), 0);
  std::vector<std::size_t> stack = {seed};
  seen[seed] = 1;
  std::vector<std::array<int, 3>> cone;
  while (!stack.empty()) {
    const auto f = wrap.faces[stack.back()];
    stack.pop_back();
    for (int k = 0; k < 3; ++k) {
      const int from = f[k], to = f[(k + 1) % 3];
      std::size_t other = wrap.faces.size();
      for (std::size_t g = 0; g < wrap.faces.size() && other == wrap.faces.size(); ++g) {
        for (int l = 0; l < 3; ++l) {
          if (wrap.faces[g][l] == to && wrap.faces[g][(l + 1) % 3] == from) other = g;
        }
      }
      if (other == wrap.faces.size()) return false;
      if (seen[other] == 1) continue;
      const Face plane = faceOf(wrap, wrap.faces[other]);
      if (plane.normal.dot(point.w - wrap.points[wrap.faces[other][0]].w) > 0.0) {
        seen[other] = 1;
        stack.push_back(other);
      } else {
        cone.push_back({from, to, id});
      }
    }
  }
  // A face first met across a hidden edge may have been seen later: its horizon edges are then inside.
  std::vector<std::array<int, 3>> faces;
  for (std::size_t g = 0; g < wrap.faces.size(); ++g) {
    if (!seen[g]) faces.push_back(wrap.faces[g]);
  }
  for (const auto& c : cone) {
    bool inner = false;
    for (std::size_t g = 0; g < wrap.faces.size() && !inner; ++g) {
      if (!seen[g]) continue;
      for (int l = 0; l < 3; ++l) inner |= wrap.faces[g][l] == c[1] && wrap.faces[g][(l + 1) % 3] == c[0];
    }
    if (!inner) faces.push_back(c);
  }
  wrap.points.push_back(point);
  wrap.faces.swap(faces);
  return true;
}

/// |sum of weight_i w_i| control points of a linear blend between two instants, each within `limit`?
bool closeThrough(const Instant& from, const Instant& to, const Closest& first, const Closest& last, double limit) {
  const auto blend = [](const Closest& c, const Instant& now) {
    Vec3 x = Vec3::Zero();
    for (int i = 0; i < c.count; ++i) x += c.weight[i] * differenceAt(now, c.point[i]);
    return x;
  };
  const Vec3 x0 = blend(first, from);
  const Vec3 x1 = 0.5 * (blend(first, to) + blend(last, from));
  const Vec3 x2 = blend(last, to);
  return x0.norm() <= limit && x1.norm() <= limit && x2.norm() <= limit;
}

}  // namespace

bool buildWrap(const Cores& cores, double depth, Wrap& wrap) {
  wrap.points.clear();
  wrap.faces.clear();
  if (!firstTetrahedron(cores, wrap)) return false;
  while (wrap.points.size() < kMaxWrapPoints) {
    std::size_t worst = 0;
    Face nearest{Vec3::Zero(), std::numeric_limits<double>::infinity()};
    for (std::size_t f = 0; f < wrap.faces.size(); ++f) {
      const Face face = faceOf(wrap, wrap.faces[f]);
      if (face.depth < nearest.depth) {
        nearest = face;
        worst = f;
      }
    }
    if (nearest.depth >= depth) return isClosed(wrap);
    const SupportPair next = cores.support(nearest.normal);
    const double reach = nearest.normal.dot(next.w);
    // The support plane bounds the depth of the whole difference from above.
    if (reach < depth) return false;
    if (!(reach > nearest.depth)) return false;
    if (!addPoint(wrap, next, worst)) return false;
  }
  return false;
}

bool touchesAt(const PairPiece& piece, const Instant& now, const Element& a, const Element& b, const Closest& closest,
               ContactWitness& witness) {
  const Cores cores(now, a, b);
  const double radius = a.radius + b.radius + piece.contact_distance;
  if (radius > 0.0) {
    if (!closeThrough(now, now, closest, closest, radius - 2.0 * piece.point_error)) return false;
    witness.rounded = true;
    witness.closest = closest;
    Vec3 pa = Vec3::Zero();
    for (int i = 0; i < closest.count; ++i) pa += closest.weight[i] * (now.ra * closest.point[i].local_a);
    const double share = radius > 0.0 ? (a.radius + 0.5 * piece.contact_distance) / radius : 0.5;
    witness.point = pa + share * closest.v;
    return true;
  }
  if (a.count == 1 && b.count == 1) return false;  // two points: never provable
  if (!closest.overlap && closest.v.norm() > 16.0 * piece.point_error) return false;
  for (double depth = 4.0 * piece.point_error; depth < 5e3 * piece.point_error; depth *= 8.0) {
    if (!buildWrap(cores, depth, witness.wrap)) return false;
    if (wrapHolds(piece, now, now, witness.wrap)) {
      witness.rounded = false;
      // The common point: by GJK's weights where it found the origin inside, else the support of the nearest face.
      Vec3 pa = Vec3::Zero();
      for (int i = 0; i < closest.count; ++i) pa += closest.weight[i] * (now.ra * closest.point[i].local_a);
      witness.point = pa;
      return true;
    }
  }
  return false;
}

bool touchesThrough(const PairPiece& piece, const Instant& from, const Instant& to, const Element& a, const Element& b,
                    const ContactWitness& witness) {
  if (!witness.rounded) return wrapHolds(piece, from, to, witness.wrap);
  const double radius = a.radius + b.radius + piece.contact_distance;
  const Closest last = closestPoints(Cores(to, a, b), witness.closest.v);
  return closeThrough(from, to, witness.closest, last, radius - chordError(piece, to.t - from.t) - piece.point_error);
}

bool passesThrough(const PairPiece& piece, const Instant& from, const Instant& to, bool point_is_a, const Vec3& point,
                   const std::vector<std::array<Vec3, 3>>& patch) {
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
  // The point's path in that frame stays this close to x0: relative speed, and the frame's own turn.
  const double move = (piece.speed + spin * size) * dt * (1.0 + 16.0 * kUnit) + e;
  const double reach = size + move;

  Vec3 up = Vec3::Zero();
  for (const auto& t : patch) {
    const Vec3 n = (t[1] - t[0]).cross(t[2] - t[0]);
    if (n.squaredNorm() > up.squaredNorm()) up = n;
  }
  if (!(up.norm() > 0.0)) return false;
  up.normalize();

  // The patch is a graph over the plane across `up`: every triangle, wound to face it, leans clearly towards it.
  std::vector<std::array<Vec3, 3>> faces;
  bool above = true, below = true;
  for (auto t : patch) {
    Vec3 n = (t[1] - t[0]).cross(t[2] - t[0]);
    if (n.dot(up) < 0.0) {
      std::swap(t[1], t[2]);
      n = -n;
    }
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
      bool inner = false;
      for (const auto& other : faces) {
        for (int l = 0; l < 3; ++l) inner |= other[l] == j && other[(l + 1) % 3] == i;
      }
      if (inner) continue;
      has_border = true;
      const double value = up.dot((i - x0).cross(j - x0));
      if (!(value > move * (j - i).norm() + 64.0 * kUnit * reach * reach)) return false;
    }
  }
  return has_border;
}

}  // namespace collision_node::impact

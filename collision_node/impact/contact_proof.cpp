#include "collision_node/impact/contact_proof.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "collision_node/impact/closest_points.h"

namespace collision_node::impact {
namespace {

constexpr std::size_t kMaxWrapPoints = 96;

/// The relative position of a material point pair at another instant.
Vec3 differenceAt(const Instant& now, const SupportPair& p) {
  return now.d + now.rb * p.local_b - now.ra * p.local_a;
}

/// Bound of |w(t) - chord| between two instants: the exact path's second derivative, and the points' own
/// errors.
double chordError(const PairPiece& piece, double dt) {
  const RelativeMotion& m = piece.motion;
  const double acceleration =
      m.maxAcceleration() + m.spinA() * m.spinA() * piece.a.reach() + m.spinB() * m.spinB() * piece.b.reach();
  return 0.125 * dt * dt * acceleration * (1.0 + 16.0 * kUnit) + piece.point_error;
}

double det(const Vec3& a, const Vec3& b, const Vec3& c) { return a.dot(b.cross(c)); }

/// Control vectors of the product of two linear vector functions u(x), v(x) given at both ends.
double largestCross(const Vec3& u0, const Vec3& u1, const Vec3& v0, const Vec3& v1) {
  return std::max({u0.cross(v0).norm(), 0.5 * (u0.cross(v1) + u1.cross(v0)).norm(), u1.cross(v1).norm()});
}

/// The same face, begun at the corner whose two edges have the smallest product: the determinant is the same
/// from any corner, its rounding is not.
std::array<int, 3> fromShortestEdges(const std::array<int, 3>& face, const std::vector<Vec3>& points) {
  double length[3];
  for (int k = 0; k < 3; ++k) length[k] = (points[face[(k + 1) % 3]] - points[face[k]]).squaredNorm();
  int best = 0;
  for (int k = 1; k < 3; ++k) {
    if (length[k] * length[(k + 2) % 3] < length[best] * length[(best + 2) % 3]) best = k;
  }
  return {face[best], face[(best + 1) % 3], face[(best + 2) % 3]};
}

/// Every face at a known side of the origin between the two instants: Bernstein coefficients of the
/// determinant of three chords, minus what the true paths can differ from them.
bool wrapHolds(const PairPiece& piece, const Instant& from, const Instant& to, const Wrap& wrap) {
  const double e = chordError(piece, to.t - from.t);
  std::vector<Vec3> p(wrap.points.size()), q(wrap.points.size());
  for (std::size_t i = 0; i < p.size(); ++i) {
    p[i] = differenceAt(from, wrap.points[i]);
    q[i] = differenceAt(to, wrap.points[i]);
  }
  for (const auto& face : wrap.faces) {
    const auto f = fromShortestEdges(face, p);
    const Vec3 &pi = p[f[0]], &pj = p[f[1]], &pk = p[f[2]], &qi = q[f[0]], &qj = q[f[1]], &qk = q[f[2]];
    const double size_i = std::max(pi.norm(), qi.norm()), size_j = std::max(pj.norm(), qj.norm()),
                 size_k = std::max(pk.norm(), qk.norm());
    // d det = (w_j x w_k) . dw_i + ..., with every dw up to e: first, second and third order.
    const double first =
        largestCross(pi, qi, pj, qj) + largestCross(pj, qj, pk, qk) + largestCross(pk, qk, pi, qi);
    const double sum = size_i + size_j + size_k;
    // The determinant is taken along the face's two shortest edges, so that slivers keep their digits.
    const Vec3 pu = pj - pi, pv = pk - pi, qu = qj - qi, qv = qk - qi;
    const double edges = std::max(pu.norm(), qu.norm()) * std::max(pv.norm(), qv.norm());
    const double slack = (e * (first + 32.0 * kUnit * sum * sum) + 2.0 * e * e * sum + e * e * e +
                          32.0 * kUnit * size_i * edges) *
                         (1.0 + 64.0 * kUnit);
    const double b0 = det(pi, pu, pv);
    const double b3 = det(qi, qu, qv);
    const double b1 = det(qi, pu, pv) + det(pi, qu, pv) + det(pi, pu, qv);
    const double b2 = det(pi, qu, qv) + det(qi, pu, qv) + det(qi, qu, pv);
    if (!(b0 > slack && b3 > slack && b1 > 3.0 * slack && b2 > 3.0 * slack)) return false;
  }
  return true;
}

/// A wrap under construction: faces with their planes, and which face owns each directed edge.
class WrapBuilder {
 public:
  WrapBuilder(const Cores& cores, Wrap& wrap)
      : cores_(cores), wrap_(wrap), owner_(kMaxWrapPoints * kMaxWrapPoints, -1) {}

  bool build(double depth);

 private:
  struct Face {
    Vec3 normal;   ///< unit, outward
    double depth;  ///< signed distance of the origin inside its plane
  };

  bool firstTetrahedron();
  bool addPoint(const SupportPair& point, std::size_t seed);
  bool isClosed() const;
  void addFace(int a, int b, int c);
  std::int16_t& owner(int from, int to) { return owner_[from * kMaxWrapPoints + to]; }

  const Cores& cores_;
  Wrap& wrap_;
  std::vector<Face> planes_;
  std::vector<std::int16_t> owner_;
};

void WrapBuilder::addFace(int a, int b, int c) {
  const Vec3 &pa = wrap_.points[a].w, &pb = wrap_.points[b].w, &pc = wrap_.points[c].w;
  const Vec3 n = (pb - pa).cross(pc - pa);
  const double length = n.norm();
  const int id = static_cast<int>(wrap_.faces.size());
  wrap_.faces.push_back({a, b, c});
  planes_.push_back(length > 0.0 ? Face{n / length, n.dot(pa) / length}
                                 : Face{Vec3::Zero(), std::numeric_limits<double>::infinity()});
  owner(a, b) = owner(b, c) = owner(c, a) = static_cast<std::int16_t>(id);
}

/// Every directed edge once, its reverse once: the premise of the winding argument.
bool WrapBuilder::isClosed() const {
  std::vector<char> edges(wrap_.points.size() * wrap_.points.size(), 0);
  const auto at = [&](int from, int to) { return static_cast<std::size_t>(from) * wrap_.points.size() + to; };
  for (const auto& f : wrap_.faces) {
    for (int k = 0; k < 3; ++k) {
      char& edge = edges[at(f[k], f[(k + 1) % 3])];
      if (edge != 0) return false;
      edge = 1;
    }
  }
  for (const auto& f : wrap_.faces) {
    for (int k = 0; k < 3; ++k) {
      if (edges[at(f[(k + 1) % 3], f[k])] == 0) return false;
    }
  }
  return !wrap_.faces.empty();
}

/// A first tetrahedron: farthest points along, across and above one another.
bool WrapBuilder::firstTetrahedron() {
  auto& points = wrap_.points;
  const auto add = [&](const Vec3& direction) {
    points.push_back(cores_.support(direction));
    return points.back().w;
  };
  Vec3 first = add(Vec3(1.0, 0.3, 0.2));
  Vec3 second = add(-first);
  Vec3 edge = second - first;
  if (!(edge.norm() > 0.0)) {
    points.pop_back();
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
      points.pop_back();
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
    points.pop_back();
    fourth = add(-normal);
    height = normal.normalized().dot(fourth - first);
  }
  if (!(std::abs(height) > 0.0)) return false;
  const bool flip = det(second - first, third - first, fourth - first) > 0.0;
  if (flip) std::swap(points[1], points[2]);
  addFace(0, 1, 2);
  addFace(0, 3, 1);
  addFace(1, 3, 2);
  addFace(2, 3, 0);
  return true;
}

/// Replaces the faces that see `point` by a cone over their horizon.
bool WrapBuilder::addPoint(const SupportPair& point, std::size_t seed) {
  std::vector<char> seen(wrap_.faces.size(), 0);
  std::vector<int> stack = {static_cast<int>(seed)};
  seen[seed] = 1;
  while (!stack.empty()) {
    const auto f = wrap_.faces[stack.back()];
    stack.pop_back();
    for (int k = 0; k < 3; ++k) {
      const int other = owner(f[(k + 1) % 3], f[k]);
      if (other < 0) return false;
      if (seen[other] != 0) continue;
      if (planes_[other].normal.dot(point.w - wrap_.points[wrap_.faces[other][0]].w) > 0.0) {
        seen[other] = 1;
        stack.push_back(other);
      }
    }
  }
  std::vector<std::array<int, 2>> horizon;
  for (std::size_t g = 0; g < wrap_.faces.size(); ++g) {
    if (seen[g] == 0) continue;
    for (int k = 0; k < 3; ++k) {
      const int from = wrap_.faces[g][k], to = wrap_.faces[g][(k + 1) % 3];
      if (seen[owner(to, from)] == 0) horizon.push_back({from, to});
    }
  }
  std::vector<std::array<int, 3>> kept;
  for (std::size_t g = 0; g < wrap_.faces.size(); ++g) {
    const auto& f = wrap_.faces[g];
    for (int k = 0; k < 3; ++k) owner(f[k], f[(k + 1) % 3]) = -1;
    if (seen[g] == 0) kept.push_back(f);
  }
  const int id = static_cast<int>(wrap_.points.size());
  wrap_.points.push_back(point);
  wrap_.faces.clear();
  std::vector<Face> planes;
  for (std::size_t g = 0; g < planes_.size(); ++g) {
    if (seen[g] == 0) planes.push_back(planes_[g]);
  }
  planes_.swap(planes);
  for (const auto& f : kept) {
    const int face = static_cast<int>(wrap_.faces.size());
    wrap_.faces.push_back(f);
    for (int k = 0; k < 3; ++k) owner(f[k], f[(k + 1) % 3]) = static_cast<std::int16_t>(face);
  }
  for (const auto& edge : horizon) addFace(edge[0], edge[1], id);
  return true;
}

bool WrapBuilder::build(double depth) {
  wrap_.points.clear();
  wrap_.faces.clear();
  if (!firstTetrahedron()) return false;
  while (wrap_.points.size() < kMaxWrapPoints) {
    std::size_t worst = 0;
    for (std::size_t f = 1; f < planes_.size(); ++f) {
      if (planes_[f].depth < planes_[worst].depth) worst = f;
    }
    const Face nearest = planes_[worst];
    if (nearest.depth >= depth) return isClosed();
    const SupportPair next = cores_.support(nearest.normal);
    const double reach = nearest.normal.dot(next.w);
    // The support plane bounds the depth of the whole difference from above.
    if (reach < depth || !(reach > nearest.depth)) return false;
    if (!addPoint(next, worst)) return false;
  }
  return false;
}

/// The pair with its cylinders made smaller by `depth` all around. What is left, grown by `depth`, lies in
/// the cylinder, so smaller cores within `radius` of each other touch: smooth surfaces get a radius to prove
/// with.
struct Shrunk {
  Element a, b;
  double radius;

  Shrunk(const PairPiece& piece, const Element& ea, const Element& eb, double depth)
      : a(ea), b(eb), radius(ea.radius + eb.radius + piece.contact_distance) {
    if (depth > 0.0) {
      shrink(a, depth);
      shrink(b, depth);
    }
  }

  static double deepest(const Element& e) {
    return e.vertices == nullptr ? std::min(e.rim_radius, e.half_length) : 0.0;
  }

 private:
  void shrink(Element& e, double depth) {
    if (e.vertices != nullptr) return;
    const double by = std::min(depth, deepest(e));
    radius += by - 16.0 * kUnit * (e.rim_radius + e.half_length);
    e.rim_radius -= by;
    e.half_length -= by;
  }
};

/// |sum of weight_i w_i| control points of a linear blend between two instants, each within `limit`?
bool closeThrough(const Instant& from, const Instant& to, const Closest& first, const Closest& last,
                  double limit) {
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

/// The common point of a rounded proof: on the segment between the cores, by their shares of the radius.
Vec3 sharedPoint(const Instant& now, const Closest& closest, double share) {
  Vec3 point = Vec3::Zero();
  for (int i = 0; i < closest.count; ++i) point += closest.weight[i] * (now.ra * closest.point[i].local_a);
  return point + share * closest.v;
}

/// Weights of the origin in a tetrahedron that may be as flat as the contact is shallow: volumes leave an
/// error across it, which one step of Newton takes away.
void refineWeights(Closest& c) {
  if (!c.overlap || c.count != 4) return;
  const Vec3 e1 = c.point[1].w - c.point[0].w, e2 = c.point[2].w - c.point[0].w,
             e3 = c.point[3].w - c.point[0].w;
  const Vec3 c1 = e2.cross(e3), c2 = e3.cross(e1), c3 = e1.cross(e2);
  const double volume = e1.dot(c1);
  if (volume == 0.0) return;
  for (int step = 0; step < 2; ++step) {
    Vec3 x = Vec3::Zero();
    for (int i = 0; i < 4; ++i) x += c.weight[i] * c.point[i].w;
    const double d1 = x.dot(c1) / volume, d2 = x.dot(c2) / volume, d3 = x.dot(c3) / volume;
    const double w[4] = {c.weight[0] + (d1 + d2 + d3), c.weight[1] - d1, c.weight[2] - d2, c.weight[3] - d3};
    if (!(w[0] >= 0.0 && w[1] >= 0.0 && w[2] >= 0.0 && w[3] >= 0.0)) return;  // convex, or as they were
    std::copy(w, w + 4, c.weight);
  }
}

/// The closed surface of the tetrahedron of an overlap, outward.
bool wrapTetrahedron(const Closest& closest, Wrap& wrap) {
  if (!closest.overlap || closest.count != 4) return false;
  wrap.points.assign(closest.point, closest.point + 4);
  std::vector<SupportPair>& p = wrap.points;
  if (det(p[1].w - p[0].w, p[2].w - p[0].w, p[3].w - p[0].w) > 0.0) std::swap(p[1], p[2]);
  wrap.faces.assign({{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}});
  return true;
}

/// Contact proved with shrunk cylinders. The deeper the proof, the longer it lasts; how deep it may be
/// depends on how deep the contact is.
bool touchesShrunk(const PairPiece& piece, const Instant& now, const Element& a, const Element& b,
                   const Vec3& guess, ContactWitness& witness) {
  const double deepest = std::max(Shrunk::deepest(a), Shrunk::deepest(b));
  // Growing back rounds the rims, where (sqrt(2) - 1) depth is lost: near the budget little may be shrunk.
  const double least = 4.0 * piece.point_error;
  if (!(deepest > least)) return false;
  constexpr double kStep = 8.0;
  const bool first = !(witness.shrunk > 0.0);
  double best = 0.0;
  for (double depth = std::min(deepest, first ? 64.0 * piece.point_error : kStep * witness.shrunk);
       depth >= least; depth = std::max(depth / kStep, depth > least ? least : 0.0)) {
    const Shrunk small(piece, a, b, depth);
    const double limit = small.radius - 2.0 * piece.point_error;
    Closest closest = closestPoints(Cores(now, small.a, small.b), guess, first ? 0.5 * limit : 0.0);
    refineWeights(closest);
    if (closest.v.norm() > limit) {
      const Closest on_edges = closestOnEdges(Cores(now, small.a, small.b), closest);
      if (on_edges.count > 0 && on_edges.v.norm() < closest.v.norm()) closest = on_edges;
    }
    const double slack = limit - closest.v.norm();
    if (slack > best && closeThrough(now, now, closest, closest, limit)) {
      best = slack;
      witness.rounded = true;
      witness.closest = closest;
      witness.shrunk = depth;
      witness.point =
          sharedPoint(now, closest, (small.radius > 0.0 ? (a.radius + 0.5 * depth) / small.radius : 0.5));
    }
    if (best > (first ? 0.0 : limit / kStep)) break;  // the next would have less
  }
  return best > 0.0;
}

}  // namespace

bool buildWrap(const Cores& cores, double depth, Wrap& wrap) { return WrapBuilder(cores, wrap).build(depth); }

bool touchesAt(const PairPiece& piece, const Instant& now, const Element& a, const Element& b,
               const Closest& closest, ContactWitness& witness) {
  const Cores cores(now, a, b);
  const double radius = a.radius + b.radius + piece.contact_distance;
  if (radius > 0.0 && closeThrough(now, now, closest, closest, radius - 2.0 * piece.point_error)) {
    witness.rounded = true;
    witness.shrunk = 0.0;
    witness.closest = closest;
    witness.point = sharedPoint(now, closest, (a.radius + 0.5 * piece.contact_distance) / radius);
    return true;
  }
  // Cores that meet touch at any distance: all that is left where the radius is within the rounding.
  if (a.count == 1 && b.count == 1) return false;  // two points: never provable
  if (!closest.overlap && closest.v.norm() > 16.0 * piece.point_error) return false;
  if (touchesShrunk(piece, now, a, b, closest.overlap ? closest.last : closest.v, witness)) return true;
  const auto holds = [&] {
    if (!wrapHolds(piece, now, now, witness.wrap)) return false;
    witness.rounded = false;
    witness.shrunk = 0.0;
    // The common point: by GJK's weights where it found the origin inside, else the support of the nearest
    // face.
    witness.point.setZero();
    for (int i = 0; i < closest.count; ++i)
      witness.point += closest.weight[i] * (now.ra * closest.point[i].local_a);
    return true;
  };
  // The tetrahedron in which the origin was found often is proof enough, though not one that lasts.
  if (!(witness.shrunk > 0.0) && wrapTetrahedron(closest, witness.wrap) && holds()) return true;
  for (double depth = 2.0 * piece.point_error; depth < 5e3 * piece.point_error; depth *= 8.0) {
    if (!buildWrap(cores, depth, witness.wrap)) return false;
    if (holds()) return true;
  }
  return false;
}

bool touchesThrough(const PairPiece& piece, const Instant& from, const Instant& to, const Element& a,
                    const Element& b, const ContactWitness& witness) {
  if (!witness.rounded) return wrapHolds(piece, from, to, witness.wrap);
  const Shrunk small(piece, a, b, witness.shrunk);
  Closest last = closestPoints(Cores(to, small.a, small.b), witness.closest.v);
  refineWeights(last);
  return closeThrough(from, to, witness.closest, last,
                      small.radius - chordError(piece, to.t - from.t) - piece.point_error);
}

bool passesThrough(const PairPiece& piece, const Instant& from, const Instant& to, bool point_is_a,
                   const Vec3& point, const std::vector<std::array<Vec3, 3>>& patch) {
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

  Vec3 up = Vec3::Zero();
  for (const auto& t : patch) {
    const Vec3 n = (t[1] - t[0]).cross(t[2] - t[0]);
    if (n.squaredNorm() > up.squaredNorm()) up = n;
  }
  if (!(up.norm() > 0.0)) return false;
  up.normalize();

  // The patch is a graph over the plane across `up`: every triangle, wound to face it, leans clearly towards
  // it.
  std::vector<std::array<Vec3, 3>> faces;
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
      const double value = up.dot((i - x0).cross(j - x0));
      if (!(value > move * (j - i).norm() + 64.0 * kUnit * reach * reach)) return false;
    }
  }
  return has_border;
}

}  // namespace collision_node::impact

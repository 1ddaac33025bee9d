#include "collision_node/impact/proof/contact_proof.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "collision_node/impact/convex/sliding_features.h"

namespace collision_node::impact {
namespace {

/// The relative position of a material point pair at another instant.
Vec3 differenceAt(const Instant& now, const SupportPair& p) {
  return now.d + now.rb * p.local_b - now.ra * p.local_a;
}

/// Bound of |w(t) - chord| between two instants, of points of the cores: the exact path's second derivative,
/// and the points' own errors.
double chordError(const PairPiece& piece, const Element& a, const Element& b, double dt) {
  const RelativeMotion& m = piece.motion;
  const double acceleration =
      m.maxAcceleration() + m.spinA() * m.spinA() * coreReach(a) + m.spinB() * m.spinB() * coreReach(b);
  return 0.125 * dt * dt * acceleration * (1.0 + 16.0 * kUnit) + piece.point_error;
}

/// Control vectors of the product of two linear vector functions u(x), v(x) given at both ends.
double largestCross(const Vec3& u0, const Vec3& u1, const Vec3& v0, const Vec3& v1) {
  return std::max({u0.cross(v0).norm(), 0.5 * (u0.cross(v1) + u1.cross(v0)).norm(), u1.cross(v1).norm()});
}

/// Points with which cores are proved to be within `limit` of each other, if they are: what is left to it
/// makes the proof last, and no search for more of that pays.
GoodEnough within(double limit) {
  constexpr double kShare = 0.5, kLoss = 0x1p-6;
  return {kShare * limit, kLoss, limit};
}

/// Where what is `first` at the start and `last` at the end would reach 0 if it fell evenly; else half-way.
double lastingShare(double first, double last) {
  return first > 0.0 && last < 0.0 ? first / (first - last) : 0.5;
}

/// The same face, begun at the corner whose two edges have the smallest product: the determinant is the same
/// from any corner, its rounding is not.
std::array<std::int16_t, 3> fromShortestEdges(const std::array<std::int16_t, 3>& face,
                                              const std::array<Vec3, Wrap::kMostPoints>& points) {
  double length[3];
  for (int k = 0; k < 3; ++k) length[k] = (points[face[(k + 1) % 3]] - points[face[k]]).squaredNorm();
  int best = 0;
  for (int k = 1; k < 3; ++k) {
    if (length[k] * length[(k + 2) % 3] < length[best] * length[(best + 2) % 3]) best = k;
  }
  return {face[best], face[(best + 1) % 3], face[(best + 2) % 3]};
}

/// Every face at a known side of the origin between the two instants: Bernstein coefficients of the
/// determinant of three chords, minus `e`, what the true paths can differ from them.
bool wrapHolds(double e, const Instant& from, const Instant& to, const Wrap& wrap, double& share) {
  share = 0.5;
  if (wrap.faces.empty()) return false;
  std::array<Vec3, Wrap::kMostPoints> p, q;
  for (std::size_t i = 0; i < wrap.points.size(); ++i) {
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
    if (!(b0 > slack && b3 > slack && b1 > 3.0 * slack && b2 > 3.0 * slack)) {
      share = lastingShare(b0, b3 - slack);
      return false;
    }
  }
  return true;
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
  constexpr double kLeast = 1e-150;  // [m] of less, squares would be lost
  if (!(limit > kLeast)) return false;
  const auto blend = [](const Closest& c, const Instant& now) {
    Vec3 x = Vec3::Zero();
    for (int i = 0; i < c.count; ++i) x += c.weight[i] * differenceAt(now, c.point[i]);
    return x;
  };
  const Vec3 x0 = blend(first, from);
  if (&from == &to && &first == &last) return x0.norm() <= limit;
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
  const double faster = std::isinf(witness.shrunk) ? kStep : 1.0;  // where nothing is known of it
  double best = 0.0, step = kStep;
  for (double depth = std::min(deepest, first ? 64.0 * piece.point_error : kStep * witness.shrunk);
       depth >= least; depth = std::max(depth / step, depth > least ? least : 0.0), step *= faster) {
    const Shrunk small(piece, a, b, depth);
    const double limit = small.radius - 2.0 * piece.point_error;
    Closest closest = closestPoints(Cores(now, small.a, small.b), guess, within(limit));
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

/// Contact at this instant proved by the witness's wrap.
bool holdsWrapped(const PairPiece& piece, const Instant& now, const Closest& closest,
                  ContactWitness& witness) {
  double share;
  if (!wrapHolds(piece.point_error, now, now, witness.wrap, share)) return false;
  witness.rounded = false;
  witness.shrunk = 0.0;
  // The common point: by GJK's weights where it found the origin inside, else the support of the nearest
  // face.
  witness.point.setZero();
  for (int i = 0; i < closest.count; ++i)
    witness.point += closest.weight[i] * (now.ra * closest.point[i].local_a);
  return true;
}

/// A side's points are those of its axis: instead the cylinder's point that is nearest to the other core's.
void dropOnCylinder(const Cores& cores, bool cylinder_is_a, Closest& closest) {
  const PosedCore &cylinder = cylinder_is_a ? cores.a : cores.b, &other = cylinder_is_a ? cores.b : cores.a;
  const ClampingCore solid(*cylinder.element);
  SupportPair& p = closest.point[0];
  const Vec3 seen =
      cylinder.rotation->transpose() * (other.place(cylinder_is_a ? p.local_b : p.local_a) - cylinder.origin);
  const Vec3 x = solid.frame.axes.transpose() * (seen - solid.frame.centre);
  const Vec3 offset = solid.frame.axes * solid.see(x, Vec3::Zero()).offset;
  (cylinder_is_a ? p.local_a : p.local_b) = seen - offset;
  p.w = *cylinder.rotation * (cylinder_is_a ? offset : Vec3(-offset));
  closest.count = 1;
  closest.weight[0] = 1.0;
  closest.v = p.w;
}

/// The vertex that is nearest to a cylinder, and the cylinder's point nearest to it. Support points of a
/// large cylinder are far apart: between them the search for closest points may lose what is small beside it.
Closest nearestVertex(const Cores& cores, bool cylinder_is_a) {
  const PosedCore& other = cylinder_is_a ? cores.b : cores.a;
  Closest best;
  for (int i = 0; i < other.element->count; ++i) {
    Closest dropped;
    (cylinder_is_a ? dropped.point[0].local_b : dropped.point[0].local_a) = other.element->vertices[i];
    dropOnCylinder(cores, cylinder_is_a, dropped);
    if (best.count == 0 || dropped.v.squaredNorm() < best.v.squaredNorm()) best = dropped;
  }
  return best;
}

}  // namespace

bool touchesAt(const PairPiece& piece, const Instant& now, const Element& a, const Element& b,
               const Closest& closest, ContactWitness& witness) {
  const Cores cores(now, a, b);
  const double radius = a.radius + b.radius + piece.contact_distance;
  const auto isClose = [&](const Closest& points) {
    if (!closeThrough(now, now, points, points, radius - 2.0 * piece.point_error)) return false;
    witness.rounded = true;
    witness.momentary = false;
    witness.shrunk = 0.0;
    witness.closest = points;
    witness.point = sharedPoint(now, points, (a.radius + 0.5 * piece.contact_distance) / radius);
    return true;
  };
  if (radius > 0.0) {
    if (isClose(closest)) return true;
    if (closest.overlap) {
      Closest refined = closest;
      refineWeights(refined);
      if (isClose(refined)) return true;
    }
    const bool cylinder_is_a = a.vertices == nullptr;
    if (!closest.overlap && cylinder_is_a != (b.vertices == nullptr) &&
        isClose(nearestVertex(cores, cylinder_is_a)))
      return true;
  }
  // Cores that meet touch at any distance: all that is left where the radius is within the rounding.
  if (a.count == 1 && b.count == 1) return false;  // two points: never provable
  // [budgets] Cores seen farther apart are not wrapped; what is deeper than all of these, the first one
  // finds.
  constexpr double kFar = 16.0, kDeepest = 5e3;
  if (!closest.overlap && closest.v.norm() > kFar * piece.point_error) return false;
  if (touchesShrunk(piece, now, a, b, closest.overlap ? closest.last : closest.v, witness)) return true;
  const auto holds = [&] { return holdsWrapped(piece, now, closest, witness); };
  // The tetrahedron in which the origin was found often is proof enough, though not one that lasts.
  if (!(witness.shrunk > 0.0) && wrapTetrahedron(closest, witness.wrap) && holds()) return true;
  for (double depth = 2.0 * piece.point_error; depth < kDeepest * piece.point_error; depth *= 8.0) {
    if (!buildWrap(cores, depth, witness.wrap)) return false;
    if (holds()) return true;
  }
  return false;
}

bool touchesDeep(const PairPiece& piece, const Instant& now, const Element& a, const Element& b,
                 const Closest& closest, ContactWitness& witness) {
  if (!closest.overlap) return false;
  constexpr double kStep = 8.0;  // also: how much deeper than the radius pays
  const Cores cores(now, a, b);
  const double least = kStep * std::max(a.radius + b.radius + piece.contact_distance, piece.point_error);
  // A wrap that is asked for too deep is refused by the first plane that is not.
  for (double depth = coreReach(a) + coreReach(b); depth > least; depth /= kStep) {
    if (buildWrap(cores, depth, witness.wrap)) return holdsWrapped(piece, now, closest, witness);
  }
  return false;
}

bool touchesSliding(const PairPiece& piece, const Instant& now, const Element& a, const Element& b,
                    const Closest& before, const Vec3* direction, ContactWitness& witness) {
  if (a.frame == nullptr || b.frame == nullptr || a.radius + b.radius + piece.contact_distance > 0.0)
    return false;
  const double rounding = 16.0 * kUnit * (coreReach(a) + coreReach(b));
  // How deep must the feature be in the other core? Where both are as sharp as a box's edges, less by
  // (sqrt(2) - 1) of what is taken off: the first is deep enough for most contacts, the last for the
  // shallowest.
  for (const double share : {64.0, 8.0}) {
    const double depth = share * piece.point_error;
    const auto holds = [&](const SlidingPoints& points, const Cores& cores, double radius) {
      const double limit = points.shrunk() - 2.0 * piece.point_error - rounding;
      if (!(points.distance() - radius <= limit)) return false;
      Closest closest = points.closest(cores);
      if (radius > 0.0) dropOnCylinder(Cores(now, a, b), points.curveIsA(), closest);
      if (!closeThrough(now, now, closest, closest, limit)) return false;
      witness.rounded = witness.momentary = true;
      witness.closest = closest;
      witness.point = sharedPoint(now, closest, 0.5);
      return true;
    };
    if (slideOnFeatures(now, a, b, before, direction, depth, holds)) return true;
  }
  return false;
}

bool touchesThrough(const PairPiece& piece, const Instant& from, const Instant& to, const Element& a,
                    const Element& b, ContactWitness& witness, double& share) {
  const double e = chordError(piece, a, b, to.t - from.t);
  if (!witness.rounded) return wrapHolds(e, from, to, witness.wrap, share);
  const Shrunk small(piece, a, b, witness.shrunk);
  const double limit = small.radius - e - piece.point_error;
  share = 0.5;
  if (!(limit > 0.0)) return false;
  Closest last = closestPoints(Cores(to, small.a, small.b), witness.closest, within(limit));
  refineWeights(last);
  if (closeThrough(from, to, witness.closest, last, limit)) {
    witness.closest = last;
    return true;
  }
  share = lastingShare(limit - witness.closest.v.norm(), limit - last.v.norm());
  return false;
}

}  // namespace collision_node::impact

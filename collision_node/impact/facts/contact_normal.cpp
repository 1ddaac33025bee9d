#include "collision_node/impact/facts/contact_normal.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "collision_node/impact/convex/near_support.h"
#include "collision_node/impact/proof/contact_proof.h"

namespace collision_node::impact {
namespace {

/// How far the computed closest vector may lean from the exact one [rad].
/// Any answer: |v - v*|^2 <= |v|^2 - v . w for the farthest w (the duality gap). Where every vertex outside
/// the simplex lies clearly beyond its plane, the exact closest point is in the simplex too, and that of a
/// point or segment is off in the first order: by what its ends are, over the distance, and by how that turns
/// the segment, over its length.
double directionError(const PairPiece& piece, const Cores& cores, const Closest& closest, double gap) {
  const double length = closest.v.norm();
  const double dual = std::sqrt((std::max(0.0, length - gap) + 8.0 * piece.point_error) / length);
  double simple = 64.0 * piece.point_error / gap;
  if (closest.count == 2)
    simple += 4.0 * piece.point_error / (closest.point[1].w - closest.point[0].w).norm();
  if (closest.sure > 16.0 * piece.point_error) return simple;
  if (closest.count > 2) return dual;
  const Element &a = *cores.a.element, &b = *cores.b.element;
  if (a.vertices == nullptr || b.vertices == nullptr) return dual;
  for (int i = 0; i < a.count; ++i) {
    for (int j = 0; j < b.count; ++j) {
      const Vec3 w = cores.b.place(b.vertices[j]) - cores.a.place(a.vertices[i]);
      bool in_simplex = false;
      for (int k = 0; k < closest.count; ++k) {
        in_simplex |= closest.point[k].local_a == a.vertices[i] && closest.point[k].local_b == b.vertices[j];
      }
      if (!in_simplex && !(w.dot(closest.v) > length * (length + 16.0 * piece.point_error))) return dual;
    }
  }
  return simple;
}

/// Is one side's part in the closest points a single vertex, and too far ahead of its other vertices to lose
/// that while everything moves by `moved` and the normal by `lean`? Then that side is as good as a point.
bool staysOneVertex(const Cores& cores, const Closest& closest, bool side_a, const Vec3& n, double gap,
                    double moved, double lean) {
  const PosedCore& core = side_a ? cores.a : cores.b;
  if (core.element->vertices == nullptr) return false;
  const Vec3 held = side_a ? closest.point[0].local_a : closest.point[0].local_b;
  for (int i = 1; i < closest.count; ++i) {
    if ((side_a ? closest.point[i].local_a : closest.point[i].local_b) != held) return false;
  }
  const double sign = side_a ? -1.0 : 1.0;
  for (int i = 0; i < core.element->count; ++i) {
    const Vec3& v = core.element->vertices[i];
    if (v == held) continue;
    const Vec3 e = *core.rotation * (v - held);
    if (!(sign * n.dot(e) > 4.0 * moved + e.norm() * lean + std::max(0.0, closest.v.norm() - gap)))
      return false;
  }
  return true;
}

}  // namespace

Vec3 bestNormal(const PairPiece& piece, const Instant& now, const Element& ea, const Element& eb,
                const Closest& closest, const Vec3& first, double apart_at) {
  const Cores cores(now, ea, eb);
  Vec3 best = first;
  double best_gap = cores.gapAlong(first);
  // No axis shows a larger gap than the distance of two points.
  const double most = closest.v.norm();
  if (best_gap > (1.0 - 1e-6) * most - 2.0 * piece.point_error) return best;
  const auto propose = [&](const Vec3& direction) {
    const double length = direction.norm();
    if (!(length > 0.0)) return;
    const double gap = cores.gapAlong(direction / length);
    if (gap > best_gap) {
      best_gap = gap;
      best = direction / length;
    }
  };
  for (const Axis& axis : featureAxes(piece, now, ea, eb)) {
    propose(axis.direction);
    propose(-axis.direction);  // so near to contact, their sign is a guess
  }
  const double whole = apart_at - now.t;
  const double size = std::min(coreReach(ea), coreReach(eb)) + piece.point_error;
  for (double share = 1e-2; share > 1e-9; share *= 0.1) {
    const double step = std::copysign(std::min(std::abs(whole), share * size / piece.speed), whole);
    if (step == 0.0) break;
    const Instant then = piece.at(now.t + step);
    const Axis axis = axisOf(piece, then, closestPoints(Cores(then, ea, eb), Vec3::Zero()), false);
    if (!axis.valid) continue;
    propose(axis.direction - step * axis.rate);
    propose(axis.direction);
  }
  return best;
}

bool shallowestNormal(const PairPiece& piece, const Cores& cores, Vec3* n) {
  Wrap wrap;
  const double size = coreReach(*cores.a.element) + coreReach(*cores.b.element) + piece.point_error;
  buildWrap(cores, 4.0 * size, wrap);  // grows until the nearest face is a face of the difference
  double nearest = std::numeric_limits<double>::infinity();
  for (const auto& face : wrap.faces) {
    const Vec3 &a = wrap.points[face[0]].w, &b = wrap.points[face[1]].w, &c = wrap.points[face[2]].w;
    const Vec3 normal = (b - a).cross(c - a).normalized();
    if (normal.squaredNorm() > 0.5 && normal.dot(a) < nearest) {
      nearest = normal.dot(a);
      *n = -normal;
    }
  }
  return nearest < std::numeric_limits<double>::infinity();
}

double roundedCone(const PairPiece& piece, const Cores& cores, const Closest& closest, const Vec3& n,
                   double plane_gap, double gap, double moved, const Turned& turned) {
  const double lean = angleOf(2.0 * moved / gap) + directionError(piece, cores, closest, gap);
  // cos(cone) = (gap - moved) / (farthest), by the sine of half of it, which keeps its digits where it is
  // small.
  const double farthest = closest.v.norm() + moved;
  double cone = 2.0 * std::asin(std::sqrt(std::min(1.0, 0.5 * (farthest - gap + moved) / farthest)));
  // A point's closest vector turns with the other core, and as far as the two have moved. Its own turn moves
  // nothing.
  for (const bool point_is_a : {true, false}) {
    const double single = lean + (point_is_a ? turned.b : turned.a);
    if (single < cone && staysOneVertex(cores, closest, point_is_a, n, plane_gap, moved, single))
      cone = single;
  }
  return cone;
}

}  // namespace collision_node::impact

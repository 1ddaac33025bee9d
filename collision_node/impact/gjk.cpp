#include "collision_node/impact/gjk.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace collision_node::impact {
namespace {

/// Closest point of a simplex to the origin: which of its points are used, and their weights.
struct Reduced {
  int count = 0;
  int index[4] = {};
  double weight[4] = {};
  Vec3 v = Vec3::Zero();
  bool inside = false;
};

Reduced closestOnPoint(const SupportPair* p, int i) {
  Reduced r;
  r.count = 1;
  r.index[0] = i;
  r.weight[0] = 1.0;
  r.v = p[i].w;
  return r;
}

Reduced closestOnSegment(const SupportPair* p, int i, int j) {
  const Vec3 e = p[j].w - p[i].w;
  const double length2 = e.squaredNorm();
  const double s = -p[i].w.dot(e);
  if (!(s > 0.0)) return closestOnPoint(p, i);
  if (!(s < length2)) return closestOnPoint(p, j);
  Reduced r;
  r.count = 2;
  r.index[0] = i;
  r.index[1] = j;
  r.weight[1] = s / length2;
  r.weight[0] = 1.0 - r.weight[1];
  r.v = p[i].w + r.weight[1] * e;
  return r;
}

Reduced nearer(const Reduced& x, const Reduced& y) { return x.v.squaredNorm() <= y.v.squaredNorm() ? x : y; }

/// Ericson, Real-Time Collision Detection (2005), 5.1.5: Voronoi regions of a triangle.
Reduced closestOnTriangle(const SupportPair* p, int i, int j, int k) {
  const Vec3 &a = p[i].w, &b = p[j].w, &c = p[k].w;
  const Vec3 ab = b - a, ac = c - a;
  const Vec3 n = ab.cross(ac);
  const double n2 = n.squaredNorm();
  // barycentrics of the origin's projection, as volumes n . (x cross y)
  const double wa = n.dot(b.cross(c)), wb = n.dot(c.cross(a)), wc = n.dot(a.cross(b));
  if (n2 > 0.0 && wa > 0.0 && wb > 0.0 && wc > 0.0) {
    Reduced r;
    r.count = 3;
    r.index[0] = i;
    r.index[1] = j;
    r.index[2] = k;
    const double sum = wa + wb + wc;
    r.weight[0] = wa / sum;
    r.weight[1] = wb / sum;
    r.weight[2] = wc / sum;
    r.v = n * (n.dot(a) / n2);
    return r;
  }
  return nearer(nearer(closestOnSegment(p, i, j), closestOnSegment(p, j, k)), closestOnSegment(p, k, i));
}

Reduced closestOnTetrahedron(const SupportPair* p) {
  static constexpr int kFaces[4][4] = {{0, 1, 2, 3}, {0, 3, 1, 2}, {0, 2, 3, 1}, {1, 3, 2, 0}};
  Reduced best;
  best.v = Vec3::Constant(std::numeric_limits<double>::infinity());
  bool inside = true;
  double volumes[4];
  for (int f = 0; f < 4; ++f) {
    const Vec3 &a = p[kFaces[f][0]].w, &b = p[kFaces[f][1]].w, &c = p[kFaces[f][2]].w,
               &opposite = p[kFaces[f][3]].w;
    const Vec3 n = (b - a).cross(c - a);
    const double origin_side = -n.dot(a);
    const double other_side = n.dot(opposite - a);
    volumes[f] = origin_side;
    if (!(origin_side * other_side > 0.0)) {
      inside = false;
      best = nearer(best, closestOnTriangle(p, kFaces[f][0], kFaces[f][1], kFaces[f][2]));
    }
  }
  if (!inside) return best;
  best.inside = true;
  best.count = 4;
  best.v = Vec3::Zero();
  // The weight of a vertex is the volume over the face opposite to it.
  const double total =
      std::abs(volumes[0]) + std::abs(volumes[1]) + std::abs(volumes[2]) + std::abs(volumes[3]);
  for (int f = 0; f < 4; ++f) {
    best.index[f] = f;
    best.weight[kFaces[f][3]] = std::abs(volumes[f]) / total;
  }
  return best;
}

Reduced reduce(const SupportPair* p, int count) {
  switch (count) {
    case 1:
      return closestOnPoint(p, 0);
    case 2:
      return closestOnSegment(p, 0, 1);
    case 3:
      return closestOnTriangle(p, 0, 1, 2);
    default:
      return closestOnTetrahedron(p);
  }
}

/// The point of a cylinder nearest to `p`, both in the cylinder's frame: clamp along the axis and across it.
Vec3 nearestInCylinder(const Element& e, const Vec3& p) {
  const Vec3 x = p - e.centre;
  const double along = x.dot(e.axis);
  const Vec3 across = x - along * e.axis;
  const double radius = across.norm();
  const double share = radius > e.rim_radius ? e.rim_radius / radius : 1.0;
  return e.centre + std::clamp(along, -e.half_length, e.half_length) * e.axis + share * across;
}

/// A single point against a cylinder has a closed form; GJK only creeps towards a curved surface.
Closest pointToCylinder(const Cores& cores, bool point_is_a) {
  const PosedCore &point = point_is_a ? cores.a : cores.b, &cylinder = point_is_a ? cores.b : cores.a;
  const Vec3 world = point.place(point.element->vertices[0]);
  const Vec3 local = cylinder.rotation->transpose() * (world - cylinder.origin);
  const Vec3 nearest = nearestInCylinder(*cylinder.element, local);
  Closest c;
  c.count = 1;
  c.weight[0] = 1.0;
  c.exact = true;
  c.point[0].local_a = point_is_a ? point.element->vertices[0] : nearest;
  c.point[0].local_b = point_is_a ? nearest : point.element->vertices[0];
  c.point[0].w = *cylinder.rotation * (point_is_a ? Vec3(nearest - local) : Vec3(local - nearest));
  c.v = c.point[0].w;
  c.overlap = c.v.isZero(0.0);
  return c;
}

/// Takes over from the simplex only the points that hold its closest point.
void keep(const Reduced& r, const SupportPair* simplex, Closest& c) {
  SupportPair kept[4];
  for (int i = 0; i < r.count; ++i) {
    kept[i] = simplex[r.index[i]];
    c.weight[i] = r.weight[i];
  }
  std::copy(kept, kept + r.count, c.point);
  c.count = r.count;
  c.v = r.v;
  c.overlap = r.inside;
}

/// From any points of B - A down to those closest to the origin.
Closest descend(const Cores& cores, const Closest& start, double enough, double loss) {
  const Element &a = *cores.a.element, &b = *cores.b.element;
  if (a.vertices != nullptr && a.count == 1 && b.vertices == nullptr) return pointToCylinder(cores, true);
  if (b.vertices != nullptr && b.count == 1 && a.vertices == nullptr) return pointToCylinder(cores, false);
  Closest c = start;
  keep(reduce(c.point, c.count), c.point, c);
  constexpr int kMaxIterations = 96;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    const double length2 = c.v.squaredNorm();
    if (!(length2 > 0.0)) {
      c.overlap = true;
      return c;
    }
    if (length2 <= enough * enough) return c;
    const SupportPair next = cores.support(-c.v);
    if (length2 - c.v.dot(next.w) <=
        std::max(1e-13 * length2, loss * (length2 - enough * std::sqrt(length2))))
      return c;
    for (int i = 0; i < c.count; ++i) {
      if (next.w == c.point[i].w) return c;
    }
    c.point[c.count] = next;
    const Reduced r = reduce(c.point, c.count + 1);
    if (!r.inside && !(r.v.squaredNorm() < length2)) return c;  // no more progress in doubles
    // Nothing lies beyond `next` along -v: with the origin beyond it, only a flat tetrahedron's rounding
    // holds it.
    if (r.inside && c.v.dot(next.w) > 0.0) return c;
    if (r.inside) c.last = c.v;
    keep(r, c.point, c);
    if (c.overlap) return c;
  }
  return c;
}

}  // namespace

double coreReach(const Element& e) {
  if (e.vertices == nullptr) return e.centre.norm() + std::hypot(e.rim_radius, e.half_length);
  double reach2 = 0.0;
  for (int i = 0; i < e.count; ++i) reach2 = std::max(reach2, e.vertices[i].squaredNorm());
  return std::sqrt(reach2);
}

Vec3 supportOf(const Element& e, const Vec3& direction) {
  if (e.vertices != nullptr) {
    int best = 0;
    double reach = e.vertices[0].dot(direction);
    for (int i = 1; i < e.count; ++i) {
      const double r = e.vertices[i].dot(direction);
      if (r > reach) {
        reach = r;
        best = i;
      }
    }
    return e.vertices[best];
  }
  const double along = direction.dot(e.axis);
  const Vec3 across = direction - along * e.axis;
  const double length = across.norm();
  Vec3 p = e.centre + (along >= 0.0 ? e.half_length : -e.half_length) * e.axis;
  if (length > 1e-12 * std::abs(along)) p += (e.rim_radius / length) * across;
  return p;
}

Vec3 PosedCore::supportLocal(const Vec3& direction) const {
  return supportOf(*element, rotation->transpose() * direction);
}

SupportPair Cores::support(const Vec3& direction) const {
  SupportPair s;
  s.local_a = a.supportLocal(-direction);
  s.local_b = b.supportLocal(direction);
  s.w = b.place(s.local_b) - a.place(s.local_a);
  return s;
}

Closest closestPoints(const Cores& cores, const Vec3& guess, double enough, double loss) {
  Closest start;
  start.count = 1;
  start.point[0] = cores.support(guess.squaredNorm() > 0.0 ? Vec3(-guess) : Vec3(1.0, 0.0, 0.0));
  start.weight[0] = 1.0;
  return descend(cores, start, enough, loss);
}

Closest closestPoints(const Cores& cores, const Closest& before, double enough, double loss) {
  constexpr int kTetrahedron = 4;
  if (before.count == 0 || before.count == kTetrahedron) return closestPoints(cores, before.v, enough, loss);
  Closest start;
  start.count = before.count;
  for (int i = 0; i < before.count; ++i) {
    SupportPair& p = start.point[i];
    p.local_a = before.point[i].local_a;
    p.local_b = before.point[i].local_b;
    p.w = cores.b.place(p.local_b) - cores.a.place(p.local_a);
  }
  return descend(cores, start, enough, loss);
}

Closest closestOnEdges(const Cores& cores, const Closest& hint) {
  const bool cylinder_is_a = cores.a.element->vertices == nullptr;
  const PosedCore &cylinder = cylinder_is_a ? cores.a : cores.b, &other = cylinder_is_a ? cores.b : cores.a;
  Closest best;
  if (cylinder.element->vertices != nullptr || other.element->vertices == nullptr) return best;
  Vec3 corner[4], seen[4];  // in the other's frame and in the cylinder's
  int count = 0;
  for (int i = 0; i < hint.count; ++i) {
    const Vec3& x = cylinder_is_a ? hint.point[i].local_b : hint.point[i].local_a;
    if (std::find(corner, corner + count, x) != corner + count) continue;
    corner[count] = x;
    seen[count++] = cylinder.rotation->transpose() * (other.place(x) - cylinder.origin);
  }
  double nearest = std::numeric_limits<double>::infinity();
  const auto offer = [&](int i, int j, double share) {
    const Vec3 x = seen[i] + share * (seen[j] - seen[i]), p = nearestInCylinder(*cylinder.element, x);
    const double distance = (x - p).norm();
    if (!(distance < nearest)) return;
    nearest = distance;
    best.count = i == j ? 1 : 2;
    const int ends[2] = {i, j};
    for (int k = 0; k < best.count; ++k) {
      const Vec3 w = *cylinder.rotation * (cylinder_is_a ? Vec3(seen[ends[k]] - p) : Vec3(p - seen[ends[k]]));
      best.point[k] = {w, cylinder_is_a ? p : corner[ends[k]], cylinder_is_a ? corner[ends[k]] : p};
      best.weight[k] = best.count == 1 ? 1.0 : k == 0 ? 1.0 - share : share;
    }
    best.v = *cylinder.rotation * (cylinder_is_a ? Vec3(x - p) : Vec3(p - x));
  };
  constexpr int kHalvings = 54;
  for (int i = 0; i < count; ++i) {
    offer(i, i, 0.0);
    for (int j = 0; j < i; ++j) {
      // The distance along the edge is convex; it grows along the direction from the nearest point.
      const Vec3 edge = seen[j] - seen[i];
      double low = 0.0, high = 1.0;
      for (int k = 0; k < kHalvings; ++k) {
        const double middle = 0.5 * (low + high);
        const Vec3 x = seen[i] + middle * edge;
        ((x - nearestInCylinder(*cylinder.element, x)).dot(edge) > 0.0 ? high : low) = middle;
      }
      offer(i, j, 0.5 * (low + high));
    }
  }
  best.overlap = best.count > 0 && best.v.isZero(0.0);
  return best;
}

}  // namespace collision_node::impact

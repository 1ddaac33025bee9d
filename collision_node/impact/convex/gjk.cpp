#include "collision_node/impact/convex/gjk.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "collision_node/geometry/any_width.h"
#include "collision_node/impact/convex/closest_points.h"

namespace collision_node::impact {
namespace {

/// Closest point of a simplex to the origin: which of its points are used, in ascending order, and their
/// weights.
struct Reduced {
  int count = 0;
  int index[4];
  double weight[4];
  Vec3 v = Vec3::Zero();
  double length2 = std::numeric_limits<double>::infinity();  ///< of v
  bool inside = false;
};

void offerPoint(const SupportPair* p, int i, Reduced& best) {
  const double length2 = p[i].w.squaredNorm();
  if (!(length2 < best.length2)) return;
  best.count = 1;
  best.index[0] = i;
  best.weight[0] = 1.0;
  best.v = p[i].w;
  best.length2 = length2;
}

void offerSegment(const SupportPair* p, int i, int j, Reduced& best) {
  const Vec3 e = p[j].w - p[i].w;
  const double edge2 = e.squaredNorm();
  const double s = -p[i].w.dot(e);
  if (!(s > 0.0)) return offerPoint(p, i, best);
  if (!(s < edge2)) return offerPoint(p, j, best);
  const double share = s / edge2;
  const Vec3 v = p[i].w + share * e;
  const double length2 = v.squaredNorm();
  if (!(length2 < best.length2)) return;
  best.count = 2;
  best.index[0] = i;
  best.index[1] = j;
  best.weight[0] = 1.0 - share;
  best.weight[1] = share;
  best.v = v;
  best.length2 = length2;
}

/// Ericson, Real-Time Collision Detection (2005), 5.1.5: Voronoi regions of a triangle; i < j < k. Where `k`
/// is new and brings the simplex closer than i and j could, what is closest holds k: their edge need not be
/// asked.
void offerTriangle(const SupportPair* p, int i, int j, int k, bool k_is_new, Reduced& best) {
  const Vec3 &a = p[i].w, &b = p[j].w, &c = p[k].w;
  const Vec3 n = (b - a).cross(c - a);
  const double n2 = n.squaredNorm();
  // barycentrics of the origin's projection, as volumes n . (x cross y)
  const double wa = n.dot(b.cross(c)), wb = n.dot(c.cross(a)), wc = n.dot(a.cross(b));
  if (n2 > 0.0 && wa > 0.0 && wb > 0.0 && wc > 0.0) {
    const Vec3 v = n * (n.dot(a) / n2);
    const double length2 = v.squaredNorm();
    if (!(length2 < best.length2)) return;
    const double sum = wa + wb + wc;
    best.count = 3;
    best.index[0] = i;
    best.index[1] = j;
    best.index[2] = k;
    best.weight[0] = wa / sum;
    best.weight[1] = wb / sum;
    best.weight[2] = wc / sum;
    best.v = v;
    best.length2 = length2;
    return;
  }
  offerSegment(p, i, k, best);
  offerSegment(p, j, k, best);
  if (!k_is_new) offerSegment(p, i, j, best);
}

/// The last point is new, as in offerTriangle().
void offerTetrahedron(const SupportPair* p, Reduced& best) {
  // The weight of a vertex is the origin's share of the volume over the face opposite to it.
  const Vec3 &a = p[0].w, &b = p[1].w, &c = p[2].w, &d = p[3].w;
  const Vec3 ab = b - a, ac = c - a, ad = d - a;
  const Vec3 abc = ab.cross(ac), acd = ac.cross(ad), adb = ad.cross(ab);
  const double volume = abc.dot(ad);
  const double weight_d = -abc.dot(a), weight_b = -acd.dot(a), weight_c = -adb.dot(a);
  const double weight_a = (b - d).cross(c - d).dot(d);
  const auto beyond = [volume](double weight) { return !(weight * volume > 0.0); };
  const bool out_a = beyond(weight_a), out_b = beyond(weight_b), out_c = beyond(weight_c),
             out_d = beyond(weight_d);
  if (!(out_a || out_b || out_c || out_d)) {
    best.inside = true;
    best.count = 4;
    best.v = Vec3::Zero();
    best.length2 = 0.0;
    const double all = weight_a + weight_b + weight_c + weight_d;
    const double weights[4] = {weight_a, weight_b, weight_c, weight_d};
    for (int i = 0; i < 4; ++i) {
      best.index[i] = i;
      best.weight[i] = weights[i] / all;
    }
    return;
  }
  if (out_a) offerTriangle(p, 1, 2, 3, true, best);
  if (out_b) offerTriangle(p, 0, 2, 3, true, best);
  if (out_c) offerTriangle(p, 0, 1, 3, true, best);
  if (out_d && !(out_a || out_b || out_c)) offerTriangle(p, 0, 1, 2, false, best);
}

/// `last_is_new`: it is a support point along the closest point of the others.
Reduced reduce(const SupportPair* p, int count, bool last_is_new) {
  Reduced best;
  switch (count) {
    case 1:
      offerPoint(p, 0, best);
      break;
    case 2:
      offerSegment(p, 0, 1, best);
      break;
    case 3:
      offerTriangle(p, 0, 1, 2, last_is_new, best);
      break;
    default:
      offerTetrahedron(p, best);
  }
  return best;
}

/// Takes over from the simplex only the points that hold its closest point.
void keep(const Reduced& r, Closest& c) {
  for (int i = 0; i < r.count; ++i) {
    if (r.index[i] != i) c.point[i] = c.point[r.index[i]];
    c.weight[i] = r.weight[i];
  }
  c.count = r.count;
  c.v = r.v;
  c.overlap = r.inside;
}

/// From any points of B - A down to those closest to the origin.
COLLISION_NODE_ANY_WIDTH Closest descend(const Cores& cores, const Closest& start, const GoodEnough& enough) {
  Closest c = start;
  keep(reduce(c.point, c.count, false), c);
  // Points that are closest to rounding, and how far apart the cores are seen to be along them.
  Closest stalled;
  double stalled_gap = -std::numeric_limits<double>::infinity();
  constexpr int kMaxIterations = 96;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    const double length2 = c.v.squaredNorm();
    if (!(length2 > 0.0)) {
      c.overlap = true;
      return c;
    }
    if (length2 <= enough.distance * enough.distance) return c;
    const SupportPair next = cores.support(-c.v);
    const double length = std::sqrt(length2), least = c.v.dot(next.w);
    if (length2 - least <= std::max(1e-13 * length2, enough.loss * (length2 - enough.distance * length)) ||
        least > enough.far * length)
      return c;
    if (stalled.count > 0 && !(least > stalled_gap * length)) return stalled;
    for (int i = 0; i < c.count; ++i) {
      if (next.w == c.point[i].w) return c;
    }
    c.point[c.count] = next;
    const Reduced r = reduce(c.point, c.count + 1, true);
    if (!r.inside && !(r.length2 < length2)) {
      // No more progress in doubles. But a direction that is off by an angle makes the points farther only by
      // its square: what is seen along it tells it better.
      stalled = c;
      stalled_gap = least / length;
    }
    // Nothing lies beyond `next` along -v: with the origin beyond it, only a flat tetrahedron's rounding
    // holds it.
    if (r.inside && c.v.dot(next.w) > 0.0) return c;
    if (r.inside) c.last = c.v;
    keep(r, c);
    if (c.overlap) return c;
  }
  return c;
}

Closest slidingClosest(const Cores& cores) {
  SlidingPoints points(*cores.a.element, *cores.b.element);
  points.find(cores);
  return points.closest(cores);
}

}  // namespace

double coreReach(const Element& e) {
  if (e.frame != nullptr) return e.frame->reach;
  double reach2 = 0.0;
  for (int i = 0; i < e.count; ++i) reach2 = std::max(reach2, e.vertices[i].squaredNorm());
  return std::sqrt(reach2);
}

Vec3 supportOf(const Element& e, const Vec3& direction) {
  if (e.frame != nullptr && e.count == 8) {  // a box
    const auto side = [&](int k) { return e.frame->axes.col(k).dot(direction) > 0.0 ? 1 << k : 0; };
    return e.vertices[side(0) | side(1) | side(2)];
  }
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
  Vec3 across = direction - along * e.axis;
  across -= across.dot(e.axis) * e.axis;  // what the first difference rounded may lie along the axis
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

Closest closestPoints(const Cores& cores, const Vec3& guess, const GoodEnough& enough) {
  if (SlidingPoints::fit(*cores.a.element, *cores.b.element)) return slidingClosest(cores);
  const auto middle = [](const PosedCore& core) {
    const Element& e = *core.element;
    return core.place(e.frame != nullptr ? e.frame->centre : e.vertices[0]);
  };
  Closest start;
  start.count = 1;
  start.point[0] =
      cores.support(guess.squaredNorm() > 0.0 ? Vec3(-guess) : middle(cores.a) - middle(cores.b));
  start.weight[0] = 1.0;
  return descend(cores, start, enough);
}

Closest closestPoints(const Cores& cores, const Closest& before, const GoodEnough& enough) {
  if (SlidingPoints::fit(*cores.a.element, *cores.b.element)) return slidingClosest(cores);
  if (before.count == 0) return closestPoints(cores, before.v, enough);
  Closest start;
  start.count = before.count;
  for (int i = 0; i < before.count; ++i) {
    SupportPair& p = start.point[i];
    p.local_a = before.point[i].local_a;
    p.local_b = before.point[i].local_b;
    p.w = cores.b.place(p.local_b) - cores.a.place(p.local_a);
  }
  return descend(cores, start, enough);
}

}  // namespace collision_node::impact

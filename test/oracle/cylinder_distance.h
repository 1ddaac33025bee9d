/// Static distances of a solid cylinder, exact in its round shape: to points, segments, triangles and
/// cylinders.
#pragma once

#include "test/oracle/flat_distance.h"

namespace oracle {

struct Cylinder {
  V3 centre;
  V3 axis;  ///< unit
  Real radius = 0;
  Real half = 0;  ///< half length
};

/// The cylinder's point nearest to p; p itself when inside.
inline V3 nearestOnCylinder(const V3& p, const Cylinder& c) {
  const V3 r = p - c.centre;
  const Real z = dot(r, c.axis);
  const V3 radial = r - z * c.axis;
  const Real rho = norm(radial);
  const Real z_in = std::min(c.half, std::max(-c.half, z));
  if (rho <= c.radius && z_in == z) return p;
  const V3 radial_in = rho > c.radius ? (c.radius / rho) * radial : radial;
  return c.centre + z_in * c.axis + radial_in;
}

inline Gap pointCylinder(const V3& p, const Cylinder& c) { return gapBetween(p, nearestOnCylinder(p, c)); }

/// The direction in which the distance grows at an outside point p, not normalised. Taken region by region:
/// the difference to the nearest point would be all rounding close to the surface.
inline V3 growthDirection(const V3& p, const Cylinder& c) {
  const V3 r = p - c.centre;
  const Real z = dot(r, c.axis);
  const V3 radial = r - z * c.axis;
  const Real rho = norm(radial);
  const Real out = std::max<Real>(0, rho - c.radius), over = std::max<Real>(0, std::abs(z) - c.half);
  V3 direction = (z > 0 ? over : -over) * c.axis;
  if (out > 0) direction = direction + (out / rho) * radial;
  return direction;
}

/// The distance along a segment is convex: bisect on the sign of its derivative.
inline Gap segmentCylinder(const V3& p0, const V3& p1, const Cylinder& c) {
  const V3 e = p1 - p0;
  Gap best = pointCylinder(p0, c);
  keepNearer(best, pointCylinder(p1, c));
  Real lo = 0, hi = 1;
  for (int i = 0; i < 70 && best.upper > 0; ++i) {
    const Real mid = (lo + hi) / 2;
    const Gap g = pointCylinder(p0 + mid * e, c);
    keepNearer(best, g);
    (dot(growthDirection(g.a, c), e) > 0 ? hi : lo) = mid;
  }
  return best;
}

/// The cylinder's point farthest along n.
inline V3 supportOfCylinder(const Cylinder& c, const V3& n) {
  const Real z = dot(n, c.axis);
  V3 radial = n - z * c.axis;
  radial = radial - dot(radial, c.axis) * c.axis;  // once more: what is left of a parallel n is only rounding
  const Real rho = norm(radial);
  V3 s = c.centre + (z >= 0 ? c.half : -c.half) * c.axis;
  if (rho > 1e-18L * norm(n)) s = s + (c.radius / rho) * radial;
  return s;
}

/// Either the nearest point of the triangle lies on an edge, or inside its face: then the cylinder's nearest
/// point is its extreme point towards the plane. (Where a whole disc or line is extreme, the edges or that
/// point find it.)
inline Gap triangleCylinder(const V3* t, const Cylinder& c) {
  Gap best;
  for (int i = 0; i < 3; ++i) {
    keepNearer(best, segmentCylinder(t[i], t[(i + 1) % 3], c));
    if (best.upper == 0) return best;
  }
  const V3 n = triangleNormal(t);
  const Real nn = dot(n, n);
  if (!(nn > 0)) return best;
  const V3 top = supportOfCylinder(c, n), bottom = supportOfCylinder(c, -n);
  V3 where;
  if (pierces(bottom, top, t, &where)) return {0, 0, where, where};
  for (const V3& s : {top, bottom}) {
    const Real height = dot(s - t[0], n);
    const bool between = dot(top - t[0], n) >= 0 && dot(bottom - t[0], n) <= 0;
    if (between || !projectsInside(s, t, n)) continue;
    Gap face = gapBetween(s - (height / nn) * n, s);
    face.lower = face.upper = std::abs(height) / std::sqrt(nn);
    keepNearer(best, face);
  }
  return best;
}

/// One vertex of the difference set A - B with the two points it came from.
struct SupportPair {
  V3 difference, a, b;
};

/// Up to four support points and the weights of the point of their hull that is nearest to the origin.
struct Simplex {
  int count = 0;
  SupportPair vertex[4];
  Real weight[4] = {1, 0, 0, 0};
};

/// The point of the simplex's hull nearest to the origin, by trying every face; drops the vertices it does
/// not need.
inline V3 nearestOnSimplex(Simplex& simplex) {
  Real best = std::numeric_limits<Real>::infinity();
  V3 nearest;
  int kept[4], kept_count = 0;
  Real kept_weight[4];
  const auto offer = [&](int n, const int(&ids)[4], const Real(&w)[4]) {
    V3 p;
    for (int k = 0; k < n; ++k) {
      if (!(w[k] >= 0)) return;
      p = p + w[k] * simplex.vertex[ids[k]].difference;
    }
    const Real d = norm(p);
    if (!(d < best)) return;
    best = d, nearest = p, kept_count = n;
    std::copy(ids, ids + n, kept);
    std::copy(w, w + n, kept_weight);
  };
  const int n = simplex.count;
  for (int i = 0; i < n; ++i) {
    const V3& p = simplex.vertex[i].difference;
    offer(1, {i}, {1});
    for (int j = i + 1; j < n; ++j) {
      const V3 e = simplex.vertex[j].difference - p;
      const Real u = -dot(p, e) / dot(e, e);
      offer(2, {i, j}, {1 - u, u});
      for (int k = j + 1; k < n; ++k) {
        const V3 f = simplex.vertex[k].difference - p, normal = cross(e, f);
        const Real nn = dot(normal, normal);
        const Real v = dot(cross(-p, f), normal) / nn, w = dot(cross(e, -p), normal) / nn;
        offer(3, {i, j, k}, {1 - v - w, v, w});
      }
    }
  }
  if (n == 4) {
    const V3 &o = simplex.vertex[0].difference, e = simplex.vertex[1].difference - o,
             f = simplex.vertex[2].difference - o, g = simplex.vertex[3].difference - o;
    const Real volume = dot(e, cross(f, g));
    const Real u = dot(-o, cross(f, g)) / volume, v = dot(e, cross(-o, g)) / volume,
               w = dot(e, cross(f, -o)) / volume;
    offer(4, {0, 1, 2, 3}, {1 - u - v - w, u, v, w});
  }
  for (int k = 0; k < kept_count; ++k) {  // ids ascend, so nothing is overwritten before it is read
    simplex.vertex[k] = simplex.vertex[kept[k]];
    simplex.weight[k] = kept_weight[k];
  }
  simplex.count = kept_count;
  return nearest;
}

/// Distance of two convex sets given by their support functions, with the duality gap as proof: `lower` comes
/// from a separating plane, `upper` from two points. Gilbert's simplex descent; `scale` bounds all
/// coordinates.
template <class SupportA, class SupportB>
Gap convexGap(const SupportA& support_a, const SupportB& support_b, V3 direction, Real scale,
              Real loose = 0) {
  const auto support = [&](const V3& n) {
    const V3 a = support_a(n), b = support_b(-n);
    return SupportPair{a - b, a, b};
  };
  if (!(norm(direction) > 0)) direction = {1, 0, 0};
  Simplex simplex;
  simplex.count = 1;
  simplex.vertex[0] = support(-direction);
  Gap best;
  best.lower = 0;
  Real previous = std::numeric_limits<Real>::infinity();
  for (int i = 0; i < 300; ++i) {
    const V3 v = nearestOnSimplex(simplex);
    const Real length = norm(v);
    if (length < best.upper) {
      best.a = best.b = V3{};
      for (int k = 0; k < simplex.count; ++k) {
        best.a = best.a + simplex.weight[k] * simplex.vertex[k].a;
        best.b = best.b + simplex.weight[k] * simplex.vertex[k].b;
      }
      best.upper = length;
    }
    if (length <= 1e-19L * scale) {
      best.lower = best.upper = 0;
      return best;
    }
    const SupportPair next = support(-v);
    best.lower = std::max(best.lower, dot(v, next.difference) / length - 4e-19L * scale);
    if (best.upper - best.lower <= std::max(1e-18L * scale, loose * best.lower) ||
        (i > 4 && !(length < previous)) || simplex.count == 4)
      break;
    previous = length;
    simplex.vertex[simplex.count++] = next;
  }
  return best;
}

/// Where the point of c that reaches farthest towards a cap's plane of d stands above that cap, it is the
/// nearest, and its height the distance. A search finds the place only to the root of its rounding.
inline bool rimOverCap(const Cylinder& c, const Cylinder& d, Gap& gap) {
  for (const V3& up : {d.axis, -d.axis}) {
    const V3 lowest = supportOfCylinder(c, -up), r = lowest - d.centre;
    const Real height = dot(r, up) - d.half;
    if (!(height > 0) || norm(r - dot(r, up) * up) > d.radius) continue;
    gap = gapBetween(lowest, lowest - height * up);
    gap.lower = gap.upper = height;
    return true;
  }
  return false;
}

inline Gap cylinderCylinder(const Cylinder& c, const Cylinder& d, Real loose = 0) {
  Gap gap;
  if (rimOverCap(c, d, gap)) return gap;
  if (rimOverCap(d, c, gap)) {
    std::swap(gap.a, gap.b);
    return gap;
  }
  const Real scale = norm(d.centre - c.centre) + c.radius + c.half + d.radius + d.half;
  return convexGap([&](const V3& n) { return supportOfCylinder(c, n); },
                   [&](const V3& n) { return supportOfCylinder(d, n); }, c.centre - d.centre, scale, loose);
}

/// Distance between the hull of 1, 2 or 3 points and a cylinder.
inline Gap flatCylinder(const V3* t, int n, const Cylinder& c) {
  if (n == 1) return pointCylinder(t[0], c);
  if (n == 2) return segmentCylinder(t[0], t[1], c);
  return triangleCylinder(t, c);
}

}  // namespace oracle

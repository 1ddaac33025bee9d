/// Static distances between points, segments and triangles: every pair of features, nothing clever.
#pragma once

#include <limits>

#include "test/oracle/vec.h"

namespace oracle {

/// The two closest points of a pair and bounds of their distance. `lower` is never above the true distance by
/// more than rounding; `upper` = |b - a|. For all but two cylinders the two agree to rounding.
struct Gap {
  Real lower = std::numeric_limits<Real>::infinity();
  Real upper = std::numeric_limits<Real>::infinity();
  V3 a, b;
};

inline Gap gapBetween(const V3& a, const V3& b) {
  const Real d = norm(b - a);
  return {d, d, a, b};
}

inline Gap swapped(const Gap& g) { return {g.lower, g.upper, g.b, g.a}; }

inline void keepNearer(Gap& best, const Gap& other) {
  if (other.upper < best.upper) best = other;
}

inline V3 nearestOnSegment(const V3& p, const V3& s0, const V3& s1) {
  const V3 e = s1 - s0;
  const Real ee = dot(e, e);
  if (!(ee > 0)) return s0;
  const Real u = dot(p - s0, e) / ee;
  if (u <= 0) return s0;
  if (u >= 1) return s1;
  return s0 + u * e;
}

inline Gap segmentSegment(const V3& p0, const V3& p1, const V3& q0, const V3& q1) {
  // The four ends against the other segment, and the common perpendicular where it falls inside both.
  Gap best = gapBetween(p0, nearestOnSegment(p0, q0, q1));
  keepNearer(best, gapBetween(p1, nearestOnSegment(p1, q0, q1)));
  keepNearer(best, gapBetween(nearestOnSegment(q0, p0, p1), q0));
  keepNearer(best, gapBetween(nearestOnSegment(q1, p0, p1), q1));
  const V3 d = p1 - p0, e = q1 - q0, r = q0 - p0, n = cross(d, e);
  const Real nn = dot(n, n);
  if (nn > 0) {
    const Real u = dot(cross(r, e), n) / nn, v = dot(cross(r, d), n) / nn;
    if (u >= 0 && u <= 1 && v >= 0 && v <= 1) {
      // The perpendicular's length from the normal itself: exact where the two points almost coincide.
      Gap inner = gapBetween(p0 + u * d, q0 + v * e);
      inner.lower = inner.upper = std::abs(dot(r, n)) / std::sqrt(nn);
      keepNearer(best, inner);
    }
  }
  return best;
}

/// Whether p, projected along the normal n, falls inside the triangle.
inline bool projectsInside(const V3& p, const V3* t, const V3& n) {
  for (int i = 0; i < 3; ++i) {
    const V3 &from = t[i], &to = t[(i + 1) % 3];
    if (dot(cross(to - from, p - from), n) < 0) return false;
  }
  return true;
}

inline V3 triangleNormal(const V3* t) { return cross(t[1] - t[0], t[2] - t[0]); }

inline Gap pointTriangle(const V3& p, const V3* t) {
  const V3 n = triangleNormal(t);
  const Real nn = dot(n, n);
  if (nn > 0 && projectsInside(p, t, n)) {
    const Real height = dot(p - t[0], n);
    Gap inner = gapBetween(p, p - (height / nn) * n);
    inner.lower = inner.upper = std::abs(height) / std::sqrt(nn);
    return inner;
  }
  Gap best;
  for (int i = 0; i < 3; ++i) keepNearer(best, gapBetween(p, nearestOnSegment(p, t[i], t[(i + 1) % 3])));
  return best;
}

/// Whether the open segment crosses the triangle, and where.
inline bool pierces(const V3& p0, const V3& p1, const V3* t, V3* where) {
  const V3 n = triangleNormal(t);
  const Real h0 = dot(p0 - t[0], n), h1 = dot(p1 - t[0], n);
  if (!((h0 <= 0 && h1 >= 0) || (h0 >= 0 && h1 <= 0)) || h0 == h1) return false;
  *where = p0 + (h0 / (h0 - h1)) * (p1 - p0);
  return projectsInside(*where, t, n);
}

inline Gap segmentTriangle(const V3& p0, const V3& p1, const V3* t) {
  V3 where;
  if (pierces(p0, p1, t, &where)) return {0, 0, where, where};
  Gap best = pointTriangle(p0, t);
  keepNearer(best, pointTriangle(p1, t));
  for (int i = 0; i < 3; ++i) keepNearer(best, segmentSegment(p0, p1, t[i], t[(i + 1) % 3]));
  return best;
}

inline Gap triangleTriangle(const V3* s, const V3* t) {
  Gap best;
  for (int i = 0; i < 3; ++i) {
    keepNearer(best, segmentTriangle(s[i], s[(i + 1) % 3], t));
    if (best.upper == 0) return best;
  }
  for (int i = 0; i < 3; ++i) {
    V3 where;
    if (pierces(t[i], t[(i + 1) % 3], s, &where)) return {0, 0, where, where};
    keepNearer(best, swapped(pointTriangle(t[i], s)));
  }
  return best;
}

/// Distance between the hulls of 1, 2 or 3 points each.
inline Gap flatGap(const V3* s, int ns, const V3* t, int nt) {
  if (ns > nt) return swapped(flatGap(t, nt, s, ns));
  if (ns == 1 && nt == 1) return gapBetween(s[0], t[0]);
  if (ns == 1 && nt == 2) return gapBetween(s[0], nearestOnSegment(s[0], t[0], t[1]));
  if (ns == 1) return pointTriangle(s[0], t);
  if (ns == 2 && nt == 2) return segmentSegment(s[0], s[1], t[0], t[1]);
  if (ns == 2) return segmentTriangle(s[0], s[1], t);
  return triangleTriangle(s, t);
}

}  // namespace oracle

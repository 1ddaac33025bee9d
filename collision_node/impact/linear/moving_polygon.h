/// A convex polygon whose corners move on straight lines over [0, 1]: when does it hold the origin?
///
/// The corners are the differences of two features' vertices: three for a vertex and a triangle, the four of
/// a parallelogram for two edges. The features touch exactly when the polygon holds the origin.
///
/// Guarantee: apartUntil() and crosses() speak of real arithmetic on the stored corners. They rest on two
/// proofs, positiveThrough() and crosses(), each of which subtracts a rounding budget derived there;
/// everything else only proposes. Real is double or DoubleDouble: the same lines, a smaller budget.
/// Derivation: docs/solver.md, "Vertices on straight lines".
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "collision_node/impact/linear/double_double.h"

namespace collision_node::impact {

template <typename Real>
struct Triple {
  Real x{}, y{}, z{};
};

template <typename Real>
Triple<Real> operator+(const Triple<Real>& a, const Triple<Real>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <typename Real>
Triple<Real> operator-(const Triple<Real>& a, const Triple<Real>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <typename Real>
Triple<Real> operator*(const Real& s, const Triple<Real>& a) {
  return {s * a.x, s * a.y, s * a.z};
}
template <typename Real>
Real dot(const Triple<Real>& a, const Triple<Real>& b) {
  return (a.x * b.x + a.y * b.y) + a.z * b.z;
}
template <typename Real>
Triple<Real> cross(const Triple<Real>& a, const Triple<Real>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
/// Sum of the components' magnitudes.
template <typename Real>
double sumOf(const Triple<Real>& a) {
  return std::abs(toDouble(a.x)) + std::abs(toDouble(a.y)) + std::abs(toDouble(a.z));
}

/// Corners in cyclic order; every component at most 1 in magnitude, the largest at least 1/2.
template <typename Real>
struct MovingPolygon {
  int count = 0;
  /// Within one kRounding, relative, of the exact corners; exact for DoubleDouble.
  std::array<Triple<Real>, 4> start, end;
};

template <typename Real>
using Corners = std::array<Triple<Real>, 4>;

inline double oneMinus(double t, double /*as*/) { return 1.0 - t; }
inline DoubleDouble oneMinus(double t, const DoubleDouble& /*as*/) { return twoSum(1.0, -t); }

/// Each component within 5 units of the exact corner: at most one for the stored corner, three for 1 - t and
/// its product, one for the other product and one for the sum, all relative to 1 (the two products share it).
template <typename Real>
Corners<Real> cornersAt(const MovingPolygon<Real>& polygon, double t) {
  const Real late(t), early(oneMinus(t, Real()));
  Corners<Real> corners;
  for (int k = 0; k < polygon.count; ++k) {
    corners[k] = early * polygon.start[k] + late * polygon.end[k];
  }
  return corners;
}

/// Proof of clearance: the axis that blends from `n0` to `n1` while the corners move from `w0` to `w1` has
/// all corners on its positive side throughout.
/// n.w is a quadratic with Bernstein coefficients n0.w0, (n0.w1 + n1.w0)/2, n1.w1; all positive is enough.
/// Budget, u = kRounding, |n| the sum of magnitudes: a corner is off by 5u, its dot product rounds by 3u |n|
/// and the sum of two by 2u |n| more, halved; below 10u |n|. 16u |n| is subtracted.
template <typename Real>
bool positiveThrough(const Triple<Real>& n0, const Triple<Real>& n1, const Corners<Real>& w0,
                     const Corners<Real>& w1, int count) {
  const double length = std::max(sumOf(n0), sumOf(n1));
  if (!(length > 0x1p-40 && length < 0x1p40)) return false;
  const double budget = 16.0 * kRounding<Real> * length;
  for (int k = 0; k < count; ++k) {
    const double b0 = toDouble(dot(n0, w0[k])), b2 = toDouble(dot(n1, w1[k]));
    const double b1 = toDouble(dot(n0, w1[k]) + dot(n1, w0[k]));
    if (!(b0 > budget && b1 > 2.0 * budget && b2 > budget)) return false;
  }
  return true;
}

/// The normal of the polygon, unnormalised.
template <typename Real>
Triple<Real> normalOf(const Corners<Real>& w, int count) {
  return cross(w[1] - w[0], w[count - 1] - w[0]);
}

/// Proof of contact: some t between t0 and t1 at which the polygon holds the origin.
/// Seen along `up`, the polygon winds around the origin throughout: up.(w_k x w_k+1) > 0 for every side (the
/// same Bernstein form). Then its plane is a graph over the plane across `up`, and its height over the origin
/// has the sign of w_0 . normal, which differs at the two ends: in between it is zero.
/// Budget: a cross product of corners off by 5u rounds to within 2 (2 . 5u) + 3 . 2u < 28u per component;
/// with `up` (sum of magnitudes |up|, components at most 2) below 40u |up|, 64u |up| is subtracted. The
/// determinant's edges are off by 12u and at most 2: a component of the normal is within 2 (2 . 2 . 12u) + 3
/// . 8u < 124u and at most 8; times three corners 3 (124u + 8 . 5u) + 3u . 24 < 580u. 1024u is asked.
template <typename Real>
bool crosses(const Triple<Real>& up, const Corners<Real>& w0, const Corners<Real>& w1, int count) {
  const double length = sumOf(up);
  if (!(length > 0x1p-40 && length < 0x1p40)) return false;
  const double height_budget = 1024.0 * kRounding<Real>;
  const double h0 = toDouble(dot(w0[0], normalOf(w0, count)));
  const double h1 = toDouble(dot(w1[0], normalOf(w1, count)));
  if (!((h0 > height_budget && h1 < -height_budget) || (h0 < -height_budget && h1 > height_budget))) {
    return false;
  }
  const double budget = 64.0 * kRounding<Real> * length;
  for (int k = 0; k < count; ++k) {
    const int l = k + 1 == count ? 0 : k + 1;
    const double b0 = toDouble(dot(up, cross(w0[k], w0[l])));
    const double b1 = toDouble(dot(up, cross(w0[k], w1[l])) + dot(up, cross(w1[k], w0[l])));
    const double b2 = toDouble(dot(up, cross(w1[k], w1[l])));
    if (!(b0 > budget && b1 > 2.0 * budget && b2 > budget)) return false;
  }
  return true;
}

/// n(s) = direction + s rate, s from now; `direction` about unit.
template <typename Real>
struct TurningAxis {
  Triple<Real> direction, rate;
  bool valid = false;
};

/// The polygon's normal towards its own side of the origin, turning with it.
template <typename Real>
TurningAxis<Real> faceAxis(const Corners<Real>& w, const Corners<Real>& velocity, int count) {
  const Triple<Real> e1 = w[1] - w[0], e2 = w[count - 1] - w[0];
  const Triple<Real> n = cross(e1, e2);
  TurningAxis<Real> axis;
  const double length = sumOf(n);
  if (!(length > 0x1p-200)) return axis;
  const Real scale((toDouble(dot(n, w[0])) < 0.0 ? -1.0 : 1.0) / length);
  axis.direction = scale * n;
  axis.rate = scale * (cross(velocity[1] - velocity[0], e2) + cross(e1, velocity[count - 1] - velocity[0]));
  axis.valid = true;
  return axis;
}

/// From the origin to the nearest point of the polygon's border, staying across the side that holds it.
template <typename Real>
TurningAxis<Real> borderAxis(const Corners<Real>& w, const Corners<Real>& velocity, int count) {
  TurningAxis<Real> axis;
  double nearest = std::numeric_limits<double>::infinity();
  for (int k = 0; k < count; ++k) {
    const int l = k + 1 == count ? 0 : k + 1;
    const Triple<Real> side = w[l] - w[k];
    const Real along = dot(side, side), at = -dot(side, w[k]);
    const bool inside = toDouble(at) > 0.0 && toDouble(along - at) > 0.0;
    const Triple<Real> point = inside ? w[k] + (at / along) * side : (toDouble(at) > 0.0 ? w[l] : w[k]);
    const double distance = toDouble(dot(point, point));
    if (!(distance < nearest) || !(distance > 0.0)) continue;
    nearest = distance;
    const Real scale(1.0 / std::sqrt(distance));
    axis.valid = true;
    axis.direction = scale * point;
    axis.rate = {Real(0.0), Real(0.0), Real(0.0)};
    if (inside) axis.rate = (-(dot(axis.direction, velocity[l] - velocity[k]) / along)) * side;
  }
  return axis;
}

/// How far every corner seems to stay on the positive side: the first root of c0 + c1 s + min(c2, 0) s^2,
/// without cancellation for either sign of c1. A proposal.
template <typename Real>
double proposedStep(const TurningAxis<Real>& axis, const Corners<Real>& w, const Corners<Real>& velocity,
                    int count, double span) {
  if (!axis.valid) return 0.0;
  const double budget = 40.0 * kRounding<Real> * (sumOf(axis.direction) + span * sumOf(axis.rate));
  double step = span;
  for (int k = 0; k < count; ++k) {
    const double gap = toDouble(dot(axis.direction, w[k])) - budget;
    if (!(gap > 0.0)) return 0.0;
    const double slope = toDouble(dot(axis.direction, velocity[k]) + dot(axis.rate, w[k]));
    const double bend = 2.0 * std::max(0.0, -toDouble(dot(axis.rate, velocity[k])));
    const double root = std::sqrt(slope * slope + 2.0 * bend * gap);
    if (slope > 0.0) {
      if (bend > 0.0) step = std::min(step, (slope + root) / bend);
    } else if (root - slope > 0.0) {
      step = std::min(step, 2.0 * gap / (root - slope));
    }
  }
  return step;
}

/// Goes from `from` towards `to` (either way) and returns the farthest time reached with proof that the
/// polygon does not hold the origin at any time between `from` and it; `to` itself when all is proved free.
/// `from` when nothing is proved, not even that instant.
template <typename Real>
double apartUntil(const MovingPolygon<Real>& polygon, double from, double to, int max_steps) {
  const double way = to > from ? 1.0 : -1.0;
  Corners<Real> velocity;
  for (int k = 0; k < polygon.count; ++k) {
    velocity[k] = Real(way) * (polygon.end[k] - polygon.start[k]);
  }
  double t = from;
  Corners<Real> w = cornersAt(polygon, t);
  for (int i = 0; i < max_steps && t != to; ++i) {
    const double span = std::abs(to - t);
    TurningAxis<Real> best;
    double step = 0.0;
    const auto consider = [&](const TurningAxis<Real>& axis) {
      const double proposed = proposedStep(axis, w, velocity, polygon.count, span);
      if (proposed > step) {
        step = proposed;
        best = axis;
      }
    };
    TurningAxis<Real> border = borderAxis(w, velocity, polygon.count);
    consider(border);
    if (step < span) consider(faceAxis(w, velocity, polygon.count));
    if (step < span) {
      border.rate = {Real(0.0), Real(0.0), Real(0.0)};
      consider(border);
    }
    bool moved = false;
    for (int trial = 0; trial < 3 && !moved; ++trial, step *= 0.5) {
      const double next = step >= span ? to : t + way * step;
      if (!(std::abs(next - t) > 0.0)) break;
      const Corners<Real> w1 = cornersAt(polygon, next);
      const Triple<Real> n1 = best.direction + Real(std::abs(next - t)) * best.rate;
      if (!positiveThrough(best.direction, n1, w, w1, polygon.count)) continue;
      t = next;
      w = w1;
      moved = true;
    }
    if (!moved) break;
  }
  return t;
}

/// The other end of a short interval from `from` towards `limit` on which contact is proved; NaN when none
/// is.
template <typename Real>
double crossingFrom(const MovingPolygon<Real>& polygon, double from, double limit) {
  const int count = polygon.count;
  const double way = limit > from ? 1.0 : -1.0;
  const Corners<Real> w = cornersAt(polygon, from);
  const Triple<Real> n = normalOf(w, count);
  const double length = sumOf(n);
  const double none = std::numeric_limits<double>::quiet_NaN();
  if (!(length > 0x1p-200)) return none;
  const Triple<Real> up = Real(1.0 / length) * n;
  for (double width = 0x1p-52;; width *= 8.0) {
    const bool last = width >= std::abs(limit - from);
    const double to = last ? limit : from + way * width;
    if (to != from && crosses(up, w, cornersAt(polygon, to), count)) return to;
    if (last) return none;
  }
}

}  // namespace collision_node::impact

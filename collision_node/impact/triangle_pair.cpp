#include "collision_node/impact/triangle_pair.h"

#include <algorithm>
#include <cmath>

namespace collision_node::impact {
namespace {

constexpr double kUp = 1.0 + 64.0 * kUnit;

double reachOf(const Vec3 v[3]) {
  return std::sqrt(std::max({v[0].squaredNorm(), v[1].squaredNorm(), v[2].squaredNorm()})) * kUp;
}

}  // namespace

TrianglePair::TrianglePair(const PairPiece& piece, const Instant& now, const Element& a, const Element& b)
    : piece_(piece), now_(now) {
  for (int i = 0; i < 3; ++i) {
    a_[i] = now.ra * a.vertices[i];
    b_[i] = now.rb * b.vertices[i];
  }
  reach_a_ = reachOf(a.vertices);
  reach_b_ = reachOf(b.vertices);
  const RelativeMotion& m = piece.motion;
  curve_ =
      0.5 * kUp * (m.maxAcceleration() + m.spinA() * m.spinA() * reach_a_ + m.spinB() * m.spinB() * reach_b_);
}

double TrianglePair::apartFor(double span, Axis* axis) const {
  const Vec3 &wa = piece_.motion.omegaA(), &wb = piece_.motion.omegaB();
  Vec3 edges_a[3], edges_b[3];
  for (int i = 0; i < 3; ++i) {
    edges_a[i] = a_[(i + 1) % 3] - a_[i];
    edges_b[i] = b_[(i + 1) % 3] - b_[i];
  }
  Candidate all[11];
  int count = 0;
  const auto consider = [&](const Vec3& normal, int edge_a, int edge_b) {
    const double gap = gapAlong(normal);
    if (gap != 0.0) all[count++] = {normal, gap, edge_a, edge_b};
  };
  consider(edges_a[0].cross(edges_a[1]), -1, 0);
  consider(edges_b[0].cross(edges_b[1]), 0, -1);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) consider(edges_a[i].cross(edges_b[j]), i, j);
  }
  // The widest gaps first; a few tell nearly as much as all.
  constexpr int kTried = 4;
  const int tried = std::min(count, kTried);
  std::partial_sort(all, all + tried, all + count,
                    [](const Candidate& x, const Candidate& y) { return std::abs(x.gap) > std::abs(y.gap); });
  double best = 0.0;
  for (int i = 0; i < tried && best < span; ++i) {
    const Candidate& c = all[i];
    const Vec3 rate = c.edge_b < 0   ? wb.cross(c.normal)
                      : c.edge_a < 0 ? wa.cross(c.normal)
                                     : Vec3(wa.cross(edges_a[c.edge_a]).cross(edges_b[c.edge_b]) +
                                            edges_a[c.edge_a].cross(wb.cross(edges_b[c.edge_b])));
    // Of unit length, and what the rate has across itself counts.
    const double scale = (c.gap > 0.0 ? 1.0 : -1.0) / c.normal.norm();
    const Vec3 n = c.normal * scale;
    const Vec3 n_rate = rate * scale - n * (n.dot(rate) * scale);
    const double proved = alongAxis(n, n_rate, span);
    if (!(proved > best)) continue;
    best = proved;
    *axis = {n, n_rate, true};
  }
  return best;
}

/// The gap now along a normal of any length; negative where A lies beyond B, 0 where they overlap.
double TrianglePair::gapAlong(const Vec3& normal) const {
  const double length2 = normal.squaredNorm();
  if (!(length2 > 1e-300)) return 0.0;
  const double offset = normal.dot(now_.d);
  double pa[3], pb[3];
  for (int i = 0; i < 3; ++i) {
    pa[i] = normal.dot(a_[i]);
    pb[i] = normal.dot(b_[i]) + offset;
  }
  const double ahead = std::min({pb[0], pb[1], pb[2]}) - std::max({pa[0], pa[1], pa[2]});
  const double behind = std::min({pa[0], pa[1], pa[2]}) - std::max({pb[0], pb[1], pb[2]});
  if (ahead > 0.0) return ahead / std::sqrt(length2);
  return behind > 0.0 ? -behind / std::sqrt(length2) : 0.0;
}

double TrianglePair::alongAxis(const Vec3& n, const Vec3& rate, double span) const {
  const RelativeMotion& m = piece_.motion;
  const double length = n.norm() * kUp, rate_length = rate.norm() * kUp;
  const double pe = piece_.point_error + piece_.contact_distance, re = piece_.rate_error;
  // f(s) = min over b (level + s slope) - max over a (the same) + start + s growth - s^2 bend: concave, below
  // the gap.
  const Vec3 turn_a = rate + n.cross(m.omegaA()), turn_b = rate + n.cross(m.omegaB());
  double level_a[3], slope_a[3], level_b[3], slope_b[3];
  for (int i = 0; i < 3; ++i) {
    level_a[i] = n.dot(a_[i]);
    slope_a[i] = turn_a.dot(a_[i]);
    level_b[i] = n.dot(b_[i]);
    slope_b[i] = turn_b.dot(b_[i]);
  }
  const double turning = rate.cross(m.omegaA()).norm() * reach_a_ + rate.cross(m.omegaB()).norm() * reach_b_;
  const double square =
      std::max(0.0, turning - rate.dot(now_.d_rate)) * kUp + 8.0 * kUnit * rate_length * piece_.speed;
  const double bend = (square + curve_ * (length + span * rate_length) + rate_length * re) * kUp;
  const double start = n.dot(now_.d) - length * pe;
  const double growth = rate.dot(now_.d) + n.dot(now_.d_rate) - rate_length * pe - length * re;

  int ia = 0, ib = 0;
  const auto at = [&](double s) {
    double top = level_a[0] + s * slope_a[0], low = level_b[0] + s * slope_b[0];
    ia = ib = 0;
    for (int i = 1; i < 3; ++i) {
      const double x = level_a[i] + s * slope_a[i], y = level_b[i] + s * slope_b[i];
      if (x > top) {
        top = x;
        ia = i;
      }
      if (y < low) {
        low = y;
        ib = i;
      }
    }
    return (low - top) + (start + s * growth) - s * s * bend;
  };
  if (!(at(0.0) > 0.0)) return 0.0;
  double s = span;
  constexpr int kVertexPairs = 9;
  for (int i = 0; i < kVertexPairs; ++i) {
    if (at(s) > 0.0) return s;
    // The parabola of the two vertices that are worst at s: its root lies before s.
    const double f0 = level_b[ib] - level_a[ia] + start, f1 = slope_b[ib] - slope_a[ia] + growth;
    const double q = std::sqrt(f1 * f1 + 4.0 * bend * f0);
    const double root = f1 > 0.0 ? (f1 + q) / (2.0 * bend) : 2.0 * f0 / (q - f1);
    const double next = root * (1.0 - 1e-9);
    if (!(next < s)) break;
    s = next;
  }
  // Each evaluated value is a proof; where the last bits decide, step inside.
  for (const double inside : {1.0 - 1e-6, 1.0 - 1e-3, 0.5}) {
    if (at(s * inside) > 0.0) return s * inside;
  }
  return 0.0;
}

}  // namespace collision_node::impact

#include "collision_node/impact/convex/triangle_pair.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "collision_node/impact/four_doubles.h"

namespace collision_node::impact {
namespace {

double reachOf(const Vec3 v[3]) {
  return std::sqrt(std::max({v[0].squaredNorm(), v[1].squaredNorm(), v[2].squaredNorm()})) * kUp;
}

/// The axes of the separating axis theorem, and the gaps along them now: lane j < 3 of row i is edge i of A
/// with edge j of B; the last lane of row 0 is the face of A, of row 1 that of B, of row 2 nothing.
struct Normals {
  double x[3][3][kFour];  ///< by coordinate, of any length
  double gap[3][kFour];   ///< [m] negative where A lies beyond B; 0 where they overlap

  Vec3 normal(int i) const {
    return {x[0][i / kFour][i % kFour], x[1][i / kFour][i % kFour], x[2][i / kFour][i % kFour]};
  }
  int widest() const {
    int widest = 0;
    for (int i = 1; i < 3 * kFour; ++i) {
      if (std::abs(gap[i / kFour][i % kFour]) > std::abs(gap[widest / kFour][widest % kFour])) widest = i;
    }
    return widest;
  }
};

COLLISION_NODE_ANY_WIDTH
void gapsOf(const Vec3 a[3], const Vec3 b[3], const Vec3 edges_a[3], const Vec3 edges_b[3], const Vec3& d,
            Normals& all) {
  for (int i = 0; i < 3; ++i) {
    const Vec3 zero = Vec3::Zero();
    const Vec3 &p = edges_a[i], &q0 = edges_b[0], &q1 = edges_b[1], &q2 = edges_b[2];
    const Vec3& p_last = i == 0 ? edges_a[0] : i == 1 ? edges_b[0] : zero;
    const Vec3& q_last = i == 0 ? edges_a[1] : i == 1 ? edges_b[1] : zero;
    const auto first = [&](int k) { return Four{p[k], p[k], p[k], p_last[k]}; };
    const auto second = [&](int k) { return Four{q0[k], q1[k], q2[k], q_last[k]}; };
    Four n[3];
    for (int k = 0; k < 3; ++k) {
      const int y = (k + 1) % 3, z = (k + 2) % 3;
      n[k] = first(y) * second(z) - first(z) * second(y);
      std::memcpy(all.x[k][i], &n[k], sizeof n[k]);
    }
    const Four length2 = dotOf(n, n);
    Four low_a = dotOf(n, a[0]), high_a = low_a, low_b = dotOf(n, b[0]), high_b = low_b;
    for (int v = 1; v < 3; ++v) {
      const Four on_a = dotOf(n, a[v]), on_b = dotOf(n, b[v]);
      low_a = smaller(on_a, low_a);
      high_a = larger(on_a, high_a);
      low_b = smaller(on_b, low_b);
      high_b = larger(on_b, high_b);
    }
    const Four offset = dotOf(n, d), ahead = (low_b + offset) - high_a, behind = low_a - (high_b + offset);
    Four gap = ahead > 0.0 ? ahead : behind > 0.0 ? -behind : Four{};
    Four length;
    for (int lane = 0; lane < kFour; ++lane) length[lane] = std::sqrt(length2[lane]);
    gap = length2 > 1e-300 ? gap / length : Four{};
    std::memcpy(all.gap[i], &gap, sizeof gap);
  }
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
  Normals all;
  gapsOf(a_, b_, edges_a, edges_b, now_.d, all);
  // The widest gaps first; a few tell nearly as much as all.
  constexpr int kTried = 4;
  double best = 0.0;
  for (int tried = 0; tried < kTried && best < span; ++tried) {
    const int widest = all.widest();
    const double gap = std::exchange(all.gap[widest / kFour][widest % kFour], 0.0);
    if (gap == 0.0) break;
    const Vec3 normal = all.normal(widest);
    const int i = widest / kFour, j = widest % kFour;
    const Vec3 rate =
        j < 3    ? Vec3(wa.cross(edges_a[i]).cross(edges_b[j]) + edges_a[i].cross(wb.cross(edges_b[j])))
        : i == 0 ? wa.cross(normal)
                 : wb.cross(normal);
    // Of unit length, and what the rate has across itself counts.
    const double scale = (gap > 0.0 ? 1.0 : -1.0) / normal.norm();
    const Vec3 n = normal * scale;
    const Vec3 n_rate = rate * scale - n * (n.dot(rate) * scale);
    const double proved = alongAxis(n, n_rate, span);
    if (!(proved > best)) continue;
    best = proved;
    *axis = {n, n_rate, true};
  }
  return best;
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

#include "collision_node/impact/gap_model.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace collision_node::impact {
namespace {

/// max over the core of u . x, with u = u0 + s u1, and the rate of it at the extreme point.
struct Support {
  double value, rate;
};

Support supportValue(const Element& e, const Vec3& u0, const Vec3& u1, double s) {
  const Vec3 u = u0 + s * u1;
  if (e.vertices != nullptr) {
    int best = 0;
    double value = u.dot(e.vertices[0]);
    for (int i = 1; i < e.count; ++i) {
      const double v = u.dot(e.vertices[i]);
      if (v > value) {
        value = v;
        best = i;
      }
    }
    return {value, u1.dot(e.vertices[best])};
  }
  const double along = u.dot(e.axis);
  const Vec3 across = u - along * e.axis;
  const double length = across.norm();
  const double sign = along >= 0.0 ? 1.0 : -1.0;
  Vec3 p = e.centre + sign * e.half_length * e.axis;
  if (length > 0.0) p += (e.rim_radius / length) * across;
  return {u.dot(e.centre) + e.half_length * std::abs(along) + e.rim_radius * length, u1.dot(p)};
}

constexpr double kUp = 1.0 + 64.0 * kUnit;

}  // namespace

GapModel::GapModel(const PairPiece& piece, const Instant& now, const Element& a, const Element& b,
                   const Axis& axis, const CoreReaches& reaches)
    : a_(a), b_(b), direction_(axis.direction), rate_(axis.rate) {
  const RelativeMotion& m = piece.motion;
  const double reach_a = reaches.a * kUp, reach_b = reaches.b * kUp;
  length_ = direction_.norm() * kUp;
  rate_length_ = rate_.norm() * kUp;
  // A: max over a of [n + s (rate + n x omega_a)] . (R_a a); B likewise, its minimum written as a maximum.
  a0_ = now.ra.transpose() * direction_;
  a1_ = now.ra.transpose() * (rate_ + direction_.cross(m.omegaA()));
  b0_ = -(now.rb.transpose() * direction_);
  b1_ = -(now.rb.transpose() * (rate_ + direction_.cross(m.omegaB())));
  constant_ = direction_.dot(now.d);
  linear_ = rate_.dot(now.d) + direction_.dot(now.d_rate);
  grown_ = a.radius + b.radius + piece.contact_distance;
  const double turning = rate_.cross(m.omegaA()).norm() * reach_a + rate_.cross(m.omegaB()).norm() * reach_b;
  square_ = std::max(0.0, turning - rate_.dot(now.d_rate)) * kUp + 8.0 * kUnit * rate_length_ * piece.speed;
  curve_ =
      0.5 * kUp * (m.maxAcceleration() + m.spinA() * m.spinA() * reach_a + m.spinB() * m.spinB() * reach_b);
  point_error_ = piece.point_error;
  rate_error_ = piece.rate_error;
}

GapModel::Value GapModel::at(double s) const {
  const Support a = supportValue(a_, a0_, a1_, s);
  const Support b = supportValue(b_, b0_, b1_, s);
  const double axis_bound = length_ + s * rate_length_;
  double grown = 0.0, grown_rate = 0.0;
  if (grown_ > 0.0) {
    const Vec3 n = direction_ + s * rate_;
    const double length = n.norm();
    grown = grown_ * length;
    grown_rate = length > 0.0 ? grown_ * n.dot(rate_) / length : 0.0;
  }
  const double bend = square_ + curve_ * axis_bound;
  const double budget = axis_bound * (point_error_ + s * rate_error_);
  Value v;
  v.gap = (constant_ + s * linear_) - a.value - b.value - grown - s * s * bend - budget;
  v.slope = linear_ - a.rate - b.rate - grown_rate - 2.0 * s * bend - s * s * curve_ * rate_length_ -
            rate_length_ * (point_error_ + s * rate_error_) - axis_bound * rate_error_;
  return v;
}

Axis axisOf(const PairPiece& piece, const Instant& now, const Closest& closest, bool rounded) {
  Axis axis;
  if (closest.overlap) return axis;
  const RelativeMotion& m = piece.motion;
  Vec3 rate[4];
  for (int i = 0; i < closest.count; ++i) {
    rate[i] = now.d_rate + m.omegaB().cross(now.rb * closest.point[i].local_b) -
              m.omegaA().cross(now.ra * closest.point[i].local_a);
  }
  const double gap = closest.v.norm();
  if (closest.count == 3) {
    // The normal of the three difference points: exact however small the gap is.
    const Vec3 e1 = closest.point[1].w - closest.point[0].w, e2 = closest.point[2].w - closest.point[0].w;
    const Vec3 f1 = rate[1] - rate[0], f2 = rate[2] - rate[0];
    Vec3 n = e1.cross(e2);
    Vec3 n_rate = f1.cross(e2) + e1.cross(f2);
    const double length = n.norm();
    if (length > 1e-13 * e1.norm() * e2.norm()) {
      if (n.dot(closest.v) < 0.0) {
        n = -n;
        n_rate = -n_rate;
      }
      axis.direction = n / length;
      axis.rate = (n_rate - axis.direction * axis.direction.dot(n_rate)) / length;
      axis.valid = true;
      return axis;
    }
  }
  if (!(gap > 0.0)) return axis;
  axis.direction = closest.v / gap;
  axis.valid = true;
  if (closest.count == 2) {
    // Stay perpendicular to the segment between the two points.
    const Vec3 e = closest.point[1].w - closest.point[0].w;
    const double length2 = e.squaredNorm();
    // What rounding left along it would cost its whole length, which may be many times the gap.
    axis.direction -= e * (e.dot(axis.direction) / length2);
    const Vec3 along = e * (-axis.direction.dot(rate[1] - rate[0]) / length2);
    axis.rate = along;
    if (rounded) {
      Vec3 v_rate = closest.weight[0] * rate[0] + closest.weight[1] * rate[1];
      v_rate -= axis.direction * axis.direction.dot(v_rate);
      v_rate -= e * (e.dot(v_rate) / length2);
      axis.rate += v_rate / gap;
    }
  } else if (closest.count == 1 && rounded) {
    axis.rate = (rate[0] - axis.direction * axis.direction.dot(rate[0])) / gap;
  }
  return axis;
}

Axis axisToCylinder(const PairPiece& piece, const Instant& now, const Element& a, const Element& b) {
  const RelativeMotion& m = piece.motion;
  const bool point_is_a = a.vertices != nullptr;
  const Element& cylinder = point_is_a ? b : a;
  const Vec3 xa = now.ra * (point_is_a ? a.vertices[0] : a.centre);
  const Vec3 xb = now.rb * (point_is_a ? b.centre : b.vertices[0]);
  const Vec3 xb_rate = now.d_rate + m.omegaB().cross(xb), xa_rate = m.omegaA().cross(xa);
  const Vec3& omega = point_is_a ? m.omegaB() : m.omegaA();
  const double outward = point_is_a ? -1.0 : 1.0;
  // The point from the cylinder's centre, and its velocity in the cylinder's own turning frame: along the
  // axis u, away from it along r, and around it along e.
  const Vec3 x = (now.d + xb - xa) * outward;
  const Vec3 v = (xb_rate - xa_rate) * outward - omega.cross(x);
  const Vec3 u = (point_is_a ? now.rb : now.ra) * cylinder.axis;
  const double along = u.dot(x);
  const Vec3 across = x - along * u;
  const double distance = across.norm();
  const double above = along - std::clamp(along, -cylinder.half_length, cylinder.half_length);
  const double beside = std::max(0.0, distance - cylinder.rim_radius);
  const double gap = std::hypot(above, beside);
  Axis axis;
  if (!(gap > 0.0)) return axis;
  const Vec3 r = distance > 0.0 ? Vec3(across / distance) : u.unitOrthogonal(), e = u.cross(r);
  const double sine = above / gap, cosine = beside / gap;
  Vec3 n = cosine * r + sine * u, turn = Vec3::Zero();
  if (above != 0.0 && beside > 0.0)  // around the rim
    turn = ((v.dot(u) * cosine - v.dot(r) * sine) / gap) * (cosine * u - sine * r);
  if (beside > 0.0) turn += (cosine * v.dot(e) / distance) * e;
  axis.direction = outward * n;
  axis.rate = outward * (omega.cross(n) + turn);
  axis.valid = true;
  return axis;
}

namespace {

/// Normals made unit, with their rates kept across them. Between cores that are apart every point of B lies
/// beyond every point of A, so any two of them tell which of the two directions can have a gap.
class AxisList {
 public:
  AxisList(const Instant& now, const Element& a, const Element& b)
      : across_(now.d + now.rb * anyPoint(b) - now.ra * anyPoint(a)) {}

  void add(const Vec3& n, const Vec3& n_rate, double scale) {
    const double length = n.norm();
    if (!(length > 1e-14 * scale)) return;
    const double sign = n.dot(across_) < 0.0 ? -1.0 : 1.0;
    Axis axis;
    axis.direction = n * (sign / length);
    axis.rate = (n_rate - n * (n.dot(n_rate) / (length * length))) * (sign / length);
    axis.valid = true;
    axes_.push_back(axis);
  }

  const Axes& all() const { return axes_; }

 private:
  static const Vec3& anyPoint(const Element& e) { return e.vertices == nullptr ? e.centre : e.vertices[0]; }

  Axes axes_;
  Vec3 across_;
};

/// Eight corners in the order of their three signs: three directions of edges stand for all twelve.
bool isBox(const Element& e) {
  if (e.count != 8) return false;
  const Vec3* v = e.vertices;
  const double small = 1e-12 * (v[7] - v[0]).squaredNorm();
  for (const int i : {3, 5, 6, 7}) {
    Vec3 corner = v[0];
    for (const int bit : {1, 2, 4}) {
      if ((i & bit) != 0) corner += v[bit] - v[0];
    }
    if (!((corner - v[i]).squaredNorm() <= small)) return false;
  }
  return true;
}

/// Axis, side normals through the other's vertices, and normals of the axis with the other's edges.
void addCylinderAxes(AxisList& axes, const Element& cylinder, const Mat3& rotation, const Vec3& origin,
                     const Vec3& omega, const Element& other, const Mat3& other_rotation,
                     const Vec3& other_origin, const Vec3& other_omega) {
  const Vec3 axis = rotation * cylinder.axis;
  axes.add(axis, omega.cross(axis), 1.0);
  if (other.vertices == nullptr) {
    const Vec3 second = other_rotation * other.axis;
    axes.add(axis.cross(second), omega.cross(axis).cross(second) + axis.cross(other_omega.cross(second)),
             1.0);
    return;
  }
  if (other.count > 8) return;
  const bool box = isBox(other);
  if (box || other.count == 3) {  // the faces against the rim
    const auto edgeTo = [&](int i) -> Vec3 {
      return other_rotation * (other.vertices[i] - other.vertices[0]);
    };
    for (const int i : {1, 2, 4}) {
      if (!box && i > 1) break;
      const Vec3 n = box ? edgeTo(i) : edgeTo(1).cross(edgeTo(2));
      axes.add(n, other_omega.cross(n), box ? 0.0 : edgeTo(1).norm() * edgeTo(2).norm());
    }
  }
  const Vec3 centre = origin + rotation * cylinder.centre;
  for (int i = 0; i < other.count; ++i) {
    const Vec3 x = other_origin + other_rotation * other.vertices[i] - centre;
    const Vec3 across = x - axis * axis.dot(x);
    axes.add(across, omega.cross(across), x.norm());
    for (int j = 0; j < i; ++j) {
      if (box && (j > 0 || (i != 1 && i != 2 && i != 4))) continue;
      const Vec3 edge = other_rotation * (other.vertices[i] - other.vertices[j]);
      axes.add(axis.cross(edge), omega.cross(axis).cross(edge) + axis.cross(other_omega.cross(edge)),
               edge.norm());
    }
  }
}

}  // namespace

Axes rimAxes(const PairPiece& piece, const Instant& now, const Element& a, const Element& b,
             const Closest& closest) {
  const bool cylinder_is_a = a.vertices == nullptr;
  const Closest nearest = closestOnEdges(Cores(now, a, b), closest);
  if (nearest.count == 0) return {};
  const Element& cylinder = cylinder_is_a ? a : b;
  const Mat3 &rotation = cylinder_is_a ? now.ra : now.rb, &other_rotation = cylinder_is_a ? now.rb : now.ra;
  const RelativeMotion& m = piece.motion;
  const Vec3 &omega = cylinder_is_a ? m.omegaA() : m.omegaB(),
             &other_omega = cylinder_is_a ? m.omegaB() : m.omegaA();
  const auto onCylinder = [&](int i) -> const Vec3& {
    return cylinder_is_a ? nearest.point[i].local_a : nearest.point[i].local_b;
  };
  const auto onOther = [&](int i) -> const Vec3& {
    return cylinder_is_a ? nearest.point[i].local_b : nearest.point[i].local_a;
  };
  const Vec3 arm = onCylinder(0) - cylinder.centre, axis = rotation * cylinder.axis;
  Vec3 radial = rotation * (arm - cylinder.axis * cylinder.axis.dot(arm));
  if (!(radial.norm() > 0.0)) return {};
  radial.normalize();
  AxisList axes(now, a, b);
  // The closest vector, with what rounding left of it across the rim taken away: the rim's point stays
  // extreme.
  const Vec3 wedge = axis * axis.dot(nearest.v) + radial * radial.dot(nearest.v);
  axes.add(wedge, omega.cross(wedge), 0.0);
  if (nearest.count == 2) {
    const Vec3 edge = other_rotation * (onOther(1) - onOther(0)), tangent = axis.cross(radial);
    axes.add(edge.cross(tangent), other_omega.cross(edge).cross(tangent) + edge.cross(omega.cross(tangent)),
             edge.norm());
  }
  return axes.all();
}

Axes featureAxes(const PairPiece& piece, const Instant& now, const Element& a, const Element& b) {
  if (a.vertices != nullptr && b.vertices != nullptr && (a.count > 3 || b.count > 3)) return {};
  AxisList axes(now, a, b);
  if (a.vertices == nullptr || b.vertices == nullptr) {
    const RelativeMotion& motion = piece.motion;
    if (a.vertices == nullptr) {
      addCylinderAxes(axes, a, now.ra, Vec3::Zero(), motion.omegaA(), b, now.rb, now.d, motion.omegaB());
    }
    if (b.vertices == nullptr) {
      addCylinderAxes(axes, b, now.rb, now.d, motion.omegaB(), a, now.ra, Vec3::Zero(), motion.omegaA());
    }
    return axes.all();
  }
  const RelativeMotion& m = piece.motion;
  Vec3 edges_a[3], edges_b[3];
  const int count_a = a.count == 3 ? 3 : a.count - 1, count_b = b.count == 3 ? 3 : b.count - 1;
  for (int i = 0; i < count_a; ++i) edges_a[i] = now.ra * (a.vertices[(i + 1) % a.count] - a.vertices[i]);
  for (int j = 0; j < count_b; ++j) edges_b[j] = now.rb * (b.vertices[(j + 1) % b.count] - b.vertices[j]);
  if (count_a == 3) {
    const Vec3 n = edges_a[0].cross(edges_a[1]);
    axes.add(n, m.omegaA().cross(n), edges_a[0].norm() * edges_a[1].norm());
  }
  if (count_b == 3) {
    const Vec3 n = edges_b[0].cross(edges_b[1]);
    axes.add(n, m.omegaB().cross(n), edges_b[0].norm() * edges_b[1].norm());
  }
  for (int i = 0; i < count_a; ++i) {
    for (int j = 0; j < count_b; ++j) {
      const Vec3 n = edges_a[i].cross(edges_b[j]);
      const Vec3 n_rate =
          m.omegaA().cross(edges_a[i]).cross(edges_b[j]) + edges_a[i].cross(m.omegaB().cross(edges_b[j]));
      axes.add(n, n_rate, edges_a[i].norm() * edges_b[j].norm());
    }
  }
  return axes.all();
}

double apartFor(const GapModel& model, double span, double* gap_now) {
  const GapModel::Value start = model.at(0.0);
  *gap_now = start.gap;
  if (!(start.gap > 0.0) || !(span > 0.0)) return 0.0;
  double low = 0.0, low_gap = start.gap;
  // The parabola of the start's value and slope lies above the concave model: its root bounds ours from
  // above.
  const double bend = model.leastBend(), discriminant = start.slope * start.slope + 4.0 * bend * start.gap;
  const double root = start.slope > 0.0 ? (start.slope + std::sqrt(discriminant)) / (2.0 * bend)
                                        : 2.0 * start.gap / (std::sqrt(discriminant) - start.slope);
  double high = root < span ? root : span;
  GapModel::Value end = model.at(high);
  if (end.gap > 0.0) return high;
  // A pair that recedes: the model rises before it falls, so that a chord from a small gap shows nothing of
  // the time it will last. The parabola with the low end's value and slope and the high end's value does; it
  // only proposes.
  double low_slope = start.slope;
  for (int i = 0; i < 3 && low_slope > 0.0; ++i) {
    const double width = high - low;
    const double bend = (low_gap + low_slope * width - end.gap) / (width * width);
    const double root = (low_slope + std::sqrt(low_slope * low_slope + 4.0 * bend * low_gap)) / (2.0 * bend);
    const double inside = low + 0.999 * root;
    if (!(inside > low && inside < high)) break;
    const GapModel::Value at = model.at(inside);
    if (at.gap > 0.0) {
      low = inside;
      low_gap = at.gap;
      low_slope = at.slope;
    } else {
      high = inside;
      end = at;
    }
  }
  // Tangents from the right close in from above, chords from below; a chord's root is itself proved by
  // evaluation.
  for (int i = 0; i < 6; ++i) {
    const double chord = low + (high - low) * (low_gap / (low_gap - end.gap));
    if (chord > low && chord < high) {
      const GapModel::Value at = model.at(chord);
      if (at.gap > 0.0) {
        low = chord;
        low_gap = at.gap;
      }
    }
    if (low > 0.9 * high) break;
    if (end.slope < 0.0) {
      const double tangent = high - end.gap / end.slope;
      if (tangent > low && tangent < high) {
        high = tangent;
        end = model.at(high);
        if (end.gap > 0.0) return high;
      }
    }
  }
  // A nearly linear model: every root found lies on the zero itself, where the last bit decides. Step inside.
  for (const double inside : {1.0 - 1e-9, 1.0 - 1e-6, 1.0 - 1e-3, 0.5}) {
    if (low > 0.5 * high) break;
    if (model.at(high * inside).gap > 0.0) return high * inside;
  }
  return low;
}

}  // namespace collision_node::impact

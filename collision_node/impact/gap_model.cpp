#include "collision_node/impact/gap_model.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "collision_node/impact/closest_points.h"

namespace collision_node::impact {
namespace {

constexpr double kUp = 1.0 + 64.0 * kUnit;

}  // namespace

/// A core that has axes of its own is placed as exactly as its corners are: within the placing error.
MovingSupport::MovingSupport(const Element& e, const Vec3& u0, const Vec3& u1) {
  if (e.frame == nullptr) {
    hull_ = &e;
    u0_ = u0;
    u1_ = u1;
    return;
  }
  constant_ = u0.dot(e.frame->centre);
  linear_ = u1.dot(e.frame->centre);
  round_ = e.vertices == nullptr;
  half_ = round_ ? Vec3(e.rim_radius, 0.0, e.half_length) : e.frame->half;
  if (e.count == 1) return;  // a point
  u0_ = e.frame->axes.transpose() * u0;
  u1_ = e.frame->axes.transpose() * u1;
}

MovingSupport::Value MovingSupport::at(double s) const {
  const Vec3 u = u0_ + s * u1_;
  if (hull_ != nullptr) {
    int best = 0;
    double value = u.dot(hull_->vertices[0]);
    for (int i = 1; i < hull_->count; ++i) {
      const double v = u.dot(hull_->vertices[i]);
      if (v > value) {
        value = v;
        best = i;
      }
    }
    return {value, u1_.dot(hull_->vertices[best])};
  }
  Value v{constant_ + s * linear_ + half_[2] * std::abs(u[2]),
          linear_ + std::copysign(half_[2], u[2]) * u1_[2]};
  if (round_) {
    const double across = std::sqrt(u[0] * u[0] + u[1] * u[1]);
    v.value += half_[0] * across;
    if (across > 0.0) v.rate += half_[0] * (u[0] * u1_[0] + u[1] * u1_[1]) / across;
  } else {
    v.value += half_[0] * std::abs(u[0]) + half_[1] * std::abs(u[1]);
    v.rate += std::copysign(half_[0], u[0]) * u1_[0] + std::copysign(half_[1], u[1]) * u1_[1];
  }
  return v;
}

double MovingSupport::bend() const {
  const double across2 = u0_[0] * u0_[0] + u0_[1] * u0_[1];
  if (!round_ || !(across2 > 0.0)) return 0.0;
  const double turn = u0_[0] * u1_[1] - u0_[1] * u1_[0];
  return 0.5 * half_[0] * turn * turn / (across2 * std::sqrt(across2));
}

GapModel::GapModel(const PairPiece& piece, const Instant& now, const Element& a, const Element& b,
                   const Axis& axis, const CoreReaches& reaches)
    : direction_(axis.direction),
      rate_(axis.rate),
      // A: max over a of [n + s (rate + n x omega_a)] . (R_a a); B likewise, its minimum written as a
      // maximum.
      a_(a, now.ra.transpose() * direction_,
         now.ra.transpose() * (rate_ + direction_.cross(piece.motion.omegaA()))),
      b_(b, -(now.rb.transpose() * direction_),
         -(now.rb.transpose() * (rate_ + direction_.cross(piece.motion.omegaB())))) {
  const RelativeMotion& m = piece.motion;
  const double reach_a = reaches.a * kUp, reach_b = reaches.b * kUp;
  length_ = direction_.norm() * kUp;
  rate_length_ = rate_.norm() * kUp;
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

double GapModel::bendNow() const {
  const double along = direction_.dot(rate_) / length_;
  const double growing = grown_ * (rate_length_ * rate_length_ - along * along) / length_;
  return leastBend() + a_.bend() + b_.bend() + 0.5 * growing;
}

GapModel::Value GapModel::at(double s) const {
  const MovingSupport::Value a = a_.at(s), b = b_.at(s);
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
  const bool box = other.frame != nullptr && other.count == 8;
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
  // Where the parabola of the start's value, slope and bend comes to zero, if that is before the end.
  const auto rootWith = [&](double bend) {
    const double discriminant = std::sqrt(start.slope * start.slope + 4.0 * bend * start.gap);
    return start.slope > 0.0 ? (start.slope + discriminant) / (2.0 * bend)
                             : 2.0 * start.gap / (discriminant - start.slope);
  };
  // The one with the least bend lies above the concave model: its root bounds ours from above.
  double high = std::min(span, rootWith(model.leastBend()));
  // The one with the present bend is right to second order: a little before its root most steps end.
  const double near = rootWith(model.bendNow()), less = 1e-9 + 0.2 * std::abs(1.0 - near / high);
  if (near < span && less < 0.02) {
    const double trial = near * (1.0 - less);
    if (model.at(trial).gap > 0.0) return trial;
  }
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

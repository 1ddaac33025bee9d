#include "collision_node/motion/relative_motion.h"

#include <algorithm>
#include <cmath>

#include "collision_node/geometry/any_width.h"
#include "collision_node/geometry/rounding.h"
#include "collision_node/geometry/two_sines.h"

namespace collision_node::motion {
namespace {

using geometry::kUnit;
using geometry::kUp;

}  // namespace

void RelativeMotion::setSpins() {
  using geometry::twice;
  using geometry::Two;
  using geometry::TwoMat3;
  using geometry::TwoVec3;
  const Quat &qa = motion_a_.q0, &qb = motion_b_.q0;
  Two w{qa.w(), qb.w()};
  TwoVec3 v(qa.vec(), qb.vec());
  const Two length = geometry::squareRoot(w * w + dot(v, v));
  w /= length;
  v = TwoVec3(v.x / length, v.y / length, v.z / length);
  const TwoVec3 v2 = 2.0 * v, along = w * v2;
  const Two xx = v.x * v2.x, xy = v.x * v2.y, xz = v.x * v2.z, yy = v.y * v2.y, yz = v.y * v2.z,
            zz = v.z * v2.z, one = twice(1.0);
  TwoMat3 r0, across, inward;
  r0.column[0] = {one - (yy + zz), xy + along.z, xz - along.y};
  r0.column[1] = {xy - along.z, one - (xx + zz), yz + along.x};
  r0.column[2] = {xz + along.y, yz - along.x, one - (xx + yy)};
  const TwoVec3 omega(motion_a_.omega, motion_b_.omega);
  const Two rate = norm(omega), safe = rate > 0.0 ? rate : one;
  const TwoVec3 axis(omega.x / safe, omega.y / safe, omega.z / safe);
  for (int i = 0; i < 3; ++i) {
    across.column[i] = cross(axis, r0.column[i]);
    inward.column[i] = cross(axis, across.column[i]);
  }
  r0.split(a_.r0, b_.r0);
  across.split(a_.across, b_.across);
  inward.split(a_.inward, b_.inward);
  const auto set = [&](Spin& spin, const RigidMotion& m, double turning, double offset) {
    spin.omega = m.omega;
    spin.rate = turning;
    spin.spin = (turning + m.rate_error) * kUp;
    spin.offset = offset;
    // 64: quaternion to matrix, Rodrigues' entries, two products, the placing of geometry in the object's
    // frame, and the slerp's rotation vector (absolute part). 16 theta: the angle's relative error, both of
    // omega and of the time.
    spin.error = kUnit * (64.0 + 16.0 * spin.spin * (std::abs(offset) + duration_)) + m.turn_error;
  };
  set(a_, motion_a_, rate[0], offset_a_);
  set(b_, motion_b_, rate[1], offset_b_);
}

RelativeMotion::HalfTurns RelativeMotion::halfTurns(double t) const {
  const geometry::TwoSines of = geometry::sinesOf(geometry::Two{a_.halfAngle(t), b_.halfAngle(t)});
  return {{of.sine[0], of.cosine[0]}, {of.sine[1], of.cosine[1]}};
}

/// Rodrigues: r + sin(x) (k x r) + (1 - cos(x)) k x (k x r), both factors from the half angle.
COLLISION_NODE_ANY_WIDTH
Mat3 RelativeMotion::Spin::at(const HalfTurn& turn) const {
  if (rate == 0.0) return r0;
  return r0 + (2.0 * turn.sine * turn.cosine) * across + (2.0 * turn.sine * turn.sine) * inward;
}

void RelativeMotion::Spin::still() {
  const Vec3 axis = omega / rate;
  r0.col(2) = axis;
  r0.col(0) = axis.unitOrthogonal();
  r0.col(1) = axis.cross(r0.col(0));
  omega.setZero();
  rate = spin = 0.0;
  error = 64.0 * kUnit;
}

RelativeMotion RelativeMotion::stilled(bool a, bool b) const {
  RelativeMotion still = *this;
  if (a) still.a_.still();
  if (b) still.b_.still();
  return still;
}

RelativeMotion::RelativeMotion(const RigidMotion& a, const RigidMotion& b, Nanoseconds start_ns,
                               Nanoseconds end_ns)
    : motion_a_(a), motion_b_(b) {
  const LinearPart line(a, b, start_ns, end_ns);
  duration_ = line.duration;
  offset_a_ = line.offset_a;
  offset_b_ = line.offset_b;
  setSpins();

  d_[0] = line.d;
  d_[1] = line.rate;
  d_[2] = Vec3::Zero();
  d_[3] = Vec3::Zero();
  const double oa = offset_a_, ob = offset_b_, reach = line.reach, line_rate = line.rate.norm();
  const double speed_a = a.c[1].norm(), speed_b = b.c[1].norm();
  const bool straight_a = a.isStraight(), straight_b = b.isStraight();
  // Every term that was rounded, at its largest over both segments' shares of time. What both objects have in
  // common never was, but for the rounding of each one's own coefficients: a line's velocity (difference,
  // duration, quotient), and what a cubic's bend owes to the velocities it is computed from.
  double magnitude = line.magnitude(a, b);
  if (!straight_a || !straight_b) {
    d_[0] += (b.c[2] + b.c[3] * ob) * (ob * ob) - (a.c[2] + a.c[3] * oa) * (oa * oa);
    d_[1] += (2.0 * b.c[2] + 3.0 * b.c[3] * ob) * ob - (2.0 * a.c[2] + 3.0 * a.c[3] * oa) * oa;
    d_[2] = (b.c[2] + 3.0 * b.c[3] * ob) - (a.c[2] + 3.0 * a.c[3] * oa);
    d_[3] = b.c[3] - a.c[3];
    magnitude += (d_[1].norm() - line_rate) * duration_;
    // What rounding made of c_2 grows with the whole segment's bend, however little of it the piece sees.
    const auto bend = [&](const RigidMotion& m, double offset) {
      const double own = std::abs(offset) + duration_;
      const double whole = std::max(own, secondsBetween(m.start_ns, m.end_ns));
      return (m.c[2].norm() + m.c[3].norm() * whole) * (own * own);
    };
    magnitude += 4.0 * (bend(a, oa) + bend(b, ob));
  }
  const auto ownRounding = [&](bool straight, double speed) {
    return (straight ? kLineRounding : 64.0) * kUnit * speed * reach;
  };
  translation_error_ =
      kTermRounding * kUnit * magnitude + ownRounding(straight_a, speed_a) + ownRounding(straight_b, speed_b);

  const auto ownSpeed = [&](const RigidMotion& m, bool straight, double speed, double offset) {
    if (straight) return speed * kUp;
    const double until = std::abs(offset) + duration_;
    return (speed + until * (2.0 * m.c[2].norm() + 3.0 * until * m.c[3].norm())) * kUp;
  };
  own_speed_a_ = ownSpeed(a, straight_a, speed_a, offset_a_);
  own_speed_b_ = ownSpeed(b, straight_b, speed_b, offset_b_);
  world_scale_a_ = a.c[0].norm() + own_speed_a_ * (std::abs(offset_a_) + duration_);
  max_speed_ = line_rate * kUp;
  if (!straight_a || !straight_b) {
    max_acceleration_ = std::max(acceleration(0.0).norm(), acceleration(duration_).norm()) * kUp;
    max_speed_ = (velocity(0.5 * duration_).norm() + 0.5 * duration_ * max_acceleration_) * kUp;
  }
  max_distance_ = std::min(displacement(0.0).norm(), displacement(duration_).norm()) + max_speed_ * duration_;
  max_distance_ *= kUp;
}

}  // namespace collision_node::motion

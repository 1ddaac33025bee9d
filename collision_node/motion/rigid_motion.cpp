#include "collision_node/motion/rigid_motion.h"

#include <algorithm>
#include <cmath>

namespace collision_node::motion {

namespace {

constexpr double kTwoPi = 6.283185307179586;
constexpr double kRoundedTurn =
    1e-14;  // [rad] what rounding two unit quaternions makes of equal orientations

/// The step's quaternion is rounded by 7 u in all, so its axis is off by 7 u / sin(half the angle), and a
/// turn about an axis that is off by delta, by whatever angle, moves a unit vector by 2 delta at most: 14 u
/// of these 32.
constexpr double kAxisError = 0x1p-48;

/// Of the mean rate (3 u), the duration (3 u), the product with the axis (4 u), the angle (8 u) and the
/// quotient (2 u), as shares of what they are added to.
constexpr double kCountError = 0x1p-48;

/// A turn about a unit axis (world axes), 0 <= angle <= pi. The axis is zero when the angle is.
struct Turn {
  Vec3 axis = Vec3::Zero();
  double angle = 0.0;
};

Turn shortestTurn(const Quat& from, const Quat& to) {
  Quat step = from.conjugate() * to;
  if (step.w() < 0.0) step.coeffs() = -step.coeffs();
  if (step.w() == 0.0) {
    // Half a turn either way round is as short: pick one by a rule that does not depend on the inputs' signs.
    for (int i = 0; i < 3; ++i) {
      if (step.vec()[i] == 0.0) continue;
      if (step.vec()[i] < 0.0) step.coeffs() = -step.coeffs();
      break;
    }
  }
  const double sine = step.vec().stableNorm();
  if (sine == 0.0) return {};
  return {from * (step.vec() / sine), 2.0 * std::atan2(sine, step.w())};
}

RigidMotion straightLine(const StampedPose& from, const StampedPose& to) {
  RigidMotion motion;
  motion.start_ns = from.stamp_ns;
  motion.end_ns = to.stamp_ns;
  motion.c[0] = from.pose.position;
  motion.c[1] = (to.pose.position - from.pose.position) / secondsBetween(from.stamp_ns, to.stamp_ns);
  motion.q0 = from.pose.orientation;
  return motion;
}

}  // namespace

Pose RigidMotion::at(double s) const {
  const double half = 0.5 * omega.norm() * s;
  return at(s, std::sin(half), std::cos(half));
}

Pose RigidMotion::at(double s, double sine, double cosine) const {
  Pose pose;
  pose.position = positionAt(s);
  pose.orientation = q0;
  const double rate = omega.norm();  // 0 for what is too slow for its square to be seen
  if (rate > 0.0) {
    Quat turn;
    turn.w() = cosine;
    turn.vec() = sine * (omega / rate);
    pose.orientation = (turn * q0).normalized();
  }
  return pose;
}

RigidMotion fixedAt(const Pose& pose) {
  RigidMotion motion;
  motion.fixed = true;
  motion.c[0] = pose.position;
  motion.q0 = pose.orientation;
  return motion;
}

void pathHull(const RigidMotion& motion, Vec3 (&points)[4]) {
  const double h = motion.fixed ? 0.0 : secondsBetween(motion.start_ns, motion.end_ns);
  const Vec3 first = motion.c[1] * h, second = motion.c[2] * (h * h), third = motion.c[3] * (h * h * h);
  points[0] = motion.c[0];
  points[3] = motion.c[0] + first + second + third;
  const bool is_straight = second.isZero(0.0) && third.isZero(0.0);
  points[1] = is_straight ? points[0] : motion.c[0] + first / 3.0;
  points[2] = is_straight ? points[3] : motion.c[0] + (2.0 * first + second) / 3.0;
}

double pathLength(const RigidMotion& motion) {
  const double h = motion.fixed ? 0.0 : secondsBetween(motion.start_ns, motion.end_ns);
  const Vec3 first = motion.c[1] * h, second = motion.c[2] * (h * h), third = motion.c[3] * (h * h * h);
  if (second.isZero(0.0) && third.isZero(0.0)) return first.norm();
  return (first.norm() + (first + second).norm() + (first + 2.0 * second + 3.0 * third).norm()) / 3.0;
}

RigidMotion straightSlerp(const StampedPose& from, const StampedPose& to) {
  RigidMotion motion = straightLine(from, to);
  const Turn turn = shortestTurn(from.pose.orientation, to.pose.orientation);
  motion.omega = turn.axis * (turn.angle / secondsBetween(from.stamp_ns, to.stamp_ns));
  return motion;
}

RigidMotion hermite(const StampedPose& from, const StampedPose& to) {
  RigidMotion motion = straightSlerp(from, to);
  const double h = secondsBetween(from.stamp_ns, to.stamp_ns);
  const Vec3 mean = motion.c[1];
  motion.c[1] = from.linear;
  motion.c[2] = (3.0 * mean - 2.0 * from.linear - to.linear) / h;
  motion.c[3] = (from.linear + to.linear - 2.0 * mean) / (h * h);
  return motion;
}

RigidMotion spin(const StampedPose& from, const StampedPose& to) {
  RigidMotion motion = straightLine(from, to);
  const double h = secondsBetween(from.stamp_ns, to.stamp_ns);
  const Vec3 mean_rate = 0.5 * (from.angular + to.angular);
  Turn turn = shortestTurn(from.pose.orientation, to.pose.orientation);
  if (turn.angle <= kRoundedTurn && mean_rate.stableNorm() > 0.0) turn.axis = mean_rate.stableNormalized();
  const double axis_error = turn.angle > kRoundedTurn ? kAxisError / std::sin(0.5 * turn.angle) : 0.0;
  const double along = h * turn.axis.dot(mean_rate), extra = (along - turn.angle) / kTwoPi;
  const double turns = std::round(extra);
  motion.omega = turn.axis * ((turn.angle + kTwoPi * turns) / h);
  // Where the axis, or rounding, may have made it another number of turns, nothing is known of the way. Of an
  // axis off by delta the mean rate's part along it is off by delta of its part across and delta^2 of its
  // whole.
  const double off = 0.5 * axis_error, whole = h * mean_rate.norm();
  const double across = (h * mean_rate - along * turn.axis).norm();
  const double unsure = off * (across + off * whole) + kCountError * (whole + kTwoPi);
  if (!(std::abs(extra - turns) + unsure / kTwoPi < 0.5)) {
    motion.turn_error = 2.0;
    motion.rate_error = (kTwoPi + unsure) / h;  // one turn, and as many as `unsure` holds
  } else if (turns != 0.0) {
    motion.turn_error = std::min(2.0, axis_error);
  }
  return motion;
}

}  // namespace collision_node::motion

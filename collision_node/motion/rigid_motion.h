/// One object's motion over one segment: position a polynomial, orientation a constant rate about a fixed
/// axis.
#pragma once

#include <cstdint>
#include <cstring>

#include "collision_node/motion/stamped_pose.h"

namespace collision_node::motion {

/// Are all of these zero, of either sign? Without a branch for each; NaN is not zero.
inline bool areZero(const double* numbers, int count) {
  std::uint64_t all = 0;
  for (int i = 0; i < count; ++i) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, numbers + i, sizeof bits);
    all |= bits;
  }
  return all << 1 == 0;
}

/// s = seconds since start_ns:  p(s) = c[0] + c[1] s + c[2] s^2 + c[3] s^3,  q(s) = exp(omega s) q0  (world
/// axes). `c[0]` and `q0` are the segment's first pose, unrounded. A fixed object has stamps 0 and only c[0],
/// q0.
struct RigidMotion {
  Nanoseconds start_ns = 0;  ///< stamp of the segment's first pose
  Nanoseconds end_ns = 0;    ///< stamp of its second pose
  bool fixed = false;
  Vec3 c[4] = {Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};  ///< [m], [m/s], [m/s^2], [m/s^3]
  Quat q0 = Quat::Identity();
  Vec3 omega = Vec3::Zero();  ///< [rad/s]
  double turn_error = 0.0;    ///< [rad] what rounding may have made of the axis of several turns; see spin()
  double rate_error = 0.0;    ///< [rad/s] and of their number: how much faster it may turn

  /// world <- object at `s` seconds after start_ns; plain double evaluation, for reports, not for proofs.
  Pose at(double s) const;
  /// The same, where sine and cosine of half the angle of the turn are known.
  Pose at(double s, double sine, double cosine) const;
  Vec3 positionAt(double s) const { return c[0] + s * (c[1] + s * (c[2] + s * c[3])); }
  Vec3 velocity(double s) const { return c[1] + s * (2.0 * c[2] + 3.0 * s * c[3]); }
  bool isStraight() const { return areZero(c[2].data(), 3) && areZero(c[3].data(), 3); }  ///< and uniform
  bool turns() const { return !areZero(omega.data(), 3) || turn_error > 0.0; }            ///< or may turn
};

RigidMotion fixedAt(const Pose& pose);

/// A hull of the whole path of the origin: the Bezier points of its cubic, or both ends of a straight line
/// twice. Plain double evaluation: a few roundings of the largest term. [m]
void pathHull(const RigidMotion& motion, Vec3 (&points)[4]);

/// At least the length of the origin's path, up to a few roundings of the largest term: that of the hull's
/// edges. [m]
double pathLength(const RigidMotion& motion);

/// What tf2 does: straight line and shortest-arc slerp at constant rate. Requires from.stamp_ns <
/// to.stamp_ns. The angle comes from atan2 (tf2's acos loses steps under 2e-8 rad). At exactly half a turn
/// the arc is the one whose quaternion product from.conj * to has its first non-zero component positive after
/// w >= 0 is enforced.
RigidMotion straightSlerp(const StampedPose& from, const StampedPose& to);

/// The cubic through both positions with both linear velocities at its ends; orientation as in straightSlerp.
/// Requires from.stamp_ns < to.stamp_ns and a twist on both.
RigidMotion hermite(const StampedPose& from, const StampedPose& to);

/// Straight line; orientation about the slerp axis with as many extra whole turns as the mean twist says.
/// When the two orientations are equal up to rounding the axis is that of the mean twist. Where they are
/// nearly equal, their quaternions tell the axis badly, and `turn_error` says how badly: 2^-48 / sin(half the
/// angle); 2, which is anywhere, where that may make it another number of turns. Requires from.stamp_ns <
/// to.stamp_ns and a twist on both.
RigidMotion spin(const StampedPose& from, const StampedPose& to);

}  // namespace collision_node::motion

/// Both objects' motion on one piece, differences first: world axes, origin at object A's origin.
#pragma once

#include <algorithm>
#include <cmath>

#include "collision_node/motion/rigid_motion.h"

namespace collision_node::motion {

/// What the linear parts of two motions make of B's origin minus A's on a piece: d + t rate, world axes.
/// Written so that equal positions and equal velocities cancel before anything rounds.
struct LinearPart {
  LinearPart(const RigidMotion& a, const RigidMotion& b, Nanoseconds start_ns, Nanoseconds end_ns)
      : duration(secondsBetween(start_ns, end_ns)),
        offset_a(a.fixed ? 0.0 : secondsBetween(a.start_ns, start_ns)),
        offset_b(b.fixed ? 0.0 : secondsBetween(b.start_ns, start_ns)),
        shift(a.fixed || b.fixed ? offset_b - offset_a : secondsBetween(b.start_ns, a.start_ns)),
        reach(std::max(std::abs(offset_a), std::abs(offset_b)) + duration),
        rate(b.c[1] - a.c[1]) {
    // B's polynomial about its own offset minus A's about its own, written so that equal velocities cancel
    // exactly: c_b o_b - c_a o_a = (c_b - c_a) o_b + c_a (o_b - o_a), with o_b - o_a from integers.
    d = (b.c[0] - a.c[0]) + (rate * offset_b + a.c[1] * shift);
  }

  double duration;            ///< [s]
  double offset_a, offset_b;  ///< [s] from each segment's start to the piece's
  double shift;               ///< [s] offset_b - offset_a
  double reach;               ///< [s] the largest power of time in any term
  Vec3 rate, d;               ///< [m/s], [m]

  /// [m] sum of the sizes of all terms that were rounded, at any time of the piece
  double magnitude(const RigidMotion& a, const RigidMotion& b) const {
    return (b.c[0] - a.c[0]).norm() + 2.0 * rate.norm() * reach + a.c[1].norm() * std::abs(shift);
  }
};

/// Of a straight line's own velocity (difference, duration, quotient), in units of 2^-53 |c_1| reach.
constexpr double kLineRounding = 4.0;
constexpr double kTermRounding = 32.0;  ///< of LinearPart, in units of 2^-53 magnitude

/// t = seconds from the piece's start, 0 <= t <= duration.
///   a point x of A is at  R_a(t) x,   a point y of B at  d(t) + R_b(t) y      (world axes, relative to A's
///   origin).
/// No absolute world coordinate enters anything but worldOriginOfA(), so a common offset or a common velocity
/// cancels before it can round.
///
/// Errors (derivation: docs/solver.md, "Rounding budget"), for every t in [0, duration]:
///   |computed d - exact d| <= translationError(),   |computed R y - exact R y| <= rotationError*() |y|.
class RelativeMotion {
 public:
  RelativeMotion(const RigidMotion& a, const RigidMotion& b, Nanoseconds start_ns, Nanoseconds end_ns);

  /// The same paths of the origins; a body marked so does not turn, and its frame's z axis lies along its
  /// spin.
  RelativeMotion stilled(bool a, bool b) const;

  double duration() const { return duration_; }
  Vec3 displacement(double t) const { return d_[0] + t * (d_[1] + t * (d_[2] + t * d_[3])); }
  Vec3 velocity(double t) const { return d_[1] + t * (2.0 * d_[2] + 3.0 * t * d_[3]); }
  Vec3 acceleration(double t) const { return 2.0 * d_[2] + 6.0 * t * d_[3]; }
  double jerk() const { return 6.0 * d_[3].norm(); }
  /// Sine and cosine of half the angle a body has turned by since its segment began.
  struct HalfTurn {
    double sine, cosine;
  };
  struct HalfTurns {
    HalfTurn a, b;
  };
  HalfTurns halfTurns(double t) const;
  Mat3 rotationA(const HalfTurn& turn) const { return a_.at(turn); }
  Mat3 rotationB(const HalfTurn& turn) const { return b_.at(turn); }
  Mat3 rotationA(double t) const { return rotationA(halfTurns(t).a); }
  Mat3 rotationB(double t) const { return rotationB(halfTurns(t).b); }
  const Vec3& omegaA() const { return a_.omega; }
  const Vec3& omegaB() const { return b_.omega; }
  /// At least |omega|, also of the exact motion where rounding may have miscounted its turns. [rad/s]
  double spinA() const { return a_.spin; }
  double spinB() const { return b_.spin; }

  /// sup |d'| and sup |d''| over the piece.
  double maxSpeed() const { return max_speed_; }
  double maxAcceleration() const { return max_acceleration_; }
  double maxDistance() const { return max_distance_; }  ///< sup |d|
  double translationError() const { return translation_error_; }
  double rotationErrorA() const { return a_.error; }
  double rotationErrorB() const { return b_.error; }
  /// What of it is no rounding: RigidMotion::turn_error.
  double turnErrorA() const { return motion_a_.turn_error; }
  double turnErrorB() const { return motion_b_.turn_error; }

  /// sup of the speed of each object's own origin in the world, over the piece [m/s].
  double ownSpeedA() const { return own_speed_a_; }
  double ownSpeedB() const { return own_speed_b_; }
  /// Bounds every term of A's position in the world [m].
  double worldScaleA() const { return world_scale_a_; }

  /// For reports only: poses in the world.
  Pose poseA(double t, const HalfTurn& turn) const {
    return motion_a_.at(offset_a_ + t, turn.sine, turn.cosine);
  }
  Pose poseB(double t, const HalfTurn& turn) const {
    return motion_b_.at(offset_b_ + t, turn.sine, turn.cosine);
  }
  Vec3 originOfA(double t) const { return motion_a_.positionAt(offset_a_ + t); }

 private:
  struct Spin {
    Mat3 r0 = Mat3::Identity();
    Vec3 omega = Vec3::Zero();
    Mat3 across = Mat3::Zero(), inward = Mat3::Zero();  ///< k x R0 and k x (k x R0), k the unit axis
    double rate = 0.0;                                  ///< |omega|
    double spin = 0.0;                                  ///< at least that, rounded up
    double offset = 0.0;                                ///< seconds from the segment's start to the piece's
    double error = 0.0;

    void still();
    double halfAngle(double t) const { return 0.5 * (rate * (offset + t)); }
    Mat3 at(const HalfTurn& turn) const;
  };

  /// Of both motions, side by side.
  void setSpins();

  RigidMotion motion_a_, motion_b_;
  double duration_ = 0.0, offset_a_ = 0.0, offset_b_ = 0.0;
  Vec3 d_[4];
  Spin a_, b_;
  double max_speed_ = 0.0, max_acceleration_ = 0.0, max_distance_ = 0.0, translation_error_ = 0.0;
  double own_speed_a_ = 0.0, own_speed_b_ = 0.0, world_scale_a_ = 0.0;
};

}  // namespace collision_node::motion

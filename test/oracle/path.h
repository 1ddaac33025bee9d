/// Where both objects are, relative to one common point, at t seconds after a piece began.
#pragma once

#include "collision_node/motion/rigid_motion.h"
#include "test/oracle/vec.h"

namespace oracle {

using collision_node::motion::Nanoseconds;
using collision_node::motion::RigidMotion;

/// An object's pose and material velocity field: x(p) = rotation p + position, x' = velocity + omega x
/// (rotation p).
struct Frame {
  M3 rotation;
  V3 position;
  V3 velocity;
  V3 omega;

  V3 place(const V3& p) const { return rotation * p + position; }
  V3 velocityAt(const V3& world) const { return velocity + cross(omega, world - position); }
};

/// One object's motion, its polynomial re-expanded about the piece's start. Positions leave out a common
/// world point `origin` that is subtracted before anything else, so a world offset of 1e8 m costs no
/// accuracy.
class Path {
 public:
  Path(const RigidMotion& motion, Nanoseconds piece_start_ns, const V3& origin)
      : rotation0_(rotationOf(motion.q0)) {
    const Real s = motion.fixed ? 0 : static_cast<Real>(piece_start_ns - motion.start_ns) / 1e9L;
    const V3 c1 = exact(motion.c[1]), c2 = exact(motion.c[2]), c3 = exact(motion.c[3]);
    start_ = s;
    coefficient_[0] = (exact(motion.c[0]) - origin) + s * (c1 + s * (c2 + s * c3));
    coefficient_[1] = c1 + s * (2 * c2 + 3 * s * c3);
    coefficient_[2] = c2 + 3 * s * c3;
    coefficient_[3] = c3;
    omega_ = exact(motion.omega);
    if (motion.fixed) {
      coefficient_[0] = exact(motion.c[0]) - origin;
      coefficient_[1] = coefficient_[2] = coefficient_[3] = omega_ = V3{};
    }
  }

  Frame at(Real t) const {
    Frame frame;
    frame.position = coefficient_[0] + t * (coefficient_[1] + t * (coefficient_[2] + t * coefficient_[3]));
    frame.velocity = coefficient_[1] + t * (2 * coefficient_[2] + 3 * t * coefficient_[3]);
    frame.omega = omega_;
    frame.rotation = rotationBy((start_ + t) * omega_) * rotation0_;
    return frame;
  }

  const V3& coefficient(int k) const { return coefficient_[k]; }
  Real spin() const { return norm(omega_); }
  /// The largest angle from the segment's first pose, until `duration` after the piece's start. [rad]
  Real turn(Real duration) const { return norm(omega_) * (start_ + duration); }
  void shift(const V3& by) { coefficient_[0] = coefficient_[0] + by; }

 private:
  M3 rotation0_;
  V3 coefficient_[4];
  V3 omega_;
  Real start_ = 0;
};

/// Upper bound of |v_b - v_a| of the objects' origins over t in [0, duration].
inline Real speedBound(const Path& a, const Path& b, Real duration) {
  Real bound = 0, power = 1;
  for (int k = 1; k < 4; ++k, power *= duration)
    bound += k * power * norm(b.coefficient(k) - a.coefficient(k));
  return bound;
}

/// Upper bound of |v_b' - v_a'| of the objects' origins over t in [0, duration].
inline Real accelerationBound(const Path& a, const Path& b, Real duration) {
  return 2 * norm(b.coefficient(2) - a.coefficient(2)) +
         6 * duration * norm(b.coefficient(3) - a.coefficient(3));
}

}  // namespace oracle

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
/// accuracy. Coefficients are made in 113 bits, so that the difference of two paths keeps 64.
class Path {
 public:
  Path(const RigidMotion& motion, Nanoseconds piece_start_ns, const V3& origin)
      : rotation0_(rotationOf(motion.q0)) {
    const Wide s = motion.fixed ? 0 : static_cast<Wide>(piece_start_ns - motion.start_ns) / 1000000000;
    const Real from[3] = {origin.x, origin.y, origin.z};
    start_ = static_cast<Real>(s);
    for (int i = 0; i < 3; ++i) {
      Wide c[4];
      for (int k = 0; k < 4; ++k) c[k] = motion.fixed && k > 0 ? 0.0 : motion.c[k][i];
      wide_[0][i] = (c[0] - from[i]) + s * (c[1] + s * (c[2] + s * c[3]));
      wide_[1][i] = c[1] + s * (2 * c[2] + 3 * s * c[3]);
      wide_[2][i] = c[2] + 3 * s * c[3];
      wide_[3][i] = c[3];
    }
    if (!motion.fixed) omega_ = exact(motion.omega);
    narrow();
  }

  Frame at(Real t) const {
    Frame frame;
    frame.position = coefficient_[0] + t * (coefficient_[1] + t * (coefficient_[2] + t * coefficient_[3]));
    frame.velocity = coefficient_[1] + t * (2 * coefficient_[2] + 3 * t * coefficient_[3]);
    frame.omega = omega_;
    frame.rotation = rotationBy((start_ + t) * omega_) * rotation0_;
    return frame;
  }

  /// Positions and velocities less those of the other object's origin; turning as before.
  Path relativeTo(const Path& other) const {
    Path path = *this;
    for (int k = 0; k < 4; ++k)
      for (int i = 0; i < 3; ++i) path.wide_[k][i] -= other.wide_[k][i];
    path.narrow();
    return path;
  }

  void shift(const V3& by) {
    wide_[0][0] += by.x, wide_[0][1] += by.y, wide_[0][2] += by.z;
    narrow();
  }

  const V3& coefficient(int k) const { return coefficient_[k]; }
  Real spin() const { return norm(omega_); }
  /// The largest angle from the segment's first pose, until `duration` after the piece's start. [rad]
  Real turn(Real duration) const { return norm(omega_) * (start_ + duration); }

 private:
  using Wide = __float128;

  void narrow() {
    for (int k = 0; k < 4; ++k) {
      coefficient_[k] = {static_cast<Real>(wide_[k][0]), static_cast<Real>(wide_[k][1]),
                         static_cast<Real>(wide_[k][2])};
    }
  }

  M3 rotation0_;
  Wide wide_[4][3];
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

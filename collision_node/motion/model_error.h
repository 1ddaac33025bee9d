/// How far a body that obeys bounds of its acceleration may be from the motion model between two poses.
///
/// Guarantee: a true motion that has both poses at their stamps and obeys the bounds all the way between them
/// stays within these errors of the model. NaN: nothing is guaranteed. Derivations: docs/model_error.md.
#pragma once

#include <limits>

#include "collision_node/motion/stamped_pose.h"

namespace collision_node::motion {

/// What the user knows of an object. NaN: not asked, the motion model is taken at its word.
struct MotionBounds {
  double acceleration = std::numeric_limits<double>::quiet_NaN();          ///< [m/s^2] of the object's origin
  double angular_acceleration = std::numeric_limits<double>::quiet_NaN();  ///< [rad/s^2]
  double max_spin = std::numeric_limits<double>::infinity();               ///< [rad/s]

  bool areAsked() const {
    return acceleration == acceleration || angular_acceleration == angular_acceleration;
  }
};

/// The tube around a model motion.
struct ModelError {
  bool asked = false;     ///< somebody stated a bound; else both are 0
  double position = 0.0;  ///< [m] of the object's origin; NaN: no bound
  double angle = 0.0;     ///< [rad] NaN: no bound
};

/// Somebody asked, and nothing is known.
inline ModelError unknownError() {
  constexpr double kNoBound = std::numeric_limits<double>::quiet_NaN();
  return {true, kNoBound, kNoBound};
}

/// Straight line through two positions, h seconds apart: a h^2 / 8.
double straightError(double acceleration, double h);

/// The cubic through two positions and velocities: a h^2 / 16. NaN when no motion within the bound has all
/// four.
double cubicError(double acceleration, const StampedPose& from, const StampedPose& to);

/// Slerp through two orientations. NaN unless max_spin h < pi: beyond that nobody knows which way the body
/// turned.
double slerpError(double angular_acceleration, double max_spin, double h);

/// True when a body may turn by half a turn or more in h seconds.
bool mayAlias(double max_spin, double h);

}  // namespace collision_node::motion

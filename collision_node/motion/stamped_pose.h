/// One object's pose at one stamp, as a source delivered it.
#pragma once

#include <cstdint>
#include <limits>

#include "collision_node/geometry/types.h"

namespace collision_node::motion {

using geometry::Mat3;
using geometry::Pose;
using geometry::Quat;
using geometry::Vec3;

/// Integer time [ns]. A double that holds an epoch stamp steps by 0.24 us, half a millimetre at 2000 m/s.
using Nanoseconds = std::int64_t;

/// Exact difference first; then within 3 units of 2^-53. [s]
inline double secondsBetween(Nanoseconds from, Nanoseconds to) {
  return static_cast<double>(to - from) * 1e-9;
}

struct StampedPose {
  Nanoseconds stamp_ns = 0;
  Pose pose;                    ///< world <- object; unit quaternion
  bool has_twist = false;       ///< the two below are meant
  Vec3 linear = Vec3::Zero();   ///< velocity of the object's origin, world axes [m/s]
  Vec3 angular = Vec3::Zero();  ///< rate, world axes [rad/s]
  /// Of a joint that turns: its position, which counts whole turns. NaN: not known. [rad]
  double turned = std::numeric_limits<double>::quiet_NaN();
  // How far the source's own path may be from the motion model on the segment that ends at this pose, when
  // the source composed this pose from others. Infinite: no bound is known.
  double model_position = 0.0;  ///< at the object's origin [m]
  double model_angle = 0.0;     ///< [rad]
  bool comes_ahead = false;     ///< of a track that is sent as a whole, ahead of its time
  bool begins_anew = false;     ///< nothing is known of the way here
  bool may_alias = false;       ///< on that segment nobody can tell which way round the source turned
};

/// What a source's numbers are good for. Quaternions with | |q|^2 - 1 | >= 1e-2, NaN, Inf and components
/// beyond 1e15 (as good as infinite) are refused.
enum class PoseFault { kNone, kNotFinite, kQuaternion };

/// Checks `pose` and makes its quaternion unit.
PoseFault checkAndNormalise(StampedPose& pose);

}  // namespace collision_node::motion

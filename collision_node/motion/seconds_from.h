/// Times of bounds, counted from another stamp.
#pragma once

#include <cmath>

#include "collision_node/motion/stamped_pose.h"

namespace collision_node::motion {

/// `seconds` after `to`, counted from `from`, never on the other side of the exact sum than `towards`, an
/// infinity. The number of nanoseconds, 1e-9 and their product are rounded, 3 units of 2^-53, and what is
/// added here, below one more; of these 8. The last sum is off by half a step.
inline double secondsFrom(Nanoseconds from, Nanoseconds to, double seconds, double towards) {
  if (from == to) return seconds;
  const double shift = secondsBetween(from, to);
  return std::nextafter(shift + std::copysign(0x1p-50 * shift, towards) + seconds, towards);
}

}  // namespace collision_node::motion

/// A point in time, exact: integer nanoseconds and what is left. For ordering, never for arithmetic.
#pragma once

#include "collision_node/motion/stamped_pose.h"

namespace collision_node::scene {

using motion::Nanoseconds;

/// ns + (part + rest) nanoseconds, 0 <= part + rest < 1, |rest| at most half an ulp of part. Compares
/// exactly.
struct Instant {
  Nanoseconds ns = 0;
  double part = 0.0;
  double rest = 0.0;
};

/// The instant `seconds` after `start_ns`, without any rounding of the sum. |seconds| < 2^22 (48 days).
Instant instantAt(Nanoseconds start_ns, double seconds);

/// A whole stamp.
inline Instant instantAt(Nanoseconds stamp_ns) { return {stamp_ns, 0.0, 0.0}; }

inline bool operator<(const Instant& l, const Instant& r) {
  if (l.ns != r.ns) return l.ns < r.ns;
  if (l.part != r.part) return l.part < r.part;
  return l.rest < r.rest;
}
inline bool operator==(const Instant& l, const Instant& r) {
  return l.ns == r.ns && l.part == r.part && l.rest == r.rest;
}

/// A whole number of nanoseconds from what a user wrote in seconds; far beyond any stamp for infinity.
Nanoseconds toNanoseconds(double seconds);

}  // namespace collision_node::scene

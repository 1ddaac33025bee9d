/// Motions chained through several frames, and how far the chain strays from a straight line and slerp
/// between its own end poses.
///
/// Guarantee: `slerpDeviation` bounds the difference, rounding included, for every instant between the two
/// stamps. Derivation: docs/sources.md.
#pragma once

#include <vector>

#include "collision_node/motion/rigid_motion.h"

namespace collision_node::motion {

/// One transform of a chain, parent <- child, or child <- parent when `inverse`.
struct ChainPart {
  RigidMotion
      motion;  ///< position linear (c[2] = c[3] = 0) and constant rate; `fixed` for a static transform
  bool inverse = false;  ///< walked from child to parent
  Pose from, to;         ///< the motion's own poses (not inverted) at the two stamps asked about
};

/// A part's share of the chain where its own pose is `pose`.
inline Pose walked(const Pose& pose, bool inverse) { return inverse ? pose.inverse() : pose; }

struct Deviation {
  double position = 0.0;  ///< [m] at the origin of the last frame
  double angle = 0.0;     ///< [rad], at most pi
};

/// How far the composition of `parts`, first part outermost, is from the straight line and shortest-arc slerp
/// between its values at `from` and `to`, at any instant between two stamps `seconds` > 0 apart. Zero when
/// there is one moving part, nothing after it turns into an arc, and nothing before it moves. Cost: linear in
/// the parts.
Deviation slerpDeviation(const std::vector<ChainPart>& parts, double seconds);

}  // namespace collision_node::motion

/// Trials in which a body turns, or its path bends.
#pragma once

#include "collision_node/report/made_meshes.h"
#include "collision_node/report/random.h"
#include "collision_node/report/stability/group.h"

namespace collision_node::report {

/// Group "bar and ball": a bar (capsule, 2 m between its caps, 5 cm thick) at rest turns about its middle at
/// `spin` [rad/s] towards a ball at rest; each second ball lies 5 mm beyond the bar's reach.
Group barAndBall(double spin, motion::Nanoseconds step_ns, int count, Random& random);

/// Group "spinning fall": a closed mesh within 2 m of its origin that spins at `spin` about the normal of a
/// face on which it falls at `fall` [m/s]; each second one ends 10 % of its path above it.
Group spinningFall(const MeshPtr& mesh, double spin, double fall, motion::Nanoseconds step_ns, int count,
                   Random& random);

/// Group "slow approach": a ball nears the ring that the turning bar's tips describe at `approach` [m/s]; the
/// bar hits it at its first turn that reaches so far. Each second ball stops 1e-6 m before the ring.
Group slowApproach(double spin, double approach, motion::Nanoseconds step_ns, int count, Random& random);

/// Group "arm": a mesh at the end of an arm of `length` [m], its tip at 100 m/s, swings against a face; each
/// second one stops 10 % of its way before it.
Group longArm(double length, int count, Random& random);

/// Group "reversal": a ball above a face on a cubic path whose acceleration, `most` [m/s^2] at both ends,
/// reverses in the middle: down, up, down, back at its height. The lowest point of the first dip is under the
/// contact by 30 % of the dip, or 1e-3 of it; or 1e-3 above it.
Group reversal(double most, motion::Nanoseconds step_ns, int count, Random& random);

}  // namespace collision_node::report

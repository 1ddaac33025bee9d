/// Trials that touch at a closing speed near nothing.
#pragma once

#include "collision_node/report/random.h"
#include "collision_node/report/stability/group.h"

namespace collision_node::report {

/// [m] and [m/s]: what the flights of both groups have in common.
constexpr double kGrazeReach = 1.0, kGrazeSpeed = 10.0;

/// Group "ball, ball": two balls of 0.5 m, one flies past the other at kGrazeSpeed so that they touch with a
/// closing speed of `share` of it; each second pair stays apart by as much as the first one's balls overlap.
/// A share of 0: along the axes, exactly tangent.
Group grazingBalls(double share, int count, Random& random);

/// Group "ball, edge": a ball of kGrazeReach past the edge of a cube.
Group grazingEdge(double share, int count, Random& random);

}  // namespace collision_node::report

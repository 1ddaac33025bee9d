/// What a pair that cannot move against each other is asked on: two fixed objects, or two links of a rigid
/// one.
#pragma once

#include <optional>

#include "collision_node/scene/tracks/pieces.h"
#include "collision_node/scene/tracks/time_line.h"

namespace collision_node::scene {

/// One nanosecond at rest. Two fixed objects: at the epoch's first stamp, or at 0 when no pose has come at
/// all. One moving object (a == b): at its first pose, wherever that is; nothing while there is none.
std::optional<Step> firstRest(const TimeLine& time_line, int a, int b);

/// At rest from `start_ns` to the epoch's newest stamp; one moving object at its newest pose, and up to it.
/// The piece is empty when no stamp is newer than its start. Requires that firstRest gave a step in this
/// epoch.
Step lastRest(const TimeLine& time_line, int a, int b, Nanoseconds start_ns);

}  // namespace collision_node::scene

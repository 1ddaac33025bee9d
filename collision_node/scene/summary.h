/// The counts of a heartbeat.
#pragma once

#include <vector>

#include "collision_node/scene/engine.h"
#include "collision_node/scene/pair_watch.h"
#include "collision_node/scene/time_line.h"

namespace collision_node::scene {

/// True when the track's object is known to be somewhere right now: "clear" may speak of it.
bool isCovered(const Track& track);

/// True when the object was waited for in vain, or dropped.
bool isMissed(const Track& track);

/// Puts every watched pair into exactly one bin by its worst answer, or among the uncovered.
void countPairs(const std::vector<PairWatch>& watches, const TimeLine& time_line, Stats& stats);

/// Sums up what became of the poses, and names the objects that are missed or `had_hole`, by object.
void countInputs(const Scene& scene, const TimeLine& time_line, const std::vector<char>& had_hole,
                 Stats& stats);

}  // namespace collision_node::scene

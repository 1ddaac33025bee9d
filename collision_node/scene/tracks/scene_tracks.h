/// From a scene to the tracks of its objects.
#pragma once

#include <vector>

#include "collision_node/scene/scene.h"
#include "collision_node/scene/tracks/track.h"

namespace collision_node::scene {

/// One track per object, in the scene's order; of an object in no watched pair, one that stands. Throws
/// std::invalid_argument when the scene asks for what the engine cannot do: one line, file and key, value,
/// what would be right.
std::vector<Track> makeTracks(const Scene& scene);

}  // namespace collision_node::scene

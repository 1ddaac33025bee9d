/// Where an object's poses come from, as its entry in a scene file says.
#pragma once

#include <string>
#include <vector>

#include "collision_node/scene/file/map_reader.h"

namespace collision_node::scene {

/// `whole`, with its links read, gets its source from the keys `pose` and `joints`. Returns it, or, when its
/// links move by themselves (`links: true`, `joints`), its parts, each with a source of its own. Faults are
/// added to the reader's.
std::vector<Object> readSource(MapReader& reader, Object whole);

}  // namespace collision_node::scene

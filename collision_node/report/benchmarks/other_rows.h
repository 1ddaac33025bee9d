/// Rows that are not pairs of bodies on a piece of time.
#pragma once

#include <vector>

#include "collision_node/report/benchmarks/table.h"

namespace collision_node::report {

/// Vertex-face and edge-edge contacts of vertices on straight lines, on the published queries in `folder`,
/// against the published truth. No lines where the folder is absent.
std::vector<Line> linearLines(const std::string& folder, bool only_ours);

/// What a geometry::Body of a mesh costs: bytes a triangle, and the time to build it against std::sort of the
/// centroids' Morton keys.
std::vector<Line> bodyLines(bool only_ours);

/// The broad phase on moving boxes against the ten-line sort and sweep, FCL's and Bullet's, how its cost
/// grows, and a shot over standing obstacles against one ray.
std::vector<Line> broadLines(bool only_ours);

/// The whole engine: ten thousand movers against the broad phase alone, with its memory; and two threads
/// against one, in wall time.
std::vector<Line> engineLines(bool only_ours);

/// Bytes that operator new has handed out and not taken back.
std::size_t liveBytes();

}  // namespace collision_node::report

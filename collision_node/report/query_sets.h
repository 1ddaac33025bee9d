/// Frozen sets of queries for measurements. A set is a function of its name, its seed and its count alone, on
/// every machine; test/report counts what they hit.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "collision_node/geometry/body.h"
#include "collision_node/impact/pair_method.h"

namespace collision_node::report {

/// One pair on one piece of time. `a` and `b` index the set's bodies.
struct Query {
  std::uint32_t a = 0, b = 0;
  impact::Piece piece;
};

struct QuerySet {
  std::vector<std::unique_ptr<geometry::Body>> bodies;
  std::vector<Query> queries;
};

/// Two noisy spheres of `triangles` (1000, 10 000, 100 000) triangles each in 1 s: both move, both turn by up
/// to half a turn, relative travel 2 to 3 radii. About half touch; none touches at the start.
QuerySet tumblingMeshes(int triangles, std::size_t count);

/// A point at 2000 m/s for 1/30 s, straight, against a vehicle of 22 640 triangles at rest; 56 % touch.
QuerySet particleShots(std::size_t count);

/// The same shots with a sphere of 5 cm.
QuerySet sphereShots(std::size_t count);

/// Box, cylinder, sphere, capsule of 0.1 to 1 m in 1 s: both move, both turn by up to half a turn; about 55 %
/// touch.
QuerySet tumblingPrimitives(std::size_t count);

/// A splinter of 960 triangles at 2000 m/s for 1/30 s against the vehicle, spinning at `spin` [rad/s] about
/// any axis.
QuerySet splinterShots(std::size_t count, double spin);

}  // namespace collision_node::report

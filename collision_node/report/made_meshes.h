/// Meshes made in code for measurements: closed, the same on every machine.
#pragma once

#include <cstdint>
#include <memory>

#include "collision_node/geometry/triangle_mesh.h"

namespace collision_node::report {

using MeshPtr = std::shared_ptr<const geometry::TriangleMesh>;

/// A lumpy ball of about 1 m radius (0.8 to 1.2): an octahedron whose faces are cut `rows` times, blown up,
/// with waves and a roughness of a quarter of an edge. 8 rows^2 triangles.
MeshPtr noisySphere(int rows, std::uint64_t seed);

/// A tracked vehicle, 7 m long in x with its gun, z up, its middle near the origin: hull, turret, gun, two
/// tracks and twelve wheels, each closed, some inside one another. 22 640 triangles.
MeshPtr vehicle();

/// A jagged splinter about 10 cm long in x, 5 cm thick. 960 triangles.
MeshPtr splinter(std::uint64_t seed);

}  // namespace collision_node::report

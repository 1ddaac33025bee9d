/// Mesh files through assimp, with units and axes as rviz shows them.
#pragma once

#include <stdexcept>
#include <string>

#include "collision_node/geometry/triangle_mesh.h"

namespace collision_node::geometry {

/// A file that cannot be used; what() is one line: file, what is wrong, what would be right.
struct LoadError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Reads all triangles of STL, OBJ, Collada … in `path` (a plain path, already resolved), applies the node
/// transforms and then `scale` in double. Collada: units applied, up-axis left raw, as rviz and URDF mean it.
/// Throws LoadError: file absent, unreadable, no triangle, a coordinate that is not finite.
TriangleMesh loadMesh(const std::string& path, const Vec3& scale, SolidChoice solid);

/// Cheap. Throws LoadError when `path` is absent, no file, empty or not to be read.
void checkMeshFile(const std::string& path);

}  // namespace collision_node::geometry

/// The demo's tank (config/efp_tank) as one mesh, so that every method sees the same triangles.
#pragma once

#include <memory>
#include <string>

#include "collision_node/report/made_meshes.h"
#include "collision_node/scene/scene.h"

namespace collision_node::report {

struct Tank {
  std::shared_ptr<const scene::Scene> demo;
  const scene::Object* object = nullptr;  ///< of `demo`
  MeshPtr mesh;                           ///< object frame; round parts are prisms of 48 sides
  std::vector<int> link_of_triangle;      ///< index into object->links
};

/// Reads the demo's scene. Throws std::runtime_error that names what is missing.
Tank loadTank();

/// "link" or "link/zone" of a point of the tank's frame on a triangle of the mesh: what an event would name.
std::string partOf(const Tank& tank, int triangle, const geometry::Vec3& point);

}  // namespace collision_node::report

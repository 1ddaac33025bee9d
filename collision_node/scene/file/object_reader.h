/// One entry of `objects:` in a scene file, checked and with its meshes read where it is watched.
#pragma once

#include <string>
#include <vector>

#include "collision_node/scene/file/yaml_tree.h"

namespace collision_node::scene {

/// What reading an object needs from its surroundings.
struct ObjectContext {
  std::string folder;          ///< of the scene file: relative paths start here
  const Resources& resources;  ///< packages and parameters
  bool is_watched = true;      ///< else meshes are not read
};

/// Reads `node` as the object `name`: one Object, or one for each part that moves by itself, without bodies.
/// Adds every fault to `faults` and every warning to `warnings`; the object is whole only when no fault was
/// added.
std::vector<Object> readObject(const std::string& name, const YamlNode& node, const ObjectContext& context,
                               Faults& faults, std::vector<std::string>& warnings);

}  // namespace collision_node::scene

/// What only ROS knows, for the scene reader: where packages lie, what a parameter holds.
#pragma once

#include <functional>
#include <string>

#include "collision_node/scene/scene.h"

namespace collision_node::messages {

/// package:// is looked for in the package that holds the scene file (so that a checkout works without any
/// set-up), then by rospack (ROS_PACKAGE_PATH). `parameter` is handed on; without one, a scene that asks for
/// a parameter gets an error that says so. Needs no master.
scene::Resources makeResources(const std::string& scene_file,
                               std::function<std::string(const std::string&)> parameter = nullptr);

}  // namespace collision_node::messages

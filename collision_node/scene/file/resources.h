/// From a URI as the user wrote it to a plain path.
#pragma once

#include <string>

#include "collision_node/scene/scene.h"

namespace collision_node::scene {

/// package://name/path, file:///path, an absolute path, or a path relative to `folder` (that of the file that
/// names it). The file need not exist. Throws geometry::LoadError: unknown package, another scheme, an empty
/// path.
std::string resolveUri(const std::string& uri, const std::string& folder, const Resources& resources);

/// The whole file. Throws geometry::LoadError with the path when it cannot be read.
std::string readFile(const std::string& path);

/// The folder that `path` lies in, "." when it names none.
std::string folderOf(const std::string& path);

}  // namespace collision_node::scene

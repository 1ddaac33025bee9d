#include "collision_node/scene/file/resources.h"

#include <exception>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "collision_node/geometry/mesh_file.h"

namespace collision_node::scene {
namespace {

using geometry::LoadError;

bool startsWith(const std::string& text, const std::string& start) {
  return text.compare(0, start.size(), start) == 0;
}

std::string packagePath(const std::string& package, const std::string& uri, const Resources& resources) {
  std::string path, why;
  try {
    if (resources.package_path) path = resources.package_path(package);
  } catch (const std::exception& error) {
    why = std::string(" (") + error.what() + ")";
  }
  if (path.empty()) {
    throw LoadError(uri + ": package '" + package + "' not found" + why +
                    "; source its workspace or set ROS_PACKAGE_PATH, or give a path");
  }
  return path;
}

}  // namespace

std::string resolveUri(const std::string& uri, const std::string& folder, const Resources& resources) {
  if (uri.empty()) throw LoadError("an empty file name; give a path or a package:// URI");
  if (startsWith(uri, "package://")) {
    const std::string rest = uri.substr(10);
    const std::size_t slash = rest.find('/');
    if (slash == std::string::npos || slash == 0 || slash + 1 == rest.size()) {
      throw LoadError(uri + ": not a package URI; write package://package_name/path/in/package");
    }
    return packagePath(rest.substr(0, slash), uri, resources) + rest.substr(slash);
  }
  if (startsWith(uri, "file://")) {
    const std::string path = uri.substr(7);
    if (path.empty() || path[0] != '/')
      throw LoadError(uri + ": not a file URI; write file:///absolute/path");
    return path;
  }
  if (uri.find("://") != std::string::npos) {
    throw LoadError(uri + ": a scheme that is not known here; use package://, file:// or a plain path");
  }
  if (uri[0] == '/') return uri;
  return (std::filesystem::path(folder) / uri).string();
}

std::string readFile(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) throw LoadError(path + ": no such file");
  if (std::filesystem::is_directory(path, error)) throw LoadError(path + ": is a folder; a file is needed");
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw LoadError(path + ": cannot be opened for reading; check its permissions");
  std::ostringstream content;
  content << stream.rdbuf();
  return content.str();
}

std::string folderOf(const std::string& path) {
  const std::string folder = std::filesystem::path(path).parent_path().string();
  return folder.empty() ? "." : folder;
}

}  // namespace collision_node::scene

#include "collision_node/messages/resources.h"

#include <rospack/rospack.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <utility>
#include <vector>

namespace collision_node::messages {

namespace {

namespace fs = std::filesystem;

/// The folder, at or above `start`, whose package.xml names `package`; "" when there is none.
std::string enclosingPackage(const fs::path& start, const std::string& package) {
  for (fs::path folder = start; !folder.empty(); folder = folder.parent_path()) {
    std::ifstream in(folder / "package.xml");
    if (in) {
      const std::string text((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
      if (text.find("<name>" + package + "</name>") != std::string::npos) return folder.string();
    }
    if (folder == folder.root_path()) break;
  }
  return "";
}

/// The folder of an installed or checked-out package; "" when there is none. Quiet, unlike ros::package,
/// which prints lines of its own.
std::string findPackage(const std::string& package) {
  rospack::Rospack finder;
  finder.setQuiet(true);
  std::vector<std::string> places;
  std::string folder;
  if (!finder.getSearchPathFromEnv(places)) return "";
  finder.crawl(places, false);
  return finder.find(package, folder) ? folder : "";
}

}  // namespace

scene::Resources makeResources(const std::string& scene_file,
                               std::function<std::string(const std::string&)> parameter) {
  scene::Resources resources;
  std::error_code ignored;
  const fs::path folder = fs::absolute(scene_file, ignored).parent_path();
  resources.package_path = [folder](const std::string& package) {
    const std::string enclosing = enclosingPackage(folder, package);
    return enclosing.empty() ? findPackage(package) : enclosing;
  };
  resources.parameter = parameter ? std::move(parameter) : [](const std::string& name) -> std::string {
    throw std::runtime_error("parameter '" + name +
                             "': no parameter server here; give `urdf:` a file instead");
  };
  return resources;
}

}  // namespace collision_node::messages

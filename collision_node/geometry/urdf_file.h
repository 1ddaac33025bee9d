/// URDF collision elements through urdfdom.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "collision_node/geometry/mesh_file.h"
#include "collision_node/geometry/shape.h"

namespace collision_node::geometry {

struct UrdfLink {
  std::string name;
  std::string parent;               ///< parent link, empty for the root
  Pose T_root_l;                    ///< root <- link, every movable joint at 0, fixed joints folded in
  std::vector<PlacedShape> shapes;  ///< collision elements in URDF order, in the link's frame; may be empty
};

struct UrdfModel {
  std::string name;
  std::vector<UrdfLink> links;              ///< root first, then depth first, siblings by joint name
  std::vector<std::string> movable_joints;  ///< held at 0
  std::vector<std::string> warnings;        ///< e.g. links without a collision element
};

/// Turns a URI as the user wrote it (package://, file://, relative) into a plain path; throws LoadError.
using ResolveUri = std::function<std::string(const std::string& uri)>;

/// Parses URDF text. `source` names it in errors. Throws LoadError with every fault found, one per line.
UrdfModel parseUrdf(const std::string& xml, const std::string& source, const ResolveUri& resolve,
                    SolidChoice solid = SolidChoice::kAuto);

}  // namespace collision_node::geometry

/// URDF collision elements through urdfdom.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "collision_node/geometry/mesh_file.h"
#include "collision_node/geometry/shape.h"

namespace collision_node::geometry {

/// How a link hangs on its parent. At position q it is turned by q about `axis`, or shifted by q along it.
struct UrdfJoint {
  enum class Kind { kFixed, kRevolute, kContinuous, kPrismatic, kOther } kind = Kind::kFixed;
  std::string name;
  Vec3 axis = Vec3::UnitX();  ///< unit, in the link's frame; meant for revolute, continuous and prismatic
  /// Position = multiplier x that of the joint `driver` + offset: of itself, or of the joint that it mimics.
  std::string driver;
  double multiplier = 1.0, offset = 0.0;
  std::string fault;  ///< why one position does not tell where the link is; no fault of a link held at 0
};

struct UrdfLink {
  std::string name;
  std::string parent;               ///< parent link, empty for the root
  UrdfJoint joint;                  ///< to the parent; none for the root
  Pose T_parent_l;                  ///< parent <- link with the joint at 0
  Pose T_root_l;                    ///< root <- link, every movable joint at 0, fixed joints folded in
  std::vector<PlacedShape> shapes;  ///< collision elements in URDF order, in the link's frame; may be empty
};

struct UrdfModel {
  std::string name;
  std::vector<UrdfLink> links;              ///< root first, then depth first, siblings by joint name
  std::vector<std::string> movable_joints;  ///< held at 0
  std::vector<std::string> warnings;        ///< e.g. links without a collision element
};

/// The mesh that a URI names, as the user wrote it (package://, file://, relative); throws LoadError.
using GetMesh = std::function<std::shared_ptr<const TriangleMesh>(const std::string& uri, const Vec3& scale)>;

/// Parses URDF text. `source` names it in errors. Throws LoadError with every fault found, one per line.
UrdfModel parseUrdf(const std::string& xml, const std::string& source, const GetMesh& get_mesh);

}  // namespace collision_node::geometry

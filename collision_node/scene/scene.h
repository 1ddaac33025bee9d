/// A scene after loading: objects, links, zones, pairs, options. Immutable; shared by node, replay and
/// report.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "collision_node/geometry/body.h"
#include "collision_node/geometry/urdf_file.h"
#include "collision_node/impact/pair_method.h"
#include "collision_node/motion/stamped_pose.h"
#include "collision_node/scene/pair_rules.h"

namespace collision_node::scene {

using geometry::Pose;
using geometry::Vec3;
using motion::Nanoseconds;

enum class MotionModel { kSlerp, kHermite, kSpin };
enum class OnTimeout { kDrop, kFreeze };

/// A joint between two parts of an object, each part the links that fixed joints hold together.
struct PartJoint {
  geometry::UrdfJoint joint;
  Pose T_part_joint;  ///< part before it <- part behind it, with the joint at 0
};

/// Where an object's poses come from: a topic, a tf frame, joint positions, or nowhere, since it is fixed.
struct PoseSource {
  enum class Type { kFixed, kTopic, kTf, kJoints } type = Type::kFixed;
  Pose fixed;                     ///< kFixed
  std::string topic;              ///< kTopic, kJoints, as the user wrote it (relative or global)
  int index = -1;                 ///< kTopic: PoseArray element
  std::string model;              ///< kTopic: gazebo ModelStates name
  std::string link;               ///< kTopic: gazebo LinkStates name
  std::string tf_frame;           ///< kTf: no leading slash
  std::vector<PartJoint> joints;  ///< kJoints: from the object's first part to this one, at least one
};

/// Part of an object that gets a name in events. Without a box it is the whole link.
struct Zone {
  std::string name;
  std::string link;
  bool has_box = false;
  Vec3 size = Vec3::Zero();  ///< full lengths [m]
  Pose pose;                 ///< link <- box
};

struct Link {
  std::string name;                           ///< URDF link name, or the object's name for a single shape
  Pose T_o_l;                                 ///< object <- link
  std::string parent;                         ///< URDF parent link
  geometry::UrdfJoint joint;                  ///< to the parent
  Pose T_parent_l;                            ///< parent <- link with that joint at 0
  std::vector<geometry::PlacedShape> shapes;  ///< in the link's frame, URDF order
  /// In the object's frame; null when the link is in no watched pair.
  std::shared_ptr<const geometry::Body> body;
};

/// What moves as one. An object whose links move by themselves is several of these, with one name; the first
/// of them holds the URDF's root link.
struct Object {
  std::string name;
  std::string part;  ///< the link whose frame moves it, when it is one of several; else empty
  PoseSource source;
  MotionModel motion = MotionModel::kSlerp;
  OnTimeout on_timeout = OnTimeout::kDrop;
  double max_speed = std::numeric_limits<double>::infinity();              ///< [m/s]
  double max_spin = std::numeric_limits<double>::infinity();               ///< [rad/s]
  double acceleration = std::numeric_limits<double>::quiet_NaN();          ///< [m/s^2], NaN: not asked
  double angular_acceleration = std::numeric_limits<double>::quiet_NaN();  ///< [rad/s^2], NaN: not asked
  std::vector<Link> links;
  std::vector<Zone> zones;
  std::vector<std::string> movable_joints;  ///< held at 0

  /// "robot", or "robot/arm" for a part of it.
  std::string label() const { return part.empty() ? name : name + "/" + part; }
};

struct TimeOptions {
  double reorder = 0.1;  ///< [s]
  double max_gap = 1.0;  ///< [s]
  double timeout = 1.5;  ///< [s] >= max_gap + reorder
  double jump = 1.0;     ///< [s]
};

struct Scene {
  std::string file;  ///< for messages
  std::string world_frame = "world";
  double time_precision = 1e-9;      ///< [s]
  double distance_precision = 1e-6;  ///< [m]
  TimeOptions time;
  double stats_period = 1.0;            ///< [s] of data time
  std::uint64_t node_budget = 4000000;  ///< per piece and pair
  std::vector<Object> objects;          ///< in byte order of their names; parts of one in URDF order
  PairRules pairs;                      ///< which pairs of links are watched
  std::vector<std::string> warnings;    ///< one line each, for whoever may print
};

/// Every fault of a scene at once, one line each: file, key path, value, limit, what would be right.
struct SceneError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// How the core reaches what only ROS knows. The defaults know file:// and plain paths, relative to the scene
/// file.
struct Resources {
  std::function<std::string(const std::string& package)> package_path;  ///< throws or returns "" when unknown
  std::function<std::string(const std::string& param)> parameter;       ///< e.g. robot_description
};

/// Values that replace those of the file: key path "precision/time" -> YAML text.
using Overrides = std::map<std::string, std::string>;

/// Reads, checks and loads everything `file` names. Throws SceneError that lists all faults.
std::shared_ptr<const Scene> loadScene(const std::string& file, const Resources& resources,
                                       const Overrides& overrides = {});

/// What `replay --plan` and `~plan` print: objects, links, meshes, pairs with their solver, what is left out
/// and why.
std::string planText(const Scene& scene);

}  // namespace collision_node::scene

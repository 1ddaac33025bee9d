/// Joint positions by name (sensor_msgs/JointState), and the frames that they move.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "collision_node/messages/pose_reader.h"
#include "collision_node/scene/file/moving_parts.h"

namespace collision_node::messages {

struct JointStates {
  struct One {
    std::string name;
    double position = 0.0;       ///< as sent, perhaps NaN [rad] or [m]
    std::optional<double> rate;  ///< when the message has finite ones
  };
  motion::Nanoseconds stamp_ns = 0;
  std::vector<One> joints;
};

/// Throws PoseError when messages of this type hold no joint states.
void checkJointType(const std::string& datatype, const std::string& md5sum);

/// Throws PoseError: as checkJointType; cut short; names and positions of different numbers; a name twice.
JointStates readJointStates(const RawMessage& message);

/// The joints of all objects that one topic moves, each an edge between two frames.
class JointEdges {
 public:
  struct Edge {
    std::string object;  ///< its name
    std::string parent, child;
    scene::PartJoint joint;
    bool has_come = false;
  };

  /// Ignored when there is an edge to `edge.child` already.
  void add(Edge edge);
  /// A joint of this name moves nothing that matters, and is no fault either.
  void ignore(const std::string& driver) { ignored_.insert(driver); }

  /// Calls `move(edge, pose)` for every edge whose joint is in `states`. Throws PoseError after that: a
  /// position is not finite, or no joint of the message moves anything here.
  template <typename Move>
  void take(const JointStates& states, const Move& move) {
    std::string fault;
    bool any = false;
    for (const JointStates::One& one : states.joints) {
      bool known = ignored_.count(one.name) != 0;
      for (Edge& edge : edges_) {
        if (edge.joint.joint.driver != one.name) continue;
        known = true;
        if (!isFinite(one, fault)) continue;
        edge.has_come = true;
        move(edge, scene::jointPose(edge.joint, states.stamp_ns, one.position, one.rate));
      }
      any = any || known;
      if (!known && others_.size() < kMostOthers) others_.insert(one.name);
    }
    if (!any) fault = noneIsKnown(states);
    if (!fault.empty()) throw PoseError(fault);
  }

  /// One line for each joint that is waited for: its name, its object's, and what came instead.
  std::vector<std::string> missing() const;

 private:
  static constexpr std::size_t kMostOthers = 20;
  static bool isFinite(const JointStates::One& one, std::string& fault);
  std::string noneIsKnown(const JointStates& states) const;

  std::vector<Edge> edges_;
  std::set<std::string> ignored_;
  std::set<std::string> others_;  // names that move nothing here
};

}  // namespace collision_node::messages

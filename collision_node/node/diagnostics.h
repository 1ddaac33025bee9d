/// The node's health, from facts: what /diagnostics says.
#pragma once

#include <diagnostic_msgs/DiagnosticStatus.h>

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "collision_node/messages/pose_router.h"
#include "collision_node/scene/engine.h"

namespace collision_node::node {

struct Health {
  std::string name;       ///< of the node or nodelet, as a graph name
  std::string scene;      ///< file
  bool has_pairs = true;  ///< the scene watches any
  std::uint32_t epoch = 0;
  std::uint64_t messages = 0;  ///< that have come, of all topics
  std::uint64_t events = 0;
  scene::Stats stats;
  std::map<std::string, messages::TopicFaults> faults;  ///< by topic
  std::map<std::string, std::uint64_t> lost;            ///< messages that never came, by topic
  std::vector<std::string> without_publisher;           ///< subscribed topics that nobody publishes
  std::vector<std::string> missing_joints;  ///< one line each: joints whose position has never come
  std::vector<std::string> unconnected;     ///< "'frame' to world_frame 'world'": tf has not said how
};

/// ERROR: messages that cannot be used. WARN: a scene without any pair, a topic without stamps or twists
/// that are needed, no pose has arrived at all, a topic without publisher, a frame that tf does not connect,
/// a joint that never came, an object that is silent, poses rejected or late, messages lost. OK: watching.
/// The message names the first of them in that order.
diagnostic_msgs::DiagnosticStatus diagnose(const Health& health);

}  // namespace collision_node::node

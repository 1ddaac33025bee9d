/// The node's private parameters. Everything about the scene itself stands in the scene file.
#pragma once

#include <ros/node_handle.h>

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "collision_node/impact/pair_method.h"
#include "collision_node/messages/markers.h"
#include "collision_node/scene/scene.h"

namespace collision_node::node {

/// what() is one line: parameter, value, what would be right.
struct ParameterError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct Parameters {
  std::string scene;                                           ///< ~scene: the scene file; required
  scene::Overrides overrides;                                  ///< ~override/*: same key path as in the file
  impact::MethodName method = impact::MethodName::kCertified;  ///< ~method
  bool everything = false;          ///< ~plan is "full": every pair on every piece, with the same events
  messages::MarkerOptions markers;  ///< ~markers/{min_size [m], lifetime [s], max_events}
  /// ~queue: messages that may wait for the engine, by topic: minutes of a fast stream. What does not fit is
  /// lost, and counted by its number.
  std::uint32_t queue = 200000;
  std::vector<std::string> warnings;  ///< parameters that nobody reads
};

/// Throws ParameterError.
Parameters readParameters(const ros::NodeHandle& private_handle);

/// A parameter tree as key paths and YAML text: {precision: {time: 1e-6}} -> "precision/time": "1e-06". A
/// text is handed on bare, because rosparam stores `1e-9` as a text; one that YAML would read otherwise gets
/// quotes.
scene::Overrides flatten(const XmlRpc::XmlRpcValue& tree);

}  // namespace collision_node::node

/// Messages that hold the states of many things by name: gazebo's models and links.
///
/// Read without their packages where those are not everywhere (gazebo_msgs), and one entry at a time: gazebo
/// sends all models a thousand times a second.
#pragma once

#include <string>

#include "collision_node/messages/pose_reader.h"

namespace collision_node::messages {

extern const char* const kModelStates;      ///< gazebo_msgs/ModelStates
extern const char* const kLinkStates;       ///< gazebo_msgs/LinkStates
extern const char* const kGazeboStatesMd5;  ///< of both: they have the same fields

/// The state of `name` (a model, or model::link): pose and twist in gazebo's world, no stamp. Throws
/// PoseError: no such name (lists what there is), cut short, or arrays of different lengths.
motion::StampedPose readGazeboState(const RawMessage& message, const std::string& name);

}  // namespace collision_node::messages

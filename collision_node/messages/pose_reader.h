/// One serialised pose message of any supported type -> StampedPose. Shared by node and replay.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>

#include "collision_node/motion/stamped_pose.h"
#include "collision_node/scene/scene.h"

namespace collision_node::messages {

/// A message whose type is only known at run time, as a connection or a bag delivers it. Does not own `data`.
struct RawMessage {
  std::string datatype;
  std::string md5sum;
  const std::uint8_t* data = nullptr;
  std::uint32_t size = 0;
};

/// An input that cannot be used as it is; what() is one line that names what is wrong and what would be
/// right.
struct PoseError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Throws PoseError when messages of this type cannot feed `source`: unknown type, another version of a known
/// one, a PoseArray without `index`.
void checkPoseType(const std::string& datatype, const std::string& md5sum, const scene::PoseSource& source);

/// The pose in `message`, numbers as sent: nothing is checked or normalised (the engine counts bad poses).
/// Supported: PoseStamped, PoseWithCovarianceStamped, TransformStamped, Odometry (its twist turned out of
/// child_frame_id into world axes; the child frame is taken to be the object's), PoseArray by index.
/// Throws PoseError: as checkPoseType; header.frame_id is not `world_frame`; index beyond the array; cut
/// short.
motion::StampedPose readPose(const RawMessage& message, const scene::PoseSource& source,
                             const std::string& world_frame);

}  // namespace collision_node::messages

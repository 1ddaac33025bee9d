/// One serialised pose message of any supported type -> StampedPose. Shared by node and replay.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>

#include "collision_node/motion/stamped_pose.h"
#include "collision_node/scene/scene.h"

namespace collision_node::messages {

/// What a pose's stamp is worth.
enum class StampKind {
  kSent,     ///< the sender's own
  kGuessed,  ///< the sender gave none: when it arrived
  kAlways    ///< the pose holds at any time, its stamp means nothing
};

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

/// Throws PoseError when a message is of another version of its type than this build knows.
void checkVersion(const std::string& datatype, const std::string& md5sum, const std::string& ours);

/// Throws PoseError when messages of this type cannot feed `source`: unknown type, another version of a known
/// one, a selection (`index`, `model`, `link`) that the type needs and the source lacks.
void checkPoseType(const std::string& datatype, const std::string& md5sum, const scene::PoseSource& source);

/// What one message says of one object.
struct PoseReading {
  std::string frame;      ///< in which the pose is given, no leading slash
  bool in_world = false;  ///< the type has no frame: the pose is meant in world_frame
  StampKind kind = StampKind::kSent;
  motion::StampedPose pose;
};

/// The pose in `message`, numbers as sent: nothing is checked or normalised (the engine counts bad poses).
/// Supported: PoseStamped, PoseWithCovarianceStamped, TransformStamped, Odometry (its twist turned out of
/// child_frame_id into the frame's axes; the child frame is taken to be the object's), PoseArray by index,
/// gazebo ModelStates by model and LinkStates by link, whose stamp is `received_ns`. Throws PoseError: as
/// checkPoseType; index or name not in the message; cut short.
PoseReading readPose(const RawMessage& message, const scene::PoseSource& source,
                     motion::Nanoseconds received_ns);

}  // namespace collision_node::messages

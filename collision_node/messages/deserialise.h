/// Bytes of a known type -> message.
#pragma once

#include <ros/serialization.h>

#include <string>

#include "collision_node/messages/pose_reader.h"

namespace collision_node::messages {

/// The caller has checked the type. Throws PoseError when the bytes end too early.
template <typename Message>
Message deserialise(const RawMessage& raw) {
  Message message;
  // The stream only reads, but its constructor asks for a pointer to non-const.
  ros::serialization::IStream stream(const_cast<std::uint8_t*>(raw.data), raw.size);
  try {
    ros::serialization::deserialize(stream, message);
  } catch (const ros::serialization::StreamOverrunException&) {
    throw PoseError("a " + raw.datatype + " message of " + std::to_string(raw.size) + " bytes is cut short");
  }
  return message;
}

}  // namespace collision_node::messages

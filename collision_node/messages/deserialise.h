/// Bytes of a known type -> message.
#pragma once

#include <ros/serialization.h>

#include <cstdint>
#include <exception>
#include <string>

#include "collision_node/messages/pose_reader.h"

namespace collision_node::messages {

/// Throws PoseError when an array that starts at `offset` of the bytes claims more elements than they can
/// hold: reserving room for them would take all memory. `least`: bytes of the smallest element.
void checkArray(const RawMessage& raw, std::uint32_t offset, std::uint32_t least);
/// The same, and how many it has.
std::uint32_t countArray(const RawMessage& raw, std::uint32_t offset, std::uint32_t least);

/// Bytes of a std_msgs/Header in front of the message. Throws PoseError when they end too early.
std::uint32_t headerSize(const RawMessage& raw);

/// The caller has checked the type, and the arrays of types that hold some. Throws PoseError when the bytes
/// end too early.
template <typename Message>
Message deserialise(const RawMessage& raw) {
  Message message;
  // The stream only reads, but its constructor asks for a pointer to non-const.
  ros::serialization::IStream stream(const_cast<std::uint8_t*>(raw.data), raw.size);
  try {
    ros::serialization::deserialize(stream, message);
  } catch (const std::exception&) {
    throw PoseError("a " + raw.datatype + " message of " + std::to_string(raw.size) + " bytes is cut short");
  }
  return message;
}

}  // namespace collision_node::messages

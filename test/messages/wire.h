/// Messages as they lie on the wire.
#pragma once

#include <ros/serialization.h>

#include <string>
#include <vector>

#include "collision_node/messages/pose_reader.h"

namespace collision_node::messages {

template <typename Message>
struct Wire {
  explicit Wire(const Message& message) : bytes(ros::serialization::serializationLength(message)) {
    ros::serialization::OStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
    ros::serialization::serialize(stream, message);
    raw.datatype = ros::message_traits::datatype<Message>();
    raw.md5sum = ros::message_traits::md5sum<Message>();
    raw.data = bytes.data();
    raw.size = static_cast<std::uint32_t>(bytes.size());
  }
  std::vector<std::uint8_t> bytes;
  RawMessage raw;
};

}  // namespace collision_node::messages

#include "collision_node/messages/deserialise.h"

namespace collision_node::messages {

namespace {

std::uint32_t countAt(const RawMessage& raw, std::uint32_t offset) {
  if (raw.size < 4 || offset > raw.size - 4)
    throw PoseError("a " + raw.datatype + " message of " + std::to_string(raw.size) + " bytes is cut short");
  ros::serialization::IStream stream(const_cast<std::uint8_t*>(raw.data) + offset, 4);
  std::uint32_t count = 0;
  ros::serialization::deserialize(stream, count);
  return count;
}

}  // namespace

void checkArray(const RawMessage& raw, std::uint32_t offset, std::uint32_t least) {
  countArray(raw, offset, least);
}

std::uint32_t countArray(const RawMessage& raw, std::uint32_t offset, std::uint32_t least) {
  const std::uint32_t count = countAt(raw, offset);
  const std::uint32_t left = raw.size - offset - 4;
  if (count > left / least)
    throw PoseError("a " + raw.datatype + " message of " + std::to_string(raw.size) + " bytes claims " +
                    std::to_string(count) + " elements; at most " + std::to_string(left / least) +
                    " fit: it is damaged");
  return count;
}

std::uint32_t headerSize(const RawMessage& raw) {
  const std::uint32_t fixed = 16;  // seq, stamp, length of frame_id
  const std::uint32_t frame = countAt(raw, fixed - 4);
  if (frame > raw.size - fixed)
    throw PoseError("a " + raw.datatype + " message of " + std::to_string(raw.size) + " bytes is cut short");
  return fixed + frame;
}

}  // namespace collision_node::messages

#include "collision_node/messages/sequence_gaps.h"

namespace collision_node::messages {

namespace {

/// Of the types a scene may use these begin with a header, and it with the number.
bool hasNumber(const RawMessage& message) {
  const std::string& type = message.datatype;
  return message.size >= 4 && (type.rfind("geometry_msgs/", 0) == 0 || type.rfind("nav_msgs/", 0) == 0 ||
                               type.rfind("sensor_msgs/", 0) == 0);
}

std::uint32_t numberOf(const RawMessage& message) {
  std::uint32_t number = 0;
  for (int i = 3; i >= 0; --i) number = number << 8 | message.data[i];
  return number;
}

}  // namespace

void SequenceGaps::see(const std::string& topic, const std::string& publisher, const RawMessage& message) {
  if (!hasNumber(message)) return;
  const std::uint32_t number = numberOf(message);
  const auto [place, is_new] = last_.emplace(std::make_pair(topic, publisher), number);
  if (is_new) return;
  if (number > place->second) {
    const std::uint64_t lost = number - place->second - 1;
    if (lost > 0) by_topic_[topic] += lost;
    lost_ += lost;
  }
  place->second = number;
}

}  // namespace collision_node::messages

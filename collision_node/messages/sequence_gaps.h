/// Messages that were sent and never came, as far as their sequence numbers tell. For diagnostics only: no
/// pose is taken or left because of a number.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>

#include "collision_node/messages/pose_reader.h"

namespace collision_node::messages {

/// Every publisher numbers its messages on a topic one by one. A number that falls back is a publisher that
/// has begun again; types without a header have no numbers. A queue of ours that overflows leaves the same
/// gap.
class SequenceGaps {
 public:
  void see(const std::string& topic, const std::string& publisher, const RawMessage& message);

  std::uint64_t lost() const { return lost_; }
  const std::map<std::string, std::uint64_t>& lostByTopic() const { return by_topic_; }

 private:
  std::map<std::pair<std::string, std::string>, std::uint32_t> last_;  ///< by topic and publisher
  std::map<std::string, std::uint64_t> by_topic_;                      ///< topics that lost any
  std::uint64_t lost_ = 0;
};

}  // namespace collision_node::messages

#include <gtest/gtest.h>

#include <vector>

#include "collision_node/messages/sequence_gaps.h"

namespace collision_node::messages {
namespace {

void see(SequenceGaps& gaps, const std::vector<std::uint32_t>& numbers, const std::string& publisher = "/p",
         const std::string& type = "geometry_msgs/PoseStamped") {
  for (const std::uint32_t number : numbers) {
    const std::uint8_t bytes[4] = {static_cast<std::uint8_t>(number), static_cast<std::uint8_t>(number >> 8),
                                   static_cast<std::uint8_t>(number >> 16),
                                   static_cast<std::uint8_t>(number >> 24)};
    RawMessage message;
    message.datatype = type;
    message.data = bytes;
    message.size = 4;
    gaps.see("/pose", publisher, message);
  }
}

// README: "every message arrives"
TEST(SequenceGaps, CountsTheNumbersThatNeverCame) {
  SequenceGaps gaps;
  see(gaps, {256, 257, 260, 261, 263});
  EXPECT_EQ(gaps.lost(), 3u);
  EXPECT_EQ(gaps.lostByTopic().at("/pose"), 3u);
}

TEST(SequenceGaps, APublisherThatBeginsAgainHasLostNothing) {
  SequenceGaps gaps;
  see(gaps, {70000, 70001, 0, 1, 2, 2, 3});
  see(gaps, {4294967294u, 4294967295u, 0, 1}, "/other");  // round the end
  EXPECT_EQ(gaps.lost(), 0u);
}

TEST(SequenceGaps, EveryPublisherCountsForItself) {
  SequenceGaps gaps;
  for (std::uint32_t i = 0; i < 5; ++i) {
    see(gaps, {i}, "/left");
    see(gaps, {1000 + i}, "/right");
  }
  EXPECT_EQ(gaps.lost(), 0u);
}

TEST(SequenceGaps, TypesWithoutAHeaderHaveNoNumbers) {
  SequenceGaps gaps;
  see(gaps, {1, 9}, "/p", "tf2_msgs/TFMessage");
  EXPECT_EQ(gaps.lost(), 0u);
}

}  // namespace
}  // namespace collision_node::messages

#include <gtest/gtest.h>

#include <limits>

#include "collision_node/messages/convert.h"
#include "collision_node/messages/event_text.h"
#include "test/messages/sample_event.h"

namespace collision_node::messages {
namespace {

TEST(Convert, thereAndBackIsTheSameEvent) {
  const scene::Event e = test::sampleEvent();
  const Impact message = toMessage(e, "world");
  EXPECT_EQ(message.header.frame_id, "world");
  // The text names every field and tells every two doubles apart.
  EXPECT_EQ(toJson(fromMessage(message), "world"), toJson(e, "world"));
}

TEST(Convert, timesStayInTheRangeOfRos) {
  EXPECT_EQ(toNanoseconds(toTime(1'700'000'000'123'456'789)), 1'700'000'000'123'456'789);
  EXPECT_EQ(toTime(-5), ros::Time(0, 0));
  EXPECT_EQ(toTime(std::numeric_limits<Nanoseconds>::max()), ros::TIME_MAX);
}

TEST(Convert, statsCarryEveryCount) {
  scene::Stats s;
  s.epoch = 1;
  s.stamp_ns = 5'000'000'000;
  s.watermark_ns = 4'000'000'000;
  s.has_watermark = true;
  s.pairs_culled = 2;
  s.pairs_clear = 3;
  s.pairs_impact = 4;
  s.pairs_undecided = 5;
  s.pairs_uncovered = 6;
  s.uncovered_objects = {"x"};
  s.accepted = 7;
  s.reordered = 8;
  s.late = 9;
  s.duplicate = 10;
  s.rejected = 11;
  s.lost = 12;
  s.node_tests = 13;
  s.subdivisions = 14;
  s.worst_bracket = 15;
  s.worst_position_error = 16;
  s.wall_time = 17;
  const IntervalStats m = toMessage(s, "world");
  EXPECT_EQ(m.header.stamp, ros::Time(5));
  EXPECT_EQ(m.watermark, ros::Time(4));
  EXPECT_EQ(m.epoch, 1u);
  EXPECT_EQ(m.pairs_culled, 2u);
  EXPECT_EQ(m.pairs_clear, 3u);
  EXPECT_EQ(m.pairs_impact, 4u);
  EXPECT_EQ(m.pairs_undecided, 5u);
  EXPECT_EQ(m.pairs_uncovered, 6u);
  EXPECT_EQ(m.uncovered_objects, std::vector<std::string>{"x"});
  EXPECT_EQ(m.accepted, 7u);
  EXPECT_EQ(m.reordered, 8u);
  EXPECT_EQ(m.late, 9u);
  EXPECT_EQ(m.duplicate, 10u);
  EXPECT_EQ(m.rejected, 11u);
  EXPECT_EQ(m.lost, 12u);
  EXPECT_EQ(m.node_tests, 13u);
  EXPECT_EQ(m.subdivisions, 14u);
  EXPECT_EQ(m.worst_bracket, 15.0);
  EXPECT_EQ(m.worst_position_error, 16.0);
  EXPECT_EQ(m.wall_time, 17.0);
  s.has_watermark = false;
  EXPECT_TRUE(toMessage(s, "world").watermark.isZero());
}

}  // namespace
}  // namespace collision_node::messages

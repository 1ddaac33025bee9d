/// nav_msgs/Path: which of its poses are news, and which paths are no tracks.
#include <gtest/gtest.h>
#include <nav_msgs/Path.h>

#include "collision_node/messages/path_memory.h"
#include "test/messages/wire.h"

namespace collision_node::messages {
namespace {

constexpr motion::Nanoseconds kMs = 1'000'000;
using Stamps = std::vector<motion::Nanoseconds>;

nav_msgs::Path pathOf(const Stamps& stamps_ms, double x = 0.0) {
  nav_msgs::Path path;
  path.header.frame_id = "world";
  path.header.stamp = ros::Time(77);
  for (const motion::Nanoseconds ms : stamps_ms) {
    path.poses.emplace_back();
    path.poses.back().header.stamp.fromNSec(static_cast<std::uint64_t>(ms * kMs));
    path.poses.back().pose.position.x = x + 1e-3 * static_cast<double>(ms);
    path.poses.back().pose.orientation.w = 1.0;
  }
  return path;
}

std::vector<PoseReading> readingsOf(const nav_msgs::Path& path) {
  return readPath(Wire<nav_msgs::Path>(path).raw);
}

std::string refusalOf(const nav_msgs::Path& path) {
  try {
    readingsOf(path);
  } catch (const PoseError& error) {
    return error.what();
  }
  return "taken";
}

struct Memory {
  PathMemory memory{100 * kMs, 1000 * kMs};
  Stamps news(const nav_msgs::Path& path) {
    Stamps out;
    for (const PoseReading& reading : memory.news(readingsOf(path)))
      out.push_back(reading.pose.stamp_ns / kMs);
    return out;
  }
};

TEST(PathMemory, everyPoseHasItsOwnStampAndFrame) {
  nav_msgs::Path path = pathOf({100, 200});
  path.poses[1].header.frame_id = "/world";
  const auto readings = readingsOf(path);
  ASSERT_EQ(readings.size(), 2u);
  EXPECT_EQ(readings[0].pose.stamp_ns, 100 * kMs) << "not the path's own";
  EXPECT_EQ(readings[1].pose.pose.position.x(), 0.2);
  EXPECT_EQ(readings[0].frame, "world") << "a pose without a frame is in the path's";
  EXPECT_EQ(readings[1].frame, "world");
  path.poses[1].header.frame_id = "odom";
  EXPECT_EQ(refusalOf(path),
            "the poses of a nav_msgs/Path are in the frames 'world' and 'odom'; one is needed");
}

// README: "the stamps of a Path go forward, each the instant when the object is there"
TEST(PathMemory, aPlanIsNoTrack) {
  EXPECT_EQ(
      refusalOf(pathOf({0, 0, 0})),
      "all 3 poses of a nav_msgs/Path have the stamp 0.000000000 s: a plan, not a track; each pose needs "
      "the instant when the object is there");
  EXPECT_NE(
      refusalOf(pathOf({5000, 5000})).find("all 2 poses of a nav_msgs/Path have the stamp 5.000000000 s"),
      std::string::npos);
  EXPECT_NE(refusalOf(pathOf({0})).find("all 1 poses"), std::string::npos);
  EXPECT_NE(refusalOf(pathOf({1, 3, 2}))
                .find("the stamps of a nav_msgs/Path go back: pose 2 has 0.002000000 s "
                      "after 0.003000000 s"),
            std::string::npos);
  EXPECT_EQ(refusalOf(pathOf({5})), "taken");
  EXPECT_EQ(refusalOf(pathOf({0, 5, 5, 6})), "taken") << "the track keeps the first of the equal ones";
  EXPECT_EQ(refusalOf(pathOf({})), "taken");
}

TEST(PathMemory, aDamagedPathTakesNoMemory) {
  Wire<nav_msgs::Path> wire(pathOf({1, 2}));
  wire.bytes[16 + 5 + 3] = 0x7f;  // the number of poses
  EXPECT_THROW(readPath(wire.raw), PoseError);
}

TEST(PathMemory, aLongerPathAddsWhatIsNew) {
  Memory m;
  EXPECT_EQ(m.news(pathOf({100, 200})), (Stamps{100, 200}));
  EXPECT_EQ(m.news(pathOf({100, 200, 300, 400})), (Stamps{300, 400}));
  EXPECT_EQ(m.news(pathOf({100, 200, 300, 400})), Stamps{}) << "sent again";
  EXPECT_EQ(m.news(pathOf({300, 400, 500})), Stamps{500}) << "a window that slides";
  EXPECT_EQ(m.memory.duplicates() + m.memory.late(), 0u) << "nothing was said anew";
}

TEST(PathMemory, theFirstPoseOfAStampWins) {
  Memory m;
  m.news(pathOf({100, 200}));
  EXPECT_EQ(m.news(pathOf({100, 200, 300}, 9.0)), Stamps{300});
  EXPECT_EQ(m.memory.duplicates(), 2u);
}

TEST(PathMemory, aPoseBetweenOldOnesIsLateUnlessWithinReorder) {
  Memory m;
  m.news(pathOf({100, 900}));
  EXPECT_EQ(m.news(pathOf({100, 500, 850, 900, 1000})), (Stamps{850, 1000})) << "the track sorts them";
  EXPECT_EQ(m.memory.late(), 1u);
}

TEST(PathMemory, aPathThatEndsBeforeIsTheOldOneUnlessItIsBackByMoreThanJump) {
  Memory m;
  m.news(pathOf({100, 200, 1100}));
  EXPECT_EQ(m.news(pathOf({100, 200})), Stamps{}) << "delivered in the wrong order";
  m.news(pathOf({100, 200, 1100, 1300}));
  EXPECT_EQ(m.news(pathOf({100, 200})), (Stamps{100, 200}))
      << "back by more than jump: the track begins anew";
  EXPECT_EQ(m.news(pathOf({100, 200, 1100})), Stamps{1100});
  EXPECT_EQ(m.memory.duplicates() + m.memory.late(), 0u);
  m.memory.forget();
  EXPECT_EQ(m.news(pathOf({100, 200, 1100})), (Stamps{100, 200, 1100}));
}

}  // namespace
}  // namespace collision_node::messages

/// What drives an object beside poses in the world frame: chains of tf, poses in other frames, gazebo's
/// states.
#include <geometry_msgs/TransformStamped.h>
#include <gtest/gtest.h>
#include <nav_msgs/Odometry.h>
#include <nav_msgs/Path.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>

#include "test/replay/bags.h"
#include "test/support/gazebo_states.h"

namespace collision_node::test {
namespace {

std::vector<YAML::Node> lines(const std::string& text) {
  std::istringstream in(text);
  std::vector<YAML::Node> out;
  for (std::string line; std::getline(in, line);) out.push_back(YAML::Load(line));
  return out;
}

/// Seconds after the bag's first stamp.
double instantOf(const YAML::Node& event) {
  return 1e-9 * static_cast<double>(event["interval_start"].as<std::int64_t>() - kFirstNs) +
         event["toi_lower"].as<double>();
}

class Sources : public ::testing::Test {
 protected:
  std::string path(const std::string& name) const { return folder_.path() + "/" + name; }
  std::string scene(const std::string& ball_pose, const std::string& wall_pose = "fixed: {}") {
    return folder_.write("scene.yaml", "objects:\n  ball: {sphere: {radius: 0.1}, pose: {" + ball_pose +
                                           "}}\n  wall: {box: {size: [1, 20, 20]}, pose: {" + wall_pose +
                                           "}}\ntime: {max_gap: 0.5, timeout: 0.7}\n");
  }
  test_support::TempFolder folder_;
};

/// The ball is at x = -10 + 20 s in the world: odom glides at 5 m/s, sent every 70 ms; the base runs at 15
/// m/s in it, sent every 30 ms. It meets the wall at x = -0.6.
void writeChain(rosbag::Bag& bag) {
  bag.write("/tf_static", after(0), transform("base", "ball", 0, -10.0));
  for (std::int64_t ms = 0; ms <= 2100; ms += 10) {
    const double s = 1e-3 * static_cast<double>(ms);
    if (ms % 70 == 0) bag.write("/tf", after(ms * kMs), transform("world", "odom", ms * kMs, 5.0 * s));
    if (ms % 30 == 0) bag.write("/tf", after(ms * kMs + 1), transform("odom", "base", ms * kMs, 15.0 * s));
  }
}

TEST_F(Sources, aChainOfMovingFramesIsItsComposition) {
  {
    rosbag::Bag bag(path("chain.bag"), rosbag::bagmode::Write);
    writeChain(bag);
  }
  const Outcome got = replayed({scene("tf: ball"), path("chain.bag"), "--jsonl", "-"});
  ASSERT_EQ(got.code, 0) << got.err;
  const auto events = lines(got.out);
  ASSERT_EQ(events.size(), 2u) << got.out;
  EXPECT_EQ(events[0]["certificate"].as<std::string>(), "CONFIRMED");
  EXPECT_NEAR(instantOf(events[0]), (10.0 - 0.6) / 20.0, 2e-9);
  EXPECT_NEAR(instantOf(events[1]), (10.0 + 0.6) / 20.0, 2e-9);
}

TEST_F(Sources, aFrameThatOnlyStaticTransformsHoldIsAFixedObject) {
  {
    rosbag::Bag bag(path("chain.bag"), rosbag::bagmode::Write);
    writeChain(bag);
    bag.write("/tf_static", after(500 * kMs), transform("world", "lab", 0, 4.0));  // late, yet for all time
    bag.write("/tf_static", after(500 * kMs), transform("lab", "wall", 0, 1.0));
  }
  const Outcome got = replayed({scene("tf: ball", "tf: wall"), path("chain.bag"), "--jsonl", "-"});
  ASSERT_EQ(got.code, 0) << got.err;
  const auto events = lines(got.out);
  ASSERT_EQ(events.size(), 2u) << got.out;
  EXPECT_NEAR(instantOf(events[0]), (15.0 - 0.6) / 20.0, 2e-9);
}

TEST_F(Sources, posesInAMovingFrameAreComposedWithIt) {
  {
    rosbag::Bag bag(path("odometry.bag"), rosbag::bagmode::Write);
    for (std::int64_t ms = 0; ms <= 2100; ms += 10) {
      const double s = 1e-3 * static_cast<double>(ms);
      if (ms % 70 == 0) bag.write("/tf", after(ms * kMs), transform("world", "odom", ms * kMs, 5.0 * s));
      nav_msgs::Odometry odometry;
      odometry.header.stamp = after(ms * kMs);
      odometry.header.frame_id = "odom";
      odometry.pose.pose.position.x = -10.0 + 15.0 * s;
      odometry.pose.pose.orientation.w = 1.0;
      bag.write("/ball/odom", after(ms * kMs + 1), odometry);
    }
  }
  const Outcome got = replayed({scene("topic: ball/odom"), path("odometry.bag"), "--jsonl", "-"});
  ASSERT_EQ(got.code, 0) << got.err;
  const auto events = lines(got.out);
  ASSERT_EQ(events.size(), 2u) << got.out;
  EXPECT_EQ(events[0]["certificate"].as<std::string>(), "CONFIRMED");
  EXPECT_NEAR(instantOf(events[0]), (10.0 - 0.6) / 20.0, 2e-9);
}

TEST_F(Sources, aFrameThatTfNeverConnectsIsNamedWithTheWorld) {
  {
    rosbag::Bag bag(path("odometry.bag"), rosbag::bagmode::Write);
    for (int i = 0; i < 10; ++i) bag.write("/ball/pose", ballPose(i).header.stamp, ballPose(i, "lab"));
    bag.write("/tf", after(0), transform("world", "elsewhere", 0, 0.0));
  }
  const Outcome got = replayed({scene("topic: ball/pose"), path("odometry.bag")});
  EXPECT_EQ(got.code, 2);
  for (const char* part : {"'lab, of topic /ball/pose'", "world_frame 'world'", "elsewhere"})
    EXPECT_NE(got.err.find(part), std::string::npos) << got.err;
}

TEST_F(Sources, aTopicWithTwoTypesIsRefusedByNamingBoth) {
  {
    rosbag::Bag bag(path("pose.bag"), rosbag::bagmode::Write),
        more(path("odometry.bag"), rosbag::bagmode::Write);
    bag.write("/ball/pose", after(0), ballPose(0));
    more.write("/ball/pose", after(1), nav_msgs::Odometry());
  }
  const Outcome got = replayed({scene("topic: ball/pose"), path("pose.bag"), path("odometry.bag")});
  EXPECT_EQ(got.code, 2);
  for (const char* part : {"geometry_msgs/PoseStamped", "nav_msgs/Odometry", "/ball/pose"})
    EXPECT_NE(got.err.find(part), std::string::npos) << got.err;
}

TEST_F(Sources, gazeboModelsGiveEventsThatAreNotCertified) {
  {
    rosbag::Bag bag(path("gazebo.bag"), rosbag::bagmode::Write);
    for (std::int64_t ms = 0; ms <= 2000; ms += 20) {
      test_support::ModelStates states;
      states.name = {"ground_plane", "ball"};
      states.pose.resize(2);
      states.twist.resize(2);
      states.pose[1].position.x = -10.0 + 20.0 * 1e-3 * static_cast<double>(ms);
      states.pose[1].orientation.w = 1.0;
      bag.write("/gazebo/model_states", after(ms * kMs), states);
    }
  }
  const Outcome got =
      replayed({scene("topic: gazebo/model_states, model: ball"), path("gazebo.bag"), "--jsonl", "-"});
  ASSERT_EQ(got.code, 0) << got.err;
  const auto events = lines(got.out);
  ASSERT_EQ(events.size(), 2u) << got.out;
  EXPECT_NEAR(instantOf(events[0]), (10.0 - 0.6) / 20.0, 2e-9);
  for (const auto& event : events) {
    EXPECT_EQ(event["certificate"].as<std::string>(), "UNCERTIFIED");
    EXPECT_EQ(event["reason"].as<std::string>(), "STAMP_GUESSED");
  }
}

/// The same poses one by one, as a path that grows, and as a whole at once, far ahead of the wall.
TEST_F(Sources, aPathSaysWhatItsPosesSay) {
  const auto poseOf = [](std::int64_t ms) {
    geometry_msgs::PoseStamped pose;
    pose.header.frame_id = "world";
    pose.header.stamp = after(ms * kMs);
    pose.pose.position.x = 3.0 * std::sin(4e-3 * static_cast<double>(ms));
    pose.pose.orientation.w = 1.0;
    return pose;
  };
  constexpr std::int64_t kEnd = 3000;
  std::vector<std::string> results;
  for (const std::string how : {"one by one", "growing", "whole"}) {
    {
      rosbag::Bag bag(path("path.bag"), rosbag::bagmode::Write);
      nav_msgs::Path all;
      all.header.frame_id = "world";
      for (std::int64_t ms = 0; ms <= kEnd; ms += 20) {
        const auto pose = poseOf(ms);
        all.poses.push_back(pose);
        if (how == "one by one") bag.write("/ball", after(ms * kMs), pose);
        if (how == "growing" && ms % 100 == 0) bag.write("/ball", after(ms * kMs), all);
        if (how == "whole" && ms == kEnd) bag.write("/ball", after(0), all);
        auto wall = pose;
        wall.pose.position.x = 1e-4 * static_cast<double>(ms);
        bag.write("/wall", after(ms * kMs), wall);
      }
    }
    const Outcome got = replayed({scene("topic: ball", "topic: wall"), path("path.bag"), "--jsonl", "-"});
    EXPECT_EQ(got.code, 0) << got.err;
    results.push_back(got.out);
  }
  EXPECT_GE(lines(results[0]).size(), 6u);
  EXPECT_EQ(results[1], results[0]);
  EXPECT_EQ(results[2], results[0]);
}

TEST_F(Sources, aPlanIsRefused) {
  {
    rosbag::Bag bag(path("plan.bag"), rosbag::bagmode::Write);
    nav_msgs::Path plan;
    plan.header.frame_id = "world";
    plan.poses.resize(4);
    bag.write("/ball", after(0), plan);
  }
  const Outcome got = replayed({scene("topic: ball"), path("plan.bag")});
  EXPECT_EQ(got.code, 2);
  EXPECT_NE(got.err.find(
                "topic /ball (object 'ball'): all 4 poses of a nav_msgs/Path have the stamp 0.000000000 s: "
                "a plan, not a track"),
            std::string::npos)
      << got.err;
}

}  // namespace
}  // namespace collision_node::test

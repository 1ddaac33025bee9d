#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "collision_node/messages/tf_tree.h"

namespace collision_node::messages {
namespace {

using geometry::Pose;
using geometry::Quat;
using geometry::Vec3;

Pose shift(double x, double y = 0) { return {Vec3(x, y, 0), Quat::Identity()}; }
const Pose kQuarterLeft{Vec3::Zero(), Quat(Eigen::AngleAxisd(std::acos(0.0), Vec3::UnitZ()))};

/// A tree that is fed by short words.
struct Tree {
  struct Tf : TfTree {
    using TfTree::add;
    using TfTree::TfTree;
    void add(const std::string& parent, const std::string& child, Nanoseconds stamp_ns, const Pose& pose,
             bool is_static) {
      motion::StampedPose stamped;
      stamped.stamp_ns = stamp_ns;
      stamped.pose = pose;
      TfTree::add(parent, child, stamped, is_static ? StampKind::kAlways : StampKind::kSent);
    }
  };
  std::vector<std::pair<int, motion::StampedPose>> out;
  std::vector<StampKind> kinds;
  Tf tf{"world", scene::TimeOptions(), [this](int object, const motion::StampedPose& pose, StampKind kind) {
          out.emplace_back(object, pose);
          kinds.push_back(kind);
        }};
};

TEST(TfTree, oneMovingEdgeKeepsItsNumbersAndStamps) {
  Tree t;
  t.tf.follow(4, "drone");
  const Quat sent(0.9999999, 1e-4, 2e-4, 3e-4);
  t.tf.add("world", "drone", 1'700'000'000'000'000'001, {Vec3(0.1, 0.2, 0.3), sent}, false);
  ASSERT_EQ(t.out.size(), 1u);
  EXPECT_EQ(t.out[0].first, 4);
  EXPECT_EQ(t.out[0].second.stamp_ns, 1'700'000'000'000'000'001);
  EXPECT_EQ(t.out[0].second.pose.position, Vec3(0.1, 0.2, 0.3));
  EXPECT_EQ(t.out[0].second.pose.orientation.coeffs(), sent.coeffs());
}

TEST(TfTree, staticEdgesAreComposedOnBothSides) {
  Tree t;
  t.tf.follow(0, "tool");
  t.tf.add("world", "map", 0, shift(100), true);
  t.tf.add("base", "tool", 0, shift(1), true);
  t.tf.add("map", "base", 5, {Vec3(0, 10, 0), kQuarterLeft.orientation}, false);
  t.tf.flush();  // a lever behind a turning edge: its path is composed
  ASSERT_EQ(t.out.size(), 1u);
  EXPECT_LT((t.out[0].second.pose.position - Vec3(100, 11, 0)).norm(), 1e-13);
  EXPECT_EQ(t.out[0].second.stamp_ns, 5);
}

TEST(TfTree, samplesBeforeTheChainIsKnownAreKeptInOrder) {
  Tree t;
  t.tf.follow(0, "tool");
  t.tf.add("world", "base", 1, shift(1), false);
  t.tf.add("world", "base", 2, shift(2), false);
  EXPECT_TRUE(t.out.empty());
  EXPECT_EQ(t.tf.unresolved(), std::vector<std::string>{"tool"});
  t.tf.add("base", "tool", 0, shift(0, 5), true);
  t.tf.add("world", "base", 3, shift(3), false);
  t.tf.flush();
  ASSERT_EQ(t.out.size(), 3u);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(t.out[i].second.stamp_ns, i + 1);
    EXPECT_EQ(t.out[i].second.pose.position, Vec3(i + 1, 5, 0));
  }
  EXPECT_TRUE(t.tf.unresolved().empty());
}

TEST(TfTree, theWorldMayHangBelowTheCommonRoot) {
  Tree t;
  t.tf.follow(0, "car");
  t.tf.add("earth", "world", 0, {Vec3(10, 0, 0), kQuarterLeft.orientation}, true);
  t.tf.add("earth", "car", 7, shift(10, 3), false);
  ASSERT_EQ(t.out.size(), 1u);
  EXPECT_LT((t.out[0].second.pose.position - Vec3(3, 0, 0)).norm(), 1e-13);
  // The world itself moving below the root is a moving edge too, walked backwards.
  Tree u;
  u.tf.follow(0, "house");
  u.tf.add("earth", "house", 0, shift(1), true);
  u.tf.add("earth", "world", 9, {Vec3(0, 2, 0), kQuarterLeft.orientation}, false);
  u.tf.flush();
  ASSERT_EQ(u.out.size(), 1u);
  EXPECT_LT((u.out[0].second.pose.position - Vec3(-2, -1, 0)).norm(), 1e-13);
}

TEST(TfTree, badSamplesAreHandedOnAsTheyAre) {
  Tree t;
  t.tf.follow(0, "tool");
  t.tf.add("base", "tool", 0, shift(1), true);
  t.tf.add("world", "base", 1, {Vec3::Zero(), Quat(0, 0, 0, 0)}, false);
  ASSERT_EQ(t.out.size(), 1u);
  EXPECT_EQ(t.out[0].second.pose.orientation.norm(), 0.0);
}

TEST(TfTree, otherFramesDoNotMatter) {
  Tree t;
  t.tf.follow(0, "drone");
  t.tf.add("world", "bird", 1, shift(1), false);
  t.tf.add("world", "drone", 2, shift(2), false);
  t.tf.add("world", "bird", 3, shift(1), false);
  ASSERT_EQ(t.out.size(), 1u);
  EXPECT_EQ(t.out[0].second.stamp_ns, 2);
  EXPECT_EQ(t.tf.frames(), (std::vector<std::string>{"bird", "drone", "world"}));
}

TEST(TfTree, severalMovingEdgesAreComposedAtTheUnionOfTheirStamps) {
  constexpr motion::Nanoseconds kMs = 1'000'000;
  Tree t;
  t.tf.follow(0, "tool");
  t.tf.add("base", "tool", 0, shift(0, 1), true);
  for (int i = 0; i <= 5; ++i) t.tf.add("odom", "base", 20 * i * kMs, shift(i), false);
  for (int i = 0; i <= 2; ++i) t.tf.add("world", "odom", 45 * i * kMs, shift(100 * i), false);
  EXPECT_TRUE(t.out.empty()) << "an older sample may still come";
  t.tf.flush();
  std::vector<motion::Nanoseconds> stamps;
  for (const auto& entry : t.out) stamps.push_back(entry.second.stamp_ns / kMs);
  EXPECT_EQ(stamps, (std::vector<motion::Nanoseconds>{0, 20, 40, 45, 60, 80, 90}));
  for (const auto& entry : t.out) {
    const double ms = static_cast<double>(entry.second.stamp_ns / kMs);
    EXPECT_NEAR(entry.second.pose.position.x(), ms / 20 + 100 * ms / 45, 1e-12);
    EXPECT_EQ(entry.second.pose.position.y(), 1.0);
  }
}

TEST(TfTree, samplesKeptOfSeveralEdgesAreHandedOutInTheOrderOfArrival) {
  constexpr motion::Nanoseconds kMs = 1'000'000;
  Tree t;
  t.tf.follow(0, "tool");
  // Far longer than an edge is waited for: one edge after the other would lose the second.
  for (int i = 0; i <= 100; ++i) {
    t.tf.add("odom", "base", 100 * i * kMs, shift(i), false);
    t.tf.add("world", "odom", 100 * i * kMs, shift(i), false);
  }
  t.tf.add("base", "tool", 0, shift(0, 1), true);
  t.tf.flush();
  ASSERT_EQ(t.out.size(), 101u);
  EXPECT_EQ(t.out.back().second.pose.position, Vec3(200, 1, 0));
}

TEST(TfTree, aFrameThatNeverMovesStandsForAllTime) {
  Tree t;
  t.tf.follow(3, "wall");
  t.tf.add("map", "wall", 0, shift(1), true);
  EXPECT_TRUE(t.out.empty());
  t.tf.add("world", "map", 0, shift(10), true);
  ASSERT_EQ(t.out.size(), 1u);
  EXPECT_EQ(t.kinds[0], StampKind::kAlways);
  EXPECT_EQ(t.out[0].first, 3);
  EXPECT_EQ(t.out[0].second.pose.position, Vec3(11, 0, 0));
}

TEST(TfTree, staticEdgesBeforeAMovingOneTurnItsTwist) {
  Tree t;
  t.tf.follow(0, "ball");
  t.tf.add("world", "map", 0, {Vec3(10, 0, 0), kQuarterLeft.orientation}, true);
  motion::StampedPose pose;
  pose.stamp_ns = 5;
  pose.has_twist = true;
  pose.linear = Vec3(3, 0, 0);
  pose.angular = Vec3(0, 0, 2);
  t.tf.add("map", "ball", pose, StampKind::kGuessed);
  ASSERT_EQ(t.out.size(), 1u) << "straight and slerp stay what they are: no need to wait";
  EXPECT_EQ(t.kinds[0], StampKind::kGuessed);
  EXPECT_LT((t.out[0].second.linear - Vec3(0, 3, 0)).norm(), 1e-15);
  EXPECT_EQ(t.out[0].second.angular, Vec3(0, 0, 2));
}

TEST(TfTree, refusesWhatIsNoTree) {
  Tree t;
  t.tf.follow(0, "a");
  t.tf.add("world", "a", 1, shift(1), false);
  EXPECT_THROW(t.tf.add("map", "a", 2, shift(1), false), TfError);
  EXPECT_THROW(t.tf.add("world", "a", 2, shift(1), true), TfError);
  EXPECT_THROW(t.tf.add("a", "a", 2, shift(1), false), TfError);
  Tree c;
  c.tf.follow(0, "c");
  EXPECT_THROW(c.tf.add("world", "c", 0, {Vec3::Zero(), Quat(2, 0, 0, 0)}, true), TfError);
}

TEST(TfTree, faultsOfOtherFramesDoNotMatter) {
  Tree t;
  t.tf.follow(0, "tool");
  t.tf.add("world", "cup", 1, shift(1), false);
  t.tf.add("hand", "cup", 2, shift(1), false);  // grasped: another parent
  t.tf.add("world", "cup", 3, shift(1), true);  // both kinds
  t.tf.add("dog", "dog", 4, shift(1), false);   // its own parent
  t.tf.add("world", "cat", 0, {Vec3::Zero(), Quat(2, 0, 0, 0)}, true);
  t.tf.add("base", "tool", 0, shift(1), true);
  t.tf.add("world", "base", 5, shift(2), false);
  t.tf.add("hand", "cup", 6, shift(1), false);
  t.tf.flush();
  ASSERT_EQ(t.out.size(), 1u);
  EXPECT_EQ(t.out[0].second.pose.position, Vec3(3, 0, 0));
}

TEST(TfTree, aFaultMattersWhenTheChainComesToRunThroughIt) {
  Tree t;
  t.tf.follow(0, "tool");
  t.tf.add("world", "base", 1, shift(1), false);
  t.tf.add("map", "base", 2, shift(1), false);  // nobody knows yet that tool hangs on base
  try {
    t.tf.add("base", "tool", 0, shift(1), true);
    FAIL() << "a frame with two parents was followed";
  } catch (const TfError& error) {
    EXPECT_NE(std::string(error.what()).find("'base' had the parent 'world'"), std::string::npos)
        << error.what();
  }
  Tree u;
  u.tf.follow(0, "tool");
  u.tf.add("world", "arm", 0, {Vec3::Zero(), Quat(2, 0, 0, 0)}, true);
  EXPECT_THROW(u.tf.add("arm", "tool", 1, shift(1), false), TfError);
  u.tf.add("world", "arm", 0, shift(5), true);  // sent again, and good
  ASSERT_EQ(u.out.size(), 1u);
  EXPECT_EQ(u.out[0].second.pose.position, Vec3(6, 0, 0));
}

}  // namespace
}  // namespace collision_node::messages

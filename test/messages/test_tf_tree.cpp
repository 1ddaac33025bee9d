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

struct Tree {
  std::vector<std::pair<int, motion::StampedPose>> out;
  TfTree tf{"world", [this](int object, const motion::StampedPose& pose) { out.emplace_back(object, pose); }};
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

TEST(TfTree, limit_severalMovingEdgesAreRefused) {
  Tree t;
  t.tf.follow(0, "tool");
  t.tf.add("world", "base", 1, shift(1), false);
  try {
    t.tf.add("base", "tool", 1, shift(1), false);
    FAIL() << "two moving edges were taken";
  } catch (const TfError& error) {
    EXPECT_NE(std::string(error.what()).find("'base' to 'tool'"), std::string::npos) << error.what();
  }
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
  Tree u;
  u.tf.follow(0, "wall");
  EXPECT_THROW(u.tf.add("world", "wall", 0, shift(1), true), TfError) << "a frame that never moves";
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

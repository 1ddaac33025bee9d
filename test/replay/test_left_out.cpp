/// Objects in no watched pair: what replay says is what it says without them.
#include <gtest/gtest.h>
#include <rosbag/view.h>

#include <set>

#include "test/replay/bags.h"

namespace collision_node::test {
namespace {

/// A ball that hits a wall; the idler's bag goes back in time, the scout hangs on a frame that tf never
/// connects, and nobody has ever heard of the ghost. The vase is no mesh.
class LeftOut : public testing::Test {
 protected:
  LeftOut() {
    plain_ = folder_.write("plain.yaml", kScene);
    folder_.write("vase.obj", "this is no mesh");
    std::string text = kScene;
    text.insert(text.find("  wall:"), R"(  ghost: {sphere: {radius: 1}, pose: {topic: ghost}}
  idler: {sphere: {radius: 100}, pose: {topic: idler}}
  scout: {sphere: {radius: 1}, pose: {tf: scout}}
  vase: {mesh: {file: vase.obj}, pose: {fixed: {}}}
)");
    more_ = folder_.write("more.yaml", text + "pairs: {only: [[ball, wall]]}\n");
    bag_ = folder_.path() + "/in.bag";
    rosbag::Bag bag(bag_, rosbag::bagmode::Write);
    for (int i = 0; i < 60; ++i) {
      const auto pose = ballPose(i);
      bag.write("/ball/pose", pose.header.stamp, pose);
      auto idle = ballPose(i % 20 * 4);
      idle.pose.orientation.w = i == 7 ? 0.0 : 1.0;
      bag.write("/idler", pose.header.stamp, idle);
      bag.write("/tf", pose.header.stamp, transform("nowhere", "scout", 0, i));
    }
  }

  test_support::TempFolder folder_;
  std::string plain_, more_, bag_;
};

TEST_F(LeftOut, changesNoByte) {
  const std::string expected = replayed({plain_, bag_, "--jsonl", "-"}).out;
  ASSERT_NE(expected.find("IMPACT"), std::string::npos);
  for (const std::vector<std::string>& plan : {std::vector<std::string>{}, {"--plan", "full"}}) {
    std::vector<std::string> arguments = {more_, bag_, "--jsonl", "-"};
    arguments.insert(arguments.end(), plan.begin(), plan.end());
    const Outcome got = replayed(arguments);
    EXPECT_EQ(got.code, 0) << got.err;
    EXPECT_EQ(got.out, expected);
    EXPECT_EQ(got.err, "");
  }
  EXPECT_EQ(replayed({more_, bag_}).out, replayed({plain_, bag_}).out) << "counted and named like the rest";
}

TEST_F(LeftOut, isNotInTheResultBagEither) {
  const std::string out = folder_.path() + "/out.bag";
  ASSERT_EQ(replayed({more_, bag_, "--out", out}).code, 0);
  std::set<std::string> topics;
  rosbag::Bag bag(out);
  rosbag::View view(bag);
  for (const auto* connection : view.getConnections()) topics.insert(connection->topic);
  EXPECT_EQ(topics, (std::set<std::string>{"/ball/pose", "/collision_node/impacts", "/collision_node/markers",
                                           "/collision_node/plan", "/collision_node/stats"}));
}

TEST_F(LeftOut, isNamedByThePlanWithItsReason) {
  const Outcome got = replayed({more_, "--plan"});
  EXPECT_EQ(got.code, 0) << got.err;
  for (const char* line : {
           "  ghost: in no watched pair (not listed in pairs/only): no hierarchy is built, its poses are "
           "neither read "
           "nor waited for\n",
           "  idler: in no watched pair",
           "  scout: in no watched pair",
           "      shape 0: mesh vase.obj, at [0, 0, 0] m\n        not read: the object is in no watched "
           "pair\n",
           "  no object is driven through tf: no transforms are read\n",
       })
    EXPECT_NE(got.out.find(line), std::string::npos) << line << "in\n" << got.out;
}

TEST_F(LeftOut, aSceneWithoutAnyPairReadsNothingAndSaysSo) {
  const std::string scene = folder_.write("none.yaml", std::string(kScene) + "pairs: {only: []}\n");
  const Outcome got = replayed({scene, bag_});
  EXPECT_EQ(got.code, 0) << got.err;
  EXPECT_NE(got.err.find("no pair is watched: no pose is read, nothing can be reported"), std::string::npos)
      << got.err;
  EXPECT_NE(got.out.find("0 events\nposes: 0 accepted"), std::string::npos) << got.out;
}

}  // namespace
}  // namespace collision_node::test

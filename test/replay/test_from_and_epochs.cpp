/// Cut bags, bags in a loop, bags with some bad messages: what is used, and where results lie in the result
/// bag.
#include <gtest/gtest.h>
#include <rosbag/view.h>
#include <tf2_msgs/TFMessage.h>

#include <algorithm>
#include <functional>
#include <map>

#include "collision_node/Impact.h"
#include "collision_node/IntervalStats.h"
#include "test/replay/bags.h"

namespace collision_node::test {
namespace {

class Cut : public testing::Test {
 protected:
  Cut() { scene_ = folder_.write("scene.yaml", kScene); }
  std::string path(const std::string& name) const { return folder_.path() + "/" + name; }

  /// The ball of the scene, driven through tf, with a static transform at the start of the recording.
  std::string writeTf(const std::string& name,
                      const std::function<void(int, tf2_msgs::TFMessage&)>& change = {}) {
    rosbag::Bag bag(path(name), rosbag::bagmode::Write);
    tf2_msgs::TFMessage fixed, moving;
    fixed.transforms.resize(1);
    fixed.transforms[0].header.frame_id = "ball";
    fixed.transforms[0].child_frame_id = "core";
    fixed.transforms[0].transform.rotation.w = 1.0;
    bag.write("/tf_static", ballPose(0).header.stamp, fixed);
    for (int i = 0; i < 60; ++i) {
      moving.transforms.assign(1, {});
      auto& t = moving.transforms[0];
      t.header = ballPose(i).header;
      t.child_frame_id = "ball";
      t.transform.translation.x = ballPose(i).pose.position.x;
      t.transform.rotation.w = 1.0;
      if (change) change(i, moving);
      bag.write("/tf", t.header.stamp, moving);
    }
    return path(name);
  }

  std::string tfScene() {
    std::string text = kScene;
    text.replace(text.find("topic: ball/pose"), 16, "tf: core");
    return folder_.write("tf.yaml", text);
  }

  test_support::TempFolder folder_;
  std::string scene_;
};

std::size_t linesIn(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

TEST_F(Cut, staticTransformsAreReadFromTheStart) {
  const std::string bag = writeTf("tf.bag");
  const Outcome got = replayed({tfScene(), bag, "--from", "0.05", "--jsonl", "-", "--out", path("out.bag")});
  EXPECT_EQ(got.code, 0) << got.err;
  EXPECT_EQ(linesIn(got.out), 4u) << got.out;
  // The result bag is an input like the recording, and nothing in it lies before --from. Where the window was
  // cut stands before and behind its events.
  const std::string events = replayed({tfScene(), path("out.bag"), "--jsonl", "-"}).out;
  EXPECT_EQ(linesIn(events), 2u);
  EXPECT_NE(got.out.find("\n" + events), std::string::npos) << got.out;
  rosbag::Bag out(path("out.bag"));
  rosbag::View all(out), fixed(out, rosbag::TopicQuery("/tf_static"));
  EXPECT_EQ(fixed.size(), 1u);
  EXPECT_EQ(all.getBeginTime(), ballPose(0).header.stamp + ros::Duration(0.05));
}

TEST_F(Cut, tfFaultsOfOtherFramesStopNothing) {
  const std::string good = replayed({tfScene(), writeTf("good.bag"), "--jsonl", "-"}).out;
  const std::string bag = writeTf("other.bag", [](int i, tf2_msgs::TFMessage& tf) {
    tf.transforms.push_back(tf.transforms[0]);
    tf.transforms[1].header.frame_id = i < 30 ? "table" : "hand";
    tf.transforms[1].child_frame_id = "cup";
  });
  const Outcome got = replayed({tfScene(), bag, "--jsonl", "-"});
  EXPECT_EQ(got.code, 0) << got.err;
  EXPECT_EQ(got.out, good);
  EXPECT_EQ(linesIn(good), 2u);
  EXPECT_EQ(got.err, "");
}

TEST_F(Cut, aMessageThatCannotBeUsedIsCountedAndToldAndNoError) {
  const std::string bag = path("frames.bag");
  {
    rosbag::Bag out(bag, rosbag::bagmode::Write);
    for (int i = 0; i < 60; ++i)
      out.write("/ball/pose", ballPose(i).header.stamp, ballPose(i, i == 40 || i == 41 ? "odom" : "world"));
  }
  const Outcome got = replayed({scene_, bag, "--out", path("out.bag")});
  EXPECT_EQ(got.code, 0) << got.err;
  EXPECT_NE(got.out.find("2 events"), std::string::npos) << got.out;
  EXPECT_NE(got.out.find("58 accepted"), std::string::npos) << got.out;
  EXPECT_NE(got.out.find("2 rejected"), std::string::npos) << got.out;
  EXPECT_EQ(linesIn(got.err), 1u) << got.err;
  for (const char* part : {"2 messages on /ball/pose", "'odom'", "'world'"})
    EXPECT_NE(got.err.find(part), std::string::npos) << got.err;
  rosbag::Bag out(path("out.bag"));
  std::uint64_t rejected = 0;
  for (const auto& m : rosbag::View(out, rosbag::TopicQuery("/collision_node/stats")))
    rejected = m.instantiate<IntervalStats>()->rejected;
  EXPECT_EQ(rejected, 2u);
}

TEST_F(Cut, rejectedPosesAreToldByTopic) {
  const std::string bag = path("nan.bag");
  {
    rosbag::Bag out(bag, rosbag::bagmode::Write);
    for (int i = 0; i < 60; ++i) {
      auto pose = ballPose(i);
      if (i == 50) pose.pose.orientation.w = 0.0;
      out.write("/ball/pose", pose.header.stamp, pose);
    }
  }
  const Outcome got = replayed({scene_, bag});
  EXPECT_EQ(got.code, 0);
  EXPECT_NE(got.err.find("1 pose on /ball/pose rejected"), std::string::npos) << got.err;
}

TEST_F(Cut, aTopicWithoutTheTwistsThatItsMotionIsMadeFromIsTold) {
  const std::string bag = path("twistless.bag");
  {
    rosbag::Bag out(bag, rosbag::bagmode::Write);
    for (int i = 0; i < 60; ++i) out.write("/ball/pose", ballPose(i).header.stamp, ballPose(i));
  }
  EXPECT_EQ(replayed({scene_, bag}).err, "");
  for (const char* motion : {"hermite", "spin"}) {
    std::string text = kScene;
    text.insert(text.find("    sphere"), std::string("    motion: ") + motion + "\n");
    const Outcome got = replayed({folder_.write("moved.yaml", text), bag});
    EXPECT_EQ(got.code, 0);
    EXPECT_NE(got.err.find("60 poses on /ball/pose without the twist"), std::string::npos) << got.err;
  }
}

TEST_F(Cut, aTopicWithoutStampsIsTold) {
  const std::string bag = path("unstamped.bag");
  {
    rosbag::Bag out(bag, rosbag::bagmode::Write);
    for (int i = 0; i < 60; ++i) {
      auto pose = ballPose(i);
      const ros::Time received = pose.header.stamp;
      pose.header.stamp = ros::Time();
      out.write("/ball/pose", received, pose);
    }
  }
  const Outcome got = replayed({scene_, bag});
  EXPECT_EQ(got.code, 0);
  EXPECT_NE(got.err.find("60 poses on /ball/pose have the stamp 0"), std::string::npos) << got.err;
}

/// Stamps run from the same start in every round; the recording goes on.
TEST_F(Cut, eachRoundOfALoopLiesAmongItsOwnInputs) {
  const std::string bag = path("loop.bag");
  constexpr int kRounds = 3, kPoses = 60;
  const ros::Duration round(2.5);
  {
    rosbag::Bag out(bag, rosbag::bagmode::Write);
    for (int k = 0; k < kRounds; ++k)
      for (int i = 0; i < kPoses; ++i) {
        ros::Time received = ballPose(i).header.stamp;
        for (int n = 0; n < k; ++n) received += round;
        out.write("/ball/pose", received, ballPose(i));
      }
  }
  ASSERT_EQ(replayed({scene_, bag, "--out", path("out.bag")}).code, 0);
  rosbag::Bag out(path("out.bag"));
  std::map<std::uint32_t, int> events, beats;
  for (const auto& m : rosbag::View(out)) {
    std::uint32_t epoch = 0;
    ros::Time expected;
    if (const auto impact = m.instantiate<Impact>()) {
      ++events[epoch = impact->epoch];
      expected = impact->header.stamp;
    } else if (const auto stats = m.instantiate<IntervalStats>()) {
      ++beats[epoch = stats->epoch];
      expected = stats->header.stamp;
    } else {
      continue;
    }
    for (std::uint32_t n = 0; n < epoch; ++n) expected += round;
    EXPECT_EQ(m.getTime(), expected) << m.getTopic() << " of epoch " << epoch;
  }
  EXPECT_EQ(events, (std::map<std::uint32_t, int>{{0, 2}, {1, 2}, {2, 2}}));
  EXPECT_EQ(beats.size(), 3u);
}

}  // namespace
}  // namespace collision_node::test

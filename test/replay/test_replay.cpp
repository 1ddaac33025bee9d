/// Replay as a whole: what it finds, what it writes, twice the same.
#include <geometry_msgs/TransformStamped.h>
#include <gtest/gtest.h>
#include <rosbag/view.h>
#include <std_msgs/String.h>
#include <tf2_msgs/TFMessage.h>
#include <visualization_msgs/MarkerArray.h>
#include <yaml-cpp/yaml.h>

#include <map>

#include "collision_node/Impact.h"
#include "collision_node/IntervalStats.h"
#include "test/replay/bags.h"

namespace collision_node::test {
namespace {

class Replay : public testing::Test {
 protected:
  Replay() {
    scene_ = folder_.write("scene.yaml", kScene);
    bag_ = path("in.bag");
    writeBall(bag_);
  }
  std::string path(const std::string& name) const { return folder_.path() + "/" + name; }

  test_support::TempFolder folder_;
  std::string scene_, bag_;
};

std::vector<YAML::Node> lines(const std::string& text) {
  std::vector<YAML::Node> out;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) out.push_back(YAML::Load(line));
  return out;
}

TEST_F(Replay, findsWhatNoStampShows) {
  const Outcome got = replayed({scene_, bag_, "--jsonl", "-"});
  ASSERT_EQ(got.code, 0) << got.err;
  const auto events = lines(got.out);
  ASSERT_EQ(events.size(), 2u) << got.out;
  EXPECT_EQ(events[0]["kind"].as<std::string>(), "IMPACT");
  EXPECT_EQ(events[0]["certificate"].as<std::string>(), "CONFIRMED");
  EXPECT_EQ(events[0]["a"]["object"].as<std::string>(), "ball");
  EXPECT_EQ(events[0]["b"]["object"].as<std::string>(), "wall");
  EXPECT_EQ(events[1]["kind"].as<std::string>(), "SEPARATION");
  EXPECT_EQ(events[1]["contact_id"].as<int>(), events[0]["contact_id"].as<int>());
  // The ball touches at x = -0.6, 99.7 ms after the start, and is free again at x = 0.6.
  EXPECT_NEAR(static_cast<double>(events[0]["header"]["stamp"].as<std::int64_t>() - kFirstNs), 99.7e6, 2.0);
  EXPECT_NEAR(static_cast<double>(events[1]["header"]["stamp"].as<std::int64_t>() - kFirstNs), 100.9e6, 2.0);
}

TEST_F(Replay, printsATableAndASummary) {
  const Outcome got = replayed({scene_, bag_});
  EXPECT_EQ(got.code, 0);
  EXPECT_NE(got.out.find("CONFIRMED"), std::string::npos) << got.out;
  EXPECT_NE(got.out.find("2 events"), std::string::npos) << got.out;
  EXPECT_NE(got.out.find("60 accepted"), std::string::npos) << got.out;
  EXPECT_EQ(got.err, "");
}

TEST_F(Replay, sameBagSameSceneSameBytes) {
  std::vector<std::string> bytes[2];
  for (int i = 0; i < 2; ++i) {
    const std::string base = path("run" + std::to_string(i));
    const Outcome got = replayed({scene_, bag_, "--jsonl", base + ".jsonl", "--csv", base + ".csv", "--out",
                                  base + ".bag", "--threads", std::to_string(1 + i)});
    ASSERT_EQ(got.code, 0) << got.err;
    bytes[i] = {got.out, bytesOf(base + ".jsonl"), bytesOf(base + ".csv"), bytesOf(base + ".bag")};
    for (const auto& part : bytes[i]) EXPECT_FALSE(part.empty());
    EXPECT_FALSE(std::filesystem::exists(base + ".bag.part"));
  }
  for (std::size_t part = 0; part < bytes[0].size(); ++part)
    EXPECT_TRUE(bytes[0][part] == bytes[1][part]) << part;
}

TEST_F(Replay, planFullGivesTheSameEvents) {
  const Outcome full = replayed({scene_, bag_, "--plan", "full", "--jsonl", "-"});
  EXPECT_EQ(full.code, 0) << full.err;
  EXPECT_EQ(full.out, replayed({scene_, bag_, "--jsonl", "-"}).out);
  EXPECT_EQ(full.out, replayed({scene_, bag_, "--plan=full", "--jsonl", "-"}).out);
  EXPECT_EQ(replayed({scene_, bag_, "--plan=some"}).code, 2);
}

TEST_F(Replay, theResultBagHoldsResultsAndInputs) {
  ASSERT_EQ(replayed({scene_, bag_, "--out", path("out.bag")}).code, 0);
  rosbag::Bag bag(path("out.bag"));
  rosbag::View view(bag);
  std::map<std::string, int> count;
  bool cleared_first = false;
  for (const auto& m : view) {
    const std::string topic = m.getTopic();
    if (++count[topic] == 1 && topic == "/collision_node/markers") {
      const auto markers = m.instantiate<visualization_msgs::MarkerArray>();
      ASSERT_TRUE(markers);
      cleared_first = markers->markers.at(0).action == visualization_msgs::Marker::DELETEALL;
    }
    if (const auto impact = m.instantiate<Impact>()) {
      EXPECT_EQ(m.getTime(), impact->header.stamp) << "stamps and receive times agree in this bag";
    }
    if (const auto stats = m.instantiate<IntervalStats>()) {
      EXPECT_TRUE(std::isnan(stats->wall_time));
      // The bins add up to the one pair there is.
      EXPECT_EQ(stats->pairs_culled + stats->pairs_clear + stats->pairs_impact + stats->pairs_undecided +
                    stats->pairs_uncovered,
                1u);
    }
  }
  EXPECT_TRUE(cleared_first);
  EXPECT_EQ(count["/ball/pose"], 60);
  EXPECT_EQ(count["/collision_node/impacts"], 2);
  EXPECT_EQ(count["/collision_node/plan"], 1);
  EXPECT_GT(count["/collision_node/stats"], 0);
  for (const rosbag::ConnectionInfo* c : view.getConnections()) {
    EXPECT_FALSE(c->datatype.empty()) << c->topic;
    const bool latched = c->header->count("latching") != 0 && c->header->at("latching") == "1";
    EXPECT_EQ(latched, c->topic == "/collision_node/plan") << c->topic;
  }
}

TEST_F(Replay, aResultBagIsAnInputToo) {
  ASSERT_EQ(replayed({scene_, bag_, "--out", path("out.bag")}).code, 0);
  EXPECT_EQ(replayed({scene_, path("out.bag"), "--jsonl", "-"}).out,
            replayed({scene_, bag_, "--jsonl", "-"}).out);
}

TEST_F(Replay, eventsStandAmongTheInputsEvenWhenStampsAreOfAnotherTime) {
  const std::string late = path("late.bag");
  {
    rosbag::Bag bag(late, rosbag::bagmode::Write);
    for (int i = 0; i < 60; ++i)
      bag.write("/ball/pose", ballPose(i).header.stamp + ros::Duration(1e6), ballPose(i));
  }
  ASSERT_EQ(replayed({scene_, late, "--out", path("out.bag")}).code, 0);
  rosbag::Bag bag(path("out.bag"));
  rosbag::View view(bag, rosbag::TopicQuery("/collision_node/impacts"));
  ASSERT_EQ(view.size(), 2u);
  for (const auto& m : view)
    EXPECT_EQ(m.getTime(), m.instantiate<Impact>()->header.stamp + ros::Duration(1e6));
}

TEST_F(Replay, wallTimeOnlyWhenAsked) {
  const Outcome got = replayed({scene_, bag_, "--out", path("out.bag"), "--timing"});
  EXPECT_NE(got.err.find("60 messages in"), std::string::npos) << got.err;
  rosbag::Bag bag(path("out.bag"));
  rosbag::View view(bag, rosbag::TopicQuery("/collision_node/stats"));
  ASSERT_GT(view.size(), 0u);
  for (const auto& m : view) EXPECT_GE(m.instantiate<IntervalStats>()->wall_time, 0.0);
}

TEST_F(Replay, fromAndToCutTheBag) {
  EXPECT_NE(replayed({scene_, bag_, "--from", "0.5"}).out.find("0 events"), std::string::npos);
  EXPECT_NE(replayed({scene_, bag_, "--to", "0.05"}).out.find("0 events"), std::string::npos);
  const Outcome got = replayed({scene_, bag_, "--from", "0.0", "--to", "0.2"});
  EXPECT_NE(got.out.find("2 events"), std::string::npos) << got.out;
  EXPECT_NE(got.out.find(" 7 accepted"), std::string::npos) << got.out;
}

TEST_F(Replay, severalBagsAreOneRecording) {
  // One bag's poses dealt out to two, every other one to each.
  const std::string even = path("even.bag"), odd = path("odd.bag");
  {
    rosbag::Bag a(even, rosbag::bagmode::Write), b(odd, rosbag::bagmode::Write);
    for (int i = 0; i < 60; ++i)
      (i % 2 == 0 ? a : b).write("/ball/pose", ballPose(i).header.stamp, ballPose(i));
  }
  EXPECT_EQ(replayed({scene_, even, odd, "--jsonl", "-"}).out, replayed({scene_, bag_, "--jsonl", "-"}).out);
}

TEST_F(Replay, relativeTopicsLieInTheNamespace) {
  writeBall(path("robot.bag"), 60, "/robot/ball/pose");
  const Outcome got = replayed({scene_, path("robot.bag"), "--ns", "robot", "--jsonl", "-"});
  EXPECT_EQ(got.code, 0) << got.err;
  EXPECT_EQ(lines(got.out).size(), 2u);
}

TEST_F(Replay, planNeedsNoBag) {
  const Outcome got = replayed({scene_, "--plan"});
  EXPECT_EQ(got.code, 0) << got.err;
  EXPECT_NE(got.out.find("ball"), std::string::npos);
  const std::string out = path("out.bag");
  ASSERT_EQ(replayed({scene_, bag_, "--out", out}).code, 0);
  rosbag::Bag bag(out);
  rosbag::View view(bag, rosbag::TopicQuery("/collision_node/plan"));
  EXPECT_EQ(view.begin()->instantiate<std_msgs::String>()->data, got.out);
}

TEST_F(Replay, thePapersMethodsRun) {
  const Outcome got = replayed({scene_, bag_, "--method", "paper_a", "--jsonl", "-"});
  ASSERT_EQ(got.code, 0) << got.err;
  for (const auto& event : lines(got.out)) EXPECT_EQ(event["certificate"].as<std::string>(), "UNCERTIFIED");
}

TEST_F(Replay, tfDrivesAnObject) {
  std::string text = kScene;
  text.replace(text.find("topic: ball/pose"), std::string("topic: ball/pose").size(), "tf: ball/core");
  const std::string scene = folder_.write("tf.yaml", text);
  const std::string tf_bag = path("tf.bag");
  {
    rosbag::Bag bag(tf_bag, rosbag::bagmode::Write);
    tf2_msgs::TFMessage fixed, moving;
    fixed.transforms.resize(1);
    fixed.transforms[0].header.frame_id = "ball";
    fixed.transforms[0].child_frame_id = "ball/core";
    fixed.transforms[0].transform.rotation.w = 1.0;
    fixed.transforms[0].transform.translation.y = 3.0;
    bag.write("/tf_static", ballPose(0).header.stamp, fixed);
    moving.transforms.resize(1);
    for (int i = 0; i < 60; ++i) {
      auto& t = moving.transforms[0];
      t.header = ballPose(i).header;
      t.child_frame_id = "ball";
      t.transform.translation.x = ballPose(i).pose.position.x;
      t.transform.rotation.w = 1.0;
      bag.write("/tf", t.header.stamp, moving);
    }
  }
  const Outcome got = replayed({scene, tf_bag, "--jsonl", "-"});
  ASSERT_EQ(got.code, 0) << got.err;
  const auto events = lines(got.out);
  ASSERT_EQ(events.size(), 2u);
  EXPECT_NEAR(events[0]["position"]["y"].as<double>(), 3.0, 1e-6);
  EXPECT_NEAR(static_cast<double>(events[0]["header"]["stamp"].as<std::int64_t>() - kFirstNs), 99.7e6, 2.0);
}

TEST_F(Replay, badPosesAreCountedAndNoError) {
  const std::string bad = path("bad.bag");
  {
    rosbag::Bag bag(bad, rosbag::bagmode::Write);
    for (int i = 0; i < 60; ++i) {
      auto pose = ballPose(i);
      if (i % 10 == 5) pose.pose.orientation.w = 0.0;
      bag.write("/ball/pose", pose.header.stamp, pose);
    }
  }
  const Outcome got = replayed({scene_, bad});
  EXPECT_EQ(got.code, 0);
  EXPECT_NE(got.out.find("54 accepted"), std::string::npos) << got.out;
  EXPECT_NE(got.out.find("6 rejected"), std::string::npos) << got.out;
}

}  // namespace
}  // namespace collision_node::test

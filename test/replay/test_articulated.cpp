/// Robots whose links move by themselves, from bags to events: through tf frames, through joint states.
#include <gtest/gtest.h>
#include <sensor_msgs/JointState.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <functional>

#include "test/replay/bags.h"

#define EXPECT_HAS(text, part) \
  EXPECT_NE((text).find(part), std::string::npos) << "no \"" << (part) << "\" in:\n" << (text)

namespace collision_node::test {
namespace {

/// A turning arm, a ball of radius 0.1 m at its end, 1 m from the joint; the joint stands `offset` m in front
/// of the base.
std::string armUrdf(double offset) {
  return "<robot name='r'><link name='base'><collision><geometry><sphere "
         "radius='0.05'/></geometry></collision>"
         "</link><link name='arm'><collision><origin xyz='1 0 0'/><geometry><sphere radius='0.1'/></geometry>"
         "</collision></link><joint name='turn' type='revolute'><parent link='base'/><child link='arm'/>"
         "<origin xyz='" +
         std::to_string(offset) +
         " 0 0'/><axis xyz='0 0 1'/><limit lower='-9' upper='9' effort='1' velocity='9'/></joint></robot>";
}

/// Two fingers of radius 0.05 m that slide along x towards each other from -0.5 m and 0.5 m.
const char* const kFingers =
    "<robot name='r'><link name='base'/>"
    "<link name='left'><collision><geometry><sphere radius='0.05'/></geometry></collision></link>"
    "<link name='right'><collision><geometry><sphere radius='0.05'/></geometry></collision></link>"
    "<joint name='close' type='prismatic'><parent link='base'/><child link='left'/><origin xyz='-0.5 0 0'/>"
    "<axis xyz='1 0 0'/><limit lower='0' upper='1' effort='1' velocity='1'/></joint>"
    "<joint name='other' type='prismatic'><parent link='base'/><child link='right'/><origin xyz='0.5 0 0'/>"
    "<axis xyz='1 0 0'/><limit lower='-1' upper='0' effort='1' velocity='1'/>"
    "<mimic joint='close' multiplier='-1'/></joint></robot>";

sensor_msgs::JointState jointAt(std::int64_t ms, const std::string& name, double position) {
  sensor_msgs::JointState out;
  out.header.stamp = after(ms * kMs);
  out.name = {name};
  out.position = {position};
  return out;
}

geometry_msgs::PoseStamped baseAt(std::int64_t ms, double x, double yaw = 0.0) {
  geometry_msgs::PoseStamped out;
  out.header.stamp = after(ms * kMs);
  out.header.frame_id = "world";
  out.pose.position.x = x;
  out.pose.orientation.z = std::sin(0.5 * yaw);
  out.pose.orientation.w = std::cos(0.5 * yaw);
  return out;
}

class Articulated : public ::testing::Test {
 protected:
  std::string path(const std::string& name) const { return folder_.path() + "/" + name; }
  void write(const std::function<void(rosbag::Bag&)>& fill) const {
    rosbag::Bag bag(path("in.bag"), rosbag::bagmode::Write);
    fill(bag);
  }
  /// The robot and a ball of radius 0.1 m that stands at `target`.
  Outcome run(const std::string& urdf, const std::string& robot, const std::string& target,
              const std::string& pairs = "") {
    folder_.write("robot.urdf", urdf);
    const std::string scene = folder_.write(
        "scene.yaml", "objects:\n  robot: {urdf: robot.urdf, " + robot +
                          "}\n  target: {sphere: {radius: 0.1}, pose: {fixed: {position: " + target +
                          "}}}\ntime: {max_gap: 0.5, timeout: 0.7}\n" + pairs);
    return replayed({scene, path("in.bag"), "--jsonl", "-"});
  }
  static std::vector<YAML::Node> events(const Outcome& got) {
    EXPECT_EQ(got.code, 0) << got.err;
    std::istringstream in(got.out);
    std::vector<YAML::Node> out;
    for (std::string line; std::getline(in, line);) out.push_back(YAML::Load(line));
    return out;
  }
  static double seconds(const YAML::Node& event, const std::string& field) {
    return 1e-9 * static_cast<double>(event["interval_start"].as<std::int64_t>() - kFirstNs) +
           event[field].as<double>();
  }
  /// A CONFIRMED event of these links whose bracket, at most 1e-8 s wide, holds `truth`.
  static void expectAt(const YAML::Node& event, const std::string& kind, const std::string& a,
                       const std::string& b, double truth) {
    EXPECT_EQ(event["kind"].as<std::string>(), kind);
    EXPECT_EQ(event["certificate"].as<std::string>(), "CONFIRMED");
    EXPECT_EQ(event["a"]["link"].as<std::string>(), a);
    EXPECT_EQ(event["b"]["link"].as<std::string>(), b);
    constexpr double kPosesRounding = 1e-13;  // [s] the poses themselves are doubles
    EXPECT_LE(seconds(event, "toi_lower"), truth + kPosesRounding);
    EXPECT_GE(seconds(event, "toi_upper"), truth - kPosesRounding);
    EXPECT_LT(seconds(event, "toi_upper") - seconds(event, "toi_lower"), 1e-8);
  }
  test_support::TempFolder folder_;
};

constexpr double kQuarter = 1.5707963267948966;
/// Two balls of radius 0.1 m, each 1 m from the joint, touch at this angle between them.
const double kTouching = 2.0 * std::asin(0.1);

TEST_F(Articulated, aJointTurnsItsLinkIntoATarget) {
  write([](rosbag::Bag& bag) {
    for (int i = 0; i <= 10; ++i)
      bag.write("/joint_states", after(100 * i * kMs), jointAt(100 * i, "turn", 0.2 * i));
  });
  const auto got = events(run(armUrdf(0), "pose: {fixed: {}}, joints: {topic: joint_states}", "[0, 1, 0]"));
  ASSERT_EQ(got.size(), 2u);
  expectAt(got[0], "IMPACT", "arm", "target", (kQuarter - kTouching) / 2.0);
  expectAt(got[1], "SEPARATION", "arm", "target", (kQuarter + kTouching) / 2.0);
}

TEST_F(Articulated, tfFramesOfLinksDoTheSame) {
  write([](rosbag::Bag& bag) {
    bag.write("/tf_static", after(0), transform("world", "r/base", 0, 0.0));
    for (int i = 0; i <= 10; ++i)
      bag.write("/tf", after(100 * i * kMs), transform("r/base", "r/arm", 100 * i * kMs, 0.0, 0.0, 0.2 * i));
  });
  const auto got = events(run(armUrdf(0), "pose: {tf: r/base, links: true}", "[0, 1, 0]"));
  ASSERT_EQ(got.size(), 2u);
  expectAt(got[0], "IMPACT", "arm", "target", (kQuarter - kTouching) / 2.0);
  expectAt(got[1], "SEPARATION", "arm", "target", (kQuarter + kTouching) / 2.0);
}

/// Base and joint turn about the same axis, sent at different rates: the composition turns evenly.
TEST_F(Articulated, aMovingBaseCarriesItsJoints) {
  write([](rosbag::Bag& bag) {
    for (int ms = 0; ms <= 1050; ms += 10) {
      if (ms % 70 == 0) bag.write("/base", after(ms * kMs), baseAt(ms, 0.0, 5e-4 * ms));
      if (ms % 30 == 0) bag.write("/joint_states", after(ms * kMs), jointAt(ms, "turn", 1.5e-3 * ms));
    }
  });
  const char* const robot = "pose: {topic: base}, joints: {topic: joint_states}";
  const Outcome all = run(armUrdf(0), robot, "[0, 1, 0]");
  const auto got = events(all);
  ASSERT_EQ(got.size(), 2u);
  expectAt(got[0], "IMPACT", "arm", "target", (kQuarter - kTouching) / 2.0);
  // The base itself need not be in any pair.
  EXPECT_EQ(run(armUrdf(0), robot, "[0, 1, 0]", "pairs: {only: [[robot/arm, target]]}\n").out, all.out);
}

/// The joint stands in front of a base that turns: the link flies on a curve, and the straight line and slerp
/// between the union of the stamps is certified as such. The true instant is in the model's fields.
TEST_F(Articulated, theBoundOfTheDifferenceEntersTheModelFieldsOnly) {
  constexpr double kBase = 2.0, kJoint = 3.0;  // [rad/s]
  write([](rosbag::Bag& bag) {
    for (int ms = 0; ms <= 1050; ms += 10) {
      if (ms % 70 == 0) bag.write("/base", after(ms * kMs), baseAt(ms, 0.0, 1e-3 * kBase * ms));
      if (ms % 50 == 0) bag.write("/joint_states", after(ms * kMs), jointAt(ms, "turn", 1e-3 * kJoint * ms));
    }
  });
  const auto got =
      events(run(armUrdf(0.5), "pose: {topic: base}, joints: {topic: joint_states}", "[0.2, 1.4, 0]"));
  ASSERT_FALSE(got.empty());
  // By bisection of the composition itself.
  const auto gap = [](double t) {
    const double x = 0.5 * std::cos(kBase * t) + std::cos((kBase + kJoint) * t) - 0.2;
    const double y = 0.5 * std::sin(kBase * t) + std::sin((kBase + kJoint) * t) - 1.4;
    return std::hypot(x, y) - 0.2;
  };
  double before = 0.0, at = 0.0;
  while (gap(at) > 0.0) before = std::exchange(at, at + 1e-4);
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (before + at);
    (gap(middle) > 0.0 ? before : at) = middle;
  }
  const YAML::Node& impact = got[0];
  EXPECT_EQ(impact["kind"].as<std::string>(), "IMPACT");
  EXPECT_EQ(impact["certificate"].as<std::string>(), "CONFIRMED");
  EXPECT_LE(seconds(impact, "model_toi_lower"), at);
  EXPECT_GE(seconds(impact, "model_toi_upper"), at);
  EXPECT_LT(seconds(impact, "model_toi_upper") - seconds(impact, "model_toi_lower"), 0.02);
  EXPECT_GT(impact["model_position_error"].as<double>(), impact["position_error"].as<double>());
  // Its own bracket is that of the straight line and slerp: narrow, and elsewhere.
  EXPECT_LT(seconds(impact, "toi_upper") - seconds(impact, "toi_lower"), 1e-8);
  EXPECT_TRUE(seconds(impact, "toi_lower") > at || seconds(impact, "toi_upper") < at);
}

/// At no stamp do the fingers touch; in between they pass through each other.
TEST_F(Articulated, linksOfOneObjectAreSweptAgainstEachOther) {
  write([](rosbag::Bag& bag) {
    for (int ms = 0; ms <= 900; ms += 300)
      bag.write("/joint_states", after(ms * kMs), jointAt(ms, "close", 1e-3 * ms));
  });
  const std::string joints = "pose: {fixed: {}}, joints: {topic: joint_states}";
  const auto got = events(run(kFingers, joints, "[9, 9, 9]", "pairs: {self: true}\n"));
  ASSERT_EQ(got.size(), 2u);
  expectAt(got[0], "IMPACT", "left", "right", 0.45);
  expectAt(got[1], "SEPARATION", "left", "right", 0.55);
  for (const char* side : {"a", "b"}) EXPECT_EQ(got[0][side]["object"].as<std::string>(), "robot");
  EXPECT_TRUE(events(run(kFingers, joints, "[9, 9, 9]")).empty()) << "nobody asked for them";

  // The same through tf.
  write([](rosbag::Bag& bag) {
    bag.write("/tf_static", after(0), transform("world", "base", 0, 0.0));
    for (int ms = 0; ms <= 900; ms += 300) {
      bag.write("/tf", after(ms * kMs), transform("base", "left", ms * kMs, -0.5 + 1e-3 * ms));
      bag.write("/tf", after(ms * kMs), transform("base", "right", ms * kMs, 0.5 - 1e-3 * ms));
    }
  });
  const auto through_tf =
      events(run(kFingers, "pose: {tf: base, links: true}", "[9, 9, 9]", "pairs: {self: true}\n"));
  ASSERT_EQ(through_tf.size(), 2u);
  expectAt(through_tf[0], "IMPACT", "left", "right", 0.45);
}

/// Side a is the link with the smaller name, whichever comes first in the URDF; the normal goes from a to b.
TEST_F(Articulated, theSidesOfAnEventAreInTheOrderOfTheirLinksNames) {
  write([](rosbag::Bag& bag) {
    for (int ms = 0; ms <= 900; ms += 300)
      bag.write("/joint_states", after(ms * kMs), jointAt(ms, "close", 1e-3 * ms));
  });
  for (const char* left : {"left", "zleft"}) {
    std::string urdf = kFingers;
    for (std::size_t at = urdf.find("'left'"); at != std::string::npos; at = urdf.find("'left'", at + 1))
      urdf.replace(at, 6, std::string("'") + left + "'");
    const auto got = events(
        run(urdf, "pose: {fixed: {}}, joints: {topic: joint_states}", "[9, 9, 9]", "pairs: {self: true}\n"));
    ASSERT_EQ(got.size(), 2u);
    const bool swapped = left[0] == 'z';
    expectAt(got[0], "IMPACT", swapped ? "right" : "left", swapped ? "zleft" : "right", 0.45);
    const double towards_b = swapped ? -1.0 : 1.0;
    EXPECT_NEAR(got[0]["normal"]["x"].as<double>(), towards_b, 1e-6);
    EXPECT_NEAR(got[0]["relative_velocity"]["x"].as<double>(), -2.0 * towards_b, 1e-9);
    EXPECT_GT(got[0]["closing_speed"].as<double>(), 1.9);
  }
}

TEST_F(Articulated, whatIsMissingOrWrongIsNamed) {
  const std::string links = "pose: {tf: base, links: true}";
  const std::string joints = "pose: {topic: base}, joints: {topic: joint_states}";
  write([](rosbag::Bag& bag) {
    bag.write("/tf", after(0), transform("world", "base", 0, 0.0));
    bag.write("/tf", after(0), transform("base", "amr", 0, 0.0));
  });
  Outcome got = run(armUrdf(0), links, "[0, 1, 0]");
  EXPECT_EQ(got.code, 2);
  EXPECT_HAS(got.err,
             "tf never says where 'arm' is in world_frame 'world'; tf frames here: amr, base, world");
  got = run(armUrdf(0), joints, "[0, 1, 0]");
  EXPECT_EQ(got.code, 2);
  EXPECT_HAS(got.err, "lacks /base, /joint_states, which the scene");

  const auto with_joint = [&](const std::string& name, double position) {
    write([&](rosbag::Bag& bag) {
      for (int ms = 0; ms <= 900; ms += 100) {
        bag.write("/base", after(ms * kMs), baseAt(ms, 0.0));
        bag.write("/joint_states", after(ms * kMs), jointAt(ms, name, position));
      }
    });
  };
  with_joint("trun", 1.0);
  got = run(armUrdf(0), joints, "[0, 1, 0]");
  EXPECT_EQ(got.code, 2);
  EXPECT_HAS(
      got.err,
      "topic /joint_states (joints): no joint of the message moves a shape here; it has 'trun', waited "
      "for are 'turn'; 10 messages there cannot be used, and no other tells where 'robot/arm' is");
  with_joint("turn", std::nan(""));
  got = run(armUrdf(0), joints, "[0, 1, 0]");
  EXPECT_EQ(got.code, 2);
  EXPECT_HAS(got.err, "joint 'turn' is at nan; it must be finite");
  with_joint("turn", 1.0);
  got = run(armUrdf(0), "pose: {topic: joint_states}, joints: {topic: joint_states}", "[0, 1, 0]");
  EXPECT_EQ(got.code, 2);
  EXPECT_HAS(got.err, "topic /joint_states (object 'robot'): type sensor_msgs/JointState carries no pose");
  got = run(armUrdf(0), "pose: {topic: base}, joints: {topic: base}", "[0, 1, 0]");
  EXPECT_EQ(got.code, 2);
  EXPECT_HAS(got.err,
             "topic /base (joints): type geometry_msgs/PoseStamped holds no joint states; "
             "sensor_msgs/JointState is read");
}

/// One of two joints comes, the other never: the links behind it are uncovered and named, the rest goes on.
// README: "every link that moves has its tf frame, or all joints before it their positions"
TEST_F(Articulated, aJointThatNeverComesLeavesItsLinksUncovered) {
  write([](rosbag::Bag& bag) {
    for (int i = 0; i <= 10; ++i)
      bag.write("/joint_states", after(100 * i * kMs), jointAt(100 * i, "lift", 0.2 * i));
  });
  const std::string urdf =
      "<robot name='r'><link name='base'/>"
      "<link name='up'><collision><geometry><sphere radius='0.1'/></geometry></collision></link>"
      "<link name='aside'><collision><geometry><sphere radius='0.1'/></geometry></collision></link>"
      "<joint name='lift' type='prismatic'><parent link='base'/><child link='up'/><axis xyz='1 0 0'/>"
      "<limit lower='0' upper='9' effort='1' velocity='1'/></joint>"
      "<joint name='shift' type='prismatic'><parent link='base'/><child link='aside'/><axis xyz='0 1 0'/>"
      "<limit lower='0' upper='9' effort='1' velocity='1'/></joint></robot>";
  folder_.write("robot.urdf", urdf);
  const std::string scene = folder_.write(
      "scene.yaml",
      "objects:\n  robot: {urdf: robot.urdf, pose: {fixed: {}}, joints: {topic: joint_states}}\n"
      "  target: {sphere: {radius: 0.1}, pose: {fixed: {position: [1, 0, 0]}}}\n"
      "time: {max_gap: 0.5, timeout: 0.7}\n");
  const Outcome got = replayed({scene, path("in.bag")});
  EXPECT_EQ(got.code, 0);
  EXPECT_HAS(got.out, "no pose at all, so nothing is said about: robot/aside");
  EXPECT_HAS(got.out, "2 events");
  EXPECT_HAS(got.err, "warning: no position of joint 'shift' of object 'robot', on /joint_states");
}

/// A revolute joint's position says that it went round the long way.
TEST_F(Articulated, aJointThatTurnsByMoreThanHalfATurnIsUncertified) {
  write([](rosbag::Bag& bag) {
    for (int i = 0; i <= 2; ++i)
      bag.write("/joint_states", after(100 * i * kMs), jointAt(100 * i, "turn", 4.0 * i));
  });
  const auto got = events(run(armUrdf(0), "pose: {fixed: {}}, joints: {topic: joint_states}", "[0, -1, 0]"));
  ASSERT_FALSE(got.empty());
  for (const YAML::Node& event : got) {
    EXPECT_EQ(event["certificate"].as<std::string>(), "UNCERTIFIED");
    EXPECT_EQ(event["reason"].as<std::string>(), "ALIAS");
  }
}

}  // namespace
}  // namespace collision_node::test

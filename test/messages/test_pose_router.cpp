/// Which poses come out of which messages. Spheres named a, b, ... with the sources that a test gives them.
#include <geometry_msgs/PoseArray.h>
#include <geometry_msgs/PoseStamped.h>
#include <gtest/gtest.h>
#include <nav_msgs/Odometry.h>
#include <nav_msgs/Path.h>
#include <sensor_msgs/JointState.h>
#include <tf2_msgs/TFMessage.h>

#include <cmath>

#include "collision_node/messages/pose_router.h"
#include "test/messages/wire.h"
#include "test/support/gazebo_states.h"

namespace collision_node::messages {
namespace {

using Type = scene::PoseSource::Type;
constexpr motion::Nanoseconds kMs = 1'000'000;

scene::PoseSource topic(const std::string& name) {
  scene::PoseSource source;
  source.type = Type::kTopic;
  source.topic = name;
  return source;
}

scene::PoseSource frame(const std::string& name) {
  scene::PoseSource source;
  source.type = Type::kTf;
  source.tf_frame = name;
  return source;
}

/// Beside a wall that all are watched against. `names`: of the objects; empty: a, b ...
std::shared_ptr<scene::Scene> sceneOf(std::vector<scene::PoseSource> sources,
                                      std::vector<std::string> names = {}) {
  auto out = std::make_shared<scene::Scene>();
  for (std::size_t i = names.size(); i < sources.size(); ++i)
    names.emplace_back(1, static_cast<char>('a' + i));
  sources.emplace_back();
  names.emplace_back("wall");
  for (std::size_t i = 0; i < sources.size(); ++i) {
    scene::Object object;
    object.name = names[i];
    object.source = sources[i];
    object.links.resize(1);
    object.links[0].shapes = {{geometry::Point{}, {}, "point"}};
    out->objects.push_back(object);
  }
  return out;
}

/// In which only these are watched, against the wall.
std::shared_ptr<scene::Scene> watching(std::shared_ptr<scene::Scene> scene, const std::vector<int>& objects) {
  scene->pairs.watchNothingElse("not listed");
  for (const int object : objects)
    scene->pairs.set(object, static_cast<int>(scene->objects.size()) - 1,
                     {{{object, 0, static_cast<int>(scene->objects.size()) - 1, 0, 0.0}, ""}});
  return scene;
}

struct Router {
  explicit Router(const std::vector<scene::PoseSource>& sources, const std::vector<std::string>& names = {})
      : Router(sceneOf(sources, names)) {}
  explicit Router(std::shared_ptr<const scene::Scene> scene)
      : router(
            std::move(scene), [](const std::string& name) { return "/" + name; },
            [this](int object, const motion::StampedPose& pose, StampKind kind) {
              objects.push_back(object);
              poses.push_back(pose);
              kinds.push_back(kind);
            }) {}

  template <typename Message>
  std::string send(const std::string& name, const Message& message, motion::Nanoseconds received_ns = 0) {
    try {
      router.handle(name, Wire<Message>(message).raw, received_ns);
    } catch (const PoseError& error) {
      return error.what();
    }
    return "taken";
  }

  std::vector<int> objects;
  std::vector<motion::StampedPose> poses;
  std::vector<StampKind> kinds;
  PoseRouter router;
};

std_msgs::Header header(const std::string& frame, int ms) {
  std_msgs::Header out;
  out.frame_id = frame;
  out.stamp.fromNSec(static_cast<std::uint64_t>(ms) * kMs);
  return out;
}

geometry_msgs::PoseStamped poseIn(const std::string& frame, int ms, double x) {
  geometry_msgs::PoseStamped out;
  out.header = header(frame, ms);
  out.pose.position.x = x;
  out.pose.orientation.w = 1;
  return out;
}

tf2_msgs::TFMessage transform(const std::string& parent, const std::string& child, int ms, double x,
                              double yaw = 0) {
  tf2_msgs::TFMessage out;
  out.transforms.emplace_back();
  auto& t = out.transforms.back();
  t.header = header(parent, ms);
  t.child_frame_id = child;
  t.transform.translation.x = x;
  t.transform.rotation.z = std::sin(yaw / 2);
  t.transform.rotation.w = std::cos(yaw / 2);
  return out;
}

const double kQuarter = std::acos(0.0);
using Topics = std::vector<std::string>;

TEST(PoseRouter, posesInTheWorldNeedNoTf) {
  Router r({topic("p")});
  EXPECT_EQ(r.send("/p", poseIn("/world", 5, 1)), "taken");
  EXPECT_EQ(r.router.topics(), Topics{"/p"});
  EXPECT_FALSE(r.router.usesTf());
  ASSERT_EQ(r.poses.size(), 1u);
  EXPECT_EQ(r.poses[0].pose.position.x(), 1.0);
}

TEST(PoseRouter, posesInAnotherFrameAreComposedWithItsStaticTransforms) {
  Router r({topic("p")});
  EXPECT_EQ(r.send("/p", poseIn("lab", 5, 1)), "taken");
  EXPECT_EQ(r.router.topics(), (Topics{"/p", "/tf", "/tf_static"}));
  EXPECT_EQ(r.router.tf().unresolved(), std::vector<std::string>{"lab, of topic /p"});
  EXPECT_TRUE(r.poses.empty());
  EXPECT_EQ(r.send("/tf_static", transform("world", "lab", 0, 10, kQuarter)), "taken");
  EXPECT_EQ(r.send("/p", poseIn("lab", 8, 2)), "taken");
  ASSERT_EQ(r.poses.size(), 2u) << "the one before the transform was kept";
  EXPECT_LT((r.poses[0].pose.position - geometry::Vec3(10, 1, 0)).norm(), 1e-14);
  EXPECT_EQ(r.poses[1].stamp_ns, 8 * kMs);
  EXPECT_TRUE(r.router.tf().unresolved().empty());
}

TEST(PoseRouter, posesInAMovingFrameAreAChain) {
  Router r({topic("p")});
  r.send("/p", poseIn("odom", 0, 0));
  for (int ms = 0; ms <= 300; ms += 100) r.send("/tf", transform("world", "odom", ms, 0.01 * ms));
  for (int ms = 50; ms <= 250; ms += 100) r.send("/p", poseIn("odom", ms, 0.1 * ms));
  r.router.flush();
  ASSERT_EQ(r.poses.size(), 6u) << "0, 50, 100 ... 250 ms: the union of both stamps, as far as both know";
  for (const auto& pose : r.poses)
    EXPECT_NEAR(pose.pose.position.x(), 0.11 * static_cast<double>(pose.stamp_ns / kMs), 1e-12);
}

TEST(PoseRouter, aTwistIsTurnedWithItsFrame) {
  Router r({topic("p")});
  nav_msgs::Odometry odometry;
  odometry.header = header("lab", 5);
  odometry.pose.pose.orientation.w = 1;
  odometry.twist.twist.linear.x = 3;
  r.send("/p", odometry);
  r.send("/tf_static", transform("world", "lab", 0, 0, kQuarter));
  ASSERT_EQ(r.poses.size(), 1u);
  EXPECT_TRUE(r.poses[0].has_twist);
  EXPECT_LT((r.poses[0].linear - geometry::Vec3(0, 3, 0)).norm(), 1e-15);
}

TEST(PoseRouter, aChangedFrameIsRefusedByNamingBoth) {
  Router r({topic("p")});
  r.send("/p", poseIn("world", 5, 1));
  const std::string fault = r.send("/p", poseIn("odom", 6, 1));
  for (const char* part : {"/p", "'a'", "'odom'", "'world'"})
    EXPECT_NE(fault.find(part), std::string::npos) << fault;
  EXPECT_EQ(r.send("/p", poseIn("world", 7, 1)), "taken");
  EXPECT_EQ(r.poses.size(), 2u);
  EXPECT_EQ(r.router.faults().at("/p").refused, 1u);
  EXPECT_FALSE(r.router.usesTf());
}

TEST(PoseRouter, aChangedTypeIsRefusedByNamingBoth) {
  Router r({topic("p")});
  r.send("/p", poseIn("world", 5, 1));
  const std::string fault = r.send("/p", nav_msgs::Odometry());
  for (const char* part : {"/p", "geometry_msgs/PoseStamped", "nav_msgs/Odometry"})
    EXPECT_NE(fault.find(part), std::string::npos) << fault;
  EXPECT_EQ(r.poses.size(), 1u);
}

TEST(PoseRouter, anotherVersionOfTheTypeIsRefusedByNamingBoth) {
  Router r({topic("p")});
  const Wire<geometry_msgs::PoseStamped> wire(poseIn("world", 5, 1));
  RawMessage other = wire.raw;
  other.md5sum = "00000000000000000000000000000000";
  try {
    r.router.handle("/p", other, 0);
    FAIL() << "taken";
  } catch (const PoseError& error) {
    const std::string fault = error.what();
    for (const std::string& part : {other.md5sum, wire.raw.md5sum})
      EXPECT_NE(fault.find(part), std::string::npos) << fault;
  }
}

TEST(PoseRouter, anEmptyFrameIsRefused) {
  Router r({topic("p")});
  EXPECT_NE(r.send("/p", poseIn("", 5, 1)).find("frame_id is empty"), std::string::npos);
}

TEST(PoseRouter, aFrameWithStaticTransformsOnlyIsHandedOutForAllTime) {
  Router r({frame("wall")});
  r.send("/tf_static", transform("world", "wall", 0, 4));
  ASSERT_EQ(r.kinds, std::vector<StampKind>{StampKind::kAlways});
  EXPECT_EQ(r.poses[0].pose.position.x(), 4.0);
}

TEST(PoseRouter, gazeboStatesCarryTheTimeOfReceipt) {
  auto source = topic("gazebo/model_states");
  source.model = "ball";
  Router r({source});
  test_support::ModelStates states;
  states.name = {"ground", "ball"};
  states.pose.resize(2);
  states.twist.resize(2);
  states.pose[1].position.x = 7;
  states.pose[1].orientation.w = 1;
  EXPECT_EQ(r.send("/gazebo/model_states", states, 123), "taken");
  ASSERT_EQ(r.poses.size(), 1u);
  EXPECT_EQ(r.poses[0].stamp_ns, 123);
  EXPECT_EQ(r.kinds[0], StampKind::kGuessed);
  EXPECT_EQ(r.poses[0].pose.position.x(), 7.0);
}

nav_msgs::Path pathIn(const std::string& frame, int count) {
  nav_msgs::Path out;
  out.header = header(frame, 0);
  for (int i = 0; i < count; ++i) {
    out.poses.push_back(poseIn("", 100 * i, i));
    out.poses.back().header.frame_id.clear();
  }
  return out;
}

scene::Stats counted(const PoseRouter& router) {
  scene::Stats stats;
  router.count(stats);
  return stats;
}

TEST(PoseRouter, aPathIsHandedOnPoseByPose) {
  Router r({topic("p")});
  EXPECT_EQ(r.send("/p", pathIn("world", 3)), "taken");
  EXPECT_EQ(r.send("/p", pathIn("world", 5)), "taken");
  ASSERT_EQ(r.poses.size(), 5u);
  for (int i = 0; i < 5; ++i) EXPECT_EQ(r.poses[static_cast<std::size_t>(i)].stamp_ns, 100 * i * kMs);
  EXPECT_TRUE(r.poses[0].comes_ahead);
  EXPECT_NE(r.send("/p", pathIn("odom", 3)).find("header.frame_id is 'odom' and was 'world'"),
            std::string::npos);
  auto changed = pathIn("world", 5);
  changed.poses[2].pose.position.x = 7;
  r.send("/p", changed);
  EXPECT_EQ(r.poses.size(), 5u);
  EXPECT_EQ(counted(r.router).duplicate, 1u);
  EXPECT_EQ(counted(r.router).rejected, 1u) << "the message in another frame";
  // Behind a reset, or a clock that went back, the same path is news.
  r.router.reset();
  r.send("/p", changed);
  r.router.clockWentBack();
  r.send("/p", changed);
  EXPECT_EQ(r.poses.size(), 15u);
}

TEST(PoseRouter, aPathInAnotherFrameIsComposedWithIt) {
  Router r({topic("p")});
  r.send("/p", pathIn("lab", 3));
  r.send("/tf_static", transform("world", "lab", 0, 10, kQuarter));
  ASSERT_EQ(r.poses.size(), 3u);
  EXPECT_LT((r.poses[2].pose.position - geometry::Vec3(10, 2, 0)).norm(), 1e-14);
  EXPECT_TRUE(r.poses[2].comes_ahead);
}

/// Two parts, `arm` on a prismatic joint along x.
std::vector<scene::PoseSource> slider() {
  scene::PoseSource arm;
  arm.type = Type::kJoints;
  arm.topic = "joints";
  arm.joints.resize(1);
  arm.joints[0].joint.kind = geometry::UrdfJoint::Kind::kPrismatic;
  arm.joints[0].joint.name = arm.joints[0].joint.driver = "slide";
  return {topic("base"), arm};
}

sensor_msgs::JointState jointAt(int ms, double position) {
  sensor_msgs::JointState out;
  out.header = header("", ms);
  out.name = {"slide"};
  out.position = {position};
  return out;
}

struct Robot : Router {
  Robot() : Router(slider(), {"robot", "robot"}) {}
};

TEST(PoseRouter, jointsHangOnTheObjectsOwnPoses) {
  Robot r;
  EXPECT_EQ(r.router.topics(), (Topics{"/base", "/joints"}));
  EXPECT_EQ(r.send("/joints", jointAt(0, 1)), "taken") << "it waits for the base";
  for (int ms = 0; ms <= 300; ms += 100) r.send("/base", poseIn("world", ms, 0.01 * ms));
  for (int ms = 50; ms <= 300; ms += 50) r.send("/joints", jointAt(ms, 1.0));
  r.router.flush();
  int of_base = 0, of_arm = 0;
  for (std::size_t i = 0; i < r.poses.size(); ++i) {
    const double x = r.objects[i] == 0 ? 0.0 : 1.0;
    (r.objects[i] == 0 ? of_base : of_arm) += 1;
    EXPECT_NEAR(r.poses[i].pose.position.x(), x + 0.01 * static_cast<double>(r.poses[i].stamp_ns / kMs),
                1e-12);
  }
  EXPECT_EQ(of_base, 4);
  EXPECT_EQ(of_arm, 7) << "the union of both stamps";
  EXPECT_FALSE(r.router.usesTf());
}

TEST(PoseRouter, aBadPoseOfTheBaseIsCountedOnceAndAsItsOwn) {
  Robot r;
  r.send("/joints", jointAt(50, 1));
  r.send("/base", poseIn("world", 50, std::nan("")));
  ASSERT_EQ(r.objects, std::vector<int>{0});
  EXPECT_EQ(r.router.faults().at("/base").rejected, 1u);
  EXPECT_EQ(r.router.faults().count("/joints"), 0u);
}

TEST(PoseRouter, posesAndJointsOfStampZeroAreCountedByTopic) {
  Robot r;
  for (const int x : {0, 1, 2}) r.send("/base", poseIn("world", 0, x));
  for (const int angle : {0, 1}) r.send("/joints", jointAt(0, angle));
  r.send("/base", poseIn("world", 50, 3));
  EXPECT_EQ(r.router.faults().at("/base").unstamped, 3u);
  EXPECT_EQ(r.router.faults().at("/joints").unstamped, 2u);
}

TEST(PoseRouter, whatIsInNoPairIsNotHeard) {
  auto array = topic("array"), element = topic("array");
  array.index = 0;
  element.index = 7;  // more than there are: nobody asks
  Router r(watching(sceneOf({topic("p"), topic("q"), frame("f"), array, element}), {0, 3}));
  EXPECT_EQ(r.router.topics(), (Topics{"/array", "/p"}));
  EXPECT_FALSE(r.router.usesTf());
  EXPECT_EQ(r.router.topicOf(1), "");
  geometry_msgs::PoseArray poses;
  poses.header = header("world", 5);
  poses.poses.resize(1);
  poses.poses[0].orientation.w = 1;
  EXPECT_EQ(r.send("/array", poses), "taken");
  r.send("/q", poseIn("lab", 5, 1));
  EXPECT_EQ(r.objects, std::vector<int>{3});
  EXPECT_EQ(r.router.topics(), (Topics{"/array", "/p"}))
      << "no tf for the frame of a topic that nobody needs";
  EXPECT_THROW(Router(watching(sceneOf({topic("p"), topic("tf")}), {0})), PoseError)
      << "a mistake all the same";
}

TEST(PoseRouter, aBaseInNoPairOnlyCarriesItsParts) {
  Router r(watching(sceneOf(slider(), {"robot", "robot"}), {1}));
  EXPECT_EQ(r.router.topics(), (Topics{"/base", "/joints"}));
  for (int ms = 0; ms <= 300; ms += 100) {
    r.send("/base", poseIn("world", ms, 0.01 * ms));
    r.send("/joints", jointAt(ms, 1.0));
  }
  r.send("/base", poseIn("world", 400, std::nan("")));
  r.router.flush();
  ASSERT_EQ(r.objects, (std::vector<int>{1, 1, 1, 1}));
  EXPECT_EQ(r.poses[3].pose.position.x(), 4.0);
  EXPECT_EQ(r.router.faults().at("/base").rejected, 1u);
  EXPECT_EQ(counted(r.router).rejected, 1u);
}

TEST(PoseRouter, aBaseInNoPairThatTfMovesStillNeedsTf) {
  auto sources = slider();
  sources[0] = frame("base");
  Router r(watching(sceneOf(sources, {"robot", "robot"}), {1}));
  EXPECT_EQ(r.router.topics(), (Topics{"/joints", "/tf", "/tf_static"}));
  for (int ms = 0; ms <= 300; ms += 100) {
    r.send("/tf", transform("world", "base", ms, 0.01 * ms));
    r.send("/joints", jointAt(ms, 1.0));
  }
  r.router.flush();
  ASSERT_EQ(r.objects, (std::vector<int>{1, 1, 1, 1}));
  EXPECT_EQ(r.poses[3].pose.position.x(), 4.0);
  EXPECT_TRUE(r.router.tf().unresolved().empty());
}

TEST(PoseRouter, jointsOfPartsInNoPairAreNeitherHeardNorAFault) {
  auto sources = slider();
  auto hand = sources[1];
  hand.joints.push_back(hand.joints[0]);
  hand.joints[1].joint.name = hand.joints[1].joint.driver = "grip";
  sources.push_back(hand);
  auto other = hand;
  other.topic = "other_joints";
  sources.push_back(topic("p"));
  sources.push_back(other);
  Router r(watching(sceneOf(sources, {"a", "a", "a", "b", "b"}), {0, 1, 3}));
  EXPECT_EQ(r.router.topics(), (Topics{"/base", "/joints", "/p"}));
  auto grip = jointAt(0, 1.0);
  grip.name = {"grip"};
  EXPECT_EQ(r.send("/joints", grip), "taken");
  EXPECT_EQ(r.router.missingJoints().size(), 1u) << "the slide alone";
  grip.name = {"grap"};
  EXPECT_NE(r.send("/joints", grip), "taken");
  // Where no part that moves is watched, the base is an object like others.
  Router bare(watching(sceneOf(slider(), {"robot", "robot"}), {0}));
  EXPECT_EQ(bare.router.topics(), Topics{"/base"});
  EXPECT_EQ(bare.send("/base", poseIn("world", 0, 1.0)), "taken");
  EXPECT_EQ(bare.objects, std::vector<int>{0}) << "at once, without a chain";
}

TEST(PoseRouter, whatAChainDropsIsCounted) {
  Robot r;
  for (int ms = 0; ms <= 1000; ms += 100) {
    r.send("/base", poseIn("world", ms, 0));
    r.send("/joints", jointAt(ms, 0));
  }
  r.send("/joints", jointAt(1000, 5));  // again
  r.send("/joints", jointAt(450, 5));   // long after it was due
  r.send("/joints", jointAt(1100, 0));
  EXPECT_EQ(counted(r.router).duplicate, 1u);
  EXPECT_EQ(counted(r.router).late, 1u);
}

}  // namespace
}  // namespace collision_node::messages

/// What /diagnostics says of the node, without a master.
#include <gtest/gtest.h>

#include "collision_node/node/diagnostics.h"

namespace collision_node::node {
namespace {

using Status = diagnostic_msgs::DiagnosticStatus;

Health watching() {
  Health health;
  health.name = "/robot/impacts";
  health.stats.accepted = 10;
  health.stats.has_watermark = true;
  return health;
}

std::string valueOf(const Status& status, const std::string& key) {
  for (const auto& value : status.values)
    if (value.key == key) return value.value;
  return "absent";
}

TEST(Diagnostics, okWhileWatching) {
  const Status status = diagnose(watching());
  EXPECT_EQ(status.level, Status::OK);
  EXPECT_EQ(status.message, "watching");
  EXPECT_EQ(status.name, "robot/impacts: impacts");
  EXPECT_EQ(valueOf(status, "accepted"), "10");
}

TEST(Diagnostics, warnsBeforeTheFirstPoseAndNamesWhatNobodyPublishes) {
  Health health = watching();
  health.stats = {};
  EXPECT_EQ(diagnose(health).level, Status::WARN);
  EXPECT_EQ(diagnose(health).message, "no pose has arrived yet");
  health.without_publisher = {"/bal/pose"};
  EXPECT_EQ(diagnose(health).message, "no pose has arrived yet: nobody publishes /bal/pose");
  health.stats = watching().stats;
  EXPECT_EQ(diagnose(health).message, "nobody publishes /bal/pose");
}

TEST(Diagnostics, saysThatTheSceneWatchesNoPair) {
  Health health = watching();
  health.stats = {};
  health.has_pairs = false;
  EXPECT_EQ(diagnose(health).level, Status::WARN);
  EXPECT_EQ(diagnose(health).message, "no pair is watched: nothing can be reported");
}

TEST(Diagnostics, refusedMessagesAreAnErrorAndCountedByTopic) {
  Health health = watching();
  health.stats.rejected = 5;
  health.faults["/ball/pose"] = {3, "topic /ball/pose: header.frame_id is 'odom'", 0};
  health.faults["/tf"] = {0, "", 2};
  const Status status = diagnose(health);
  EXPECT_EQ(status.level, Status::ERROR);
  EXPECT_EQ(status.message, "topic /ball/pose: header.frame_id is 'odom'");
  EXPECT_EQ(valueOf(status, "refused on /ball/pose"), "3");
  EXPECT_EQ(valueOf(status, "rejected on /tf"), "2");
  EXPECT_EQ(valueOf(status, "refused on /tf"), "absent");
  EXPECT_EQ(valueOf(status, "rejected"), "5");
}

void expectWarning(const Health& health, const std::string& message, const std::string& key,
                   const std::string& value) {
  const Status status = diagnose(health);
  EXPECT_EQ(status.level, Status::WARN);
  EXPECT_EQ(status.message, message);
  EXPECT_EQ(valueOf(status, key), value);
}

TEST(Diagnostics, namesTheTopicWithoutStamps) {
  Health health = watching();
  health.faults["/ball/pose"].unstamped = 1;
  EXPECT_EQ(diagnose(health).level, Status::OK) << "a simulation may begin at 0";
  health.faults["/ball/pose"].unstamped = 2;
  expectWarning(health, "no stamps on /ball/pose: header.stamp is 0 again and again", "stamp 0 on /ball/pose",
                "2");
}

TEST(Diagnostics, namesTheTopicWithoutTwistsThatAreNeeded) {
  Health health = watching();
  health.faults["/ball/pose"].twistless = 9;
  expectWarning(health, "no twists on /ball/pose, from which motion: hermite and spin are made",
                "no twist on /ball/pose", "9");
}

TEST(Diagnostics, namesTheJointThatIsWaitedFor) {
  Health health = watching();
  health.messages = 12;
  health.missing_joints = {"joint 'elbow' of object 'arm', on /joint_states"};
  health.stats.uncovered_objects = {"arm/hand"};
  const Status status = diagnose(health);
  EXPECT_EQ(status.level, Status::WARN);
  EXPECT_EQ(status.message, "no position of joint 'elbow' of object 'arm', on /joint_states");
  EXPECT_EQ(valueOf(status, "no position of"), "joint 'elbow' of object 'arm', on /joint_states");
  EXPECT_EQ(valueOf(status, "messages"), "12");
}

TEST(Diagnostics, namesTheTopicThatLosesMessages) {
  Health health = watching();
  health.stats.lost = 7;
  health.lost["/ball/pose"] = 7;
  const Status status = diagnose(health);
  EXPECT_EQ(status.level, Status::WARN);
  EXPECT_EQ(status.message, "messages lost on /ball/pose");
  EXPECT_EQ(valueOf(status, "lost on /ball/pose"), "7");
  EXPECT_EQ(valueOf(status, "lost"), "7");
}

TEST(Diagnostics, warnsOfSilentObjectsAndLatePoses) {
  Health health = watching();
  health.stats.late = 1;
  EXPECT_EQ(diagnose(health).level, Status::WARN);
  health.stats.uncovered_objects = {"drone"};
  EXPECT_EQ(diagnose(health).message, "no poses of drone");
}

}  // namespace
}  // namespace collision_node::node

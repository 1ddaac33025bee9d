#include <geometry_msgs/Pose.h>
#include <geometry_msgs/PoseArray.h>
#include <geometry_msgs/PoseStamped.h>
#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <geometry_msgs/TransformStamped.h>
#include <gtest/gtest.h>
#include <nav_msgs/Odometry.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "collision_node/messages/pose_reader.h"
#include "test/messages/wire.h"

namespace collision_node::messages {
namespace {

using scene::PoseSource;

PoseSource topic(int index = -1) {
  PoseSource source;
  source.type = PoseSource::Type::kTopic;
  source.topic = "p";
  source.index = index;
  return source;
}

geometry_msgs::Pose pose(double x) {
  geometry_msgs::Pose p;
  p.position.x = x;
  p.position.y = 2;
  p.position.z = 3;
  p.orientation.z = p.orientation.w = std::sqrt(0.5);
  return p;
}

std_msgs::Header header(const std::string& frame = "world") {
  std_msgs::Header h;
  h.stamp = ros::Time(1700000000, 7);
  h.frame_id = frame;
  return h;
}

template <typename Message>
std::string faultOf(const Message& message, const PoseSource& source) {
  try {
    readPose(Wire<Message>(message).raw, source, 0);
  } catch (const PoseError& error) {
    return error.what();
  }
  return "";
}

void expectPose(const PoseReading& reading, double x) {
  EXPECT_EQ(reading.frame, "world");
  EXPECT_EQ(reading.kind, StampKind::kSent);
  const motion::StampedPose& got = reading.pose;
  EXPECT_EQ(got.stamp_ns, 1'700'000'000'000'000'007);
  EXPECT_EQ(got.pose.position, geometry::Vec3(x, 2, 3));
  EXPECT_EQ(got.pose.orientation.coeffs(), geometry::Quat(std::sqrt(0.5), 0, 0, std::sqrt(0.5)).coeffs());
}

TEST(PoseReader, readsEachType) {
  geometry_msgs::PoseStamped stamped;
  stamped.header = header();
  stamped.pose = pose(1);
  expectPose(readPose(Wire<geometry_msgs::PoseStamped>(stamped).raw, topic(), 0), 1);

  geometry_msgs::PoseWithCovarianceStamped covariance;
  covariance.header = header("/world");
  covariance.pose.pose = pose(2);
  expectPose(readPose(Wire<geometry_msgs::PoseWithCovarianceStamped>(covariance).raw, topic(), 0), 2);

  geometry_msgs::TransformStamped transform;
  transform.header = header();
  transform.transform.translation.x = 3;
  transform.transform.translation.y = 2;
  transform.transform.translation.z = 3;
  transform.transform.rotation = pose(0).orientation;
  expectPose(readPose(Wire<geometry_msgs::TransformStamped>(transform).raw, topic(), 0), 3);

  geometry_msgs::PoseArray array;
  array.header = header();
  array.poses = {pose(4), pose(5)};
  expectPose(readPose(Wire<geometry_msgs::PoseArray>(array).raw, topic(1), 0), 5);
}

TEST(PoseReader, odometryTwistIsTurnedOutOfTheChildFrame) {
  nav_msgs::Odometry odometry;
  odometry.header = header();
  odometry.child_frame_id = "base";
  odometry.pose.pose = pose(1);  // a quarter turn left
  odometry.twist.twist.linear.x = 10;
  odometry.twist.twist.angular.y = 1;
  const auto reading = readPose(Wire<nav_msgs::Odometry>(odometry).raw, topic(), 0);
  expectPose(reading, 1);
  const auto& got = reading.pose;
  EXPECT_TRUE(got.has_twist);
  EXPECT_LT((got.linear - geometry::Vec3(0, 10, 0)).norm(), 1e-14);
  EXPECT_LT((got.angular - geometry::Vec3(-1, 0, 0)).norm(), 1e-15);

  odometry.twist.twist.angular.y = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(readPose(Wire<nav_msgs::Odometry>(odometry).raw, topic(), 0).pose.has_twist);
}

TEST(PoseReader, badNumbersAreHandedOnForTheEngineToCount) {
  geometry_msgs::PoseStamped stamped;
  stamped.header = header();
  stamped.pose.position.x = std::numeric_limits<double>::infinity();
  const auto got = readPose(Wire<geometry_msgs::PoseStamped>(stamped).raw, topic(), 0).pose;
  EXPECT_TRUE(std::isinf(got.pose.position.x()));
  EXPECT_EQ(got.pose.orientation.norm(), 0.0);
}

TEST(PoseReader, refusesWithALineThatSaysWhy) {
  geometry_msgs::PoseArray array;
  array.header = header();
  array.poses = {pose(4)};
  EXPECT_NE(faultOf(array, topic()).find("needs `index`"), std::string::npos);
  EXPECT_NE(faultOf(array, topic(1)).find("index 1 is beyond a PoseArray of 1"), std::string::npos);

  EXPECT_NE(faultOf(geometry_msgs::Pose(), topic()).find("geometry_msgs/Pose carries no pose"),
            std::string::npos);
  geometry_msgs::PoseStamped stamped;
  EXPECT_NE(faultOf(stamped, topic(0)).find("`index` is meant for geometry_msgs/PoseArray"),
            std::string::npos);
}

TEST(PoseReader, refusesAnotherVersionAndACutMessage) {
  EXPECT_THROW(checkPoseType("geometry_msgs/PoseStamped", "00000000000000000000000000000000", topic()),
               PoseError);
  geometry_msgs::PoseStamped stamped;
  stamped.header = header();
  Wire<geometry_msgs::PoseStamped> wire(stamped);
  wire.raw.size -= 1;
  EXPECT_THROW(readPose(wire.raw, topic(), 0), PoseError);
}

TEST(PoseReader, noLengthThatBytesClaimTakesAllMemory) {
  geometry_msgs::PoseArray array;
  array.header = header();
  array.poses = {pose(1), pose(2)};
  const std::size_t count_at = 16 + array.header.frame_id.size();
  for (const std::uint32_t claimed : {3u, 100'000'000u, 0xffffffffu}) {
    Wire<geometry_msgs::PoseArray> wire(array);
    std::memcpy(wire.bytes.data() + count_at, &claimed, 4);
    try {
      readPose(wire.raw, topic(0), 0);
      FAIL() << claimed << " poses were read from the bytes of two";
    } catch (const PoseError& error) {
      EXPECT_NE(std::string(error.what()).find(std::to_string(claimed)), std::string::npos) << error.what();
    }
  }
  // Every cut, and a frame_id that claims the rest of the world.
  for (std::uint32_t size = 0; size < Wire<geometry_msgs::PoseArray>(array).raw.size; ++size) {
    Wire<geometry_msgs::PoseArray> wire(array);
    wire.raw.size = size;
    EXPECT_THROW(readPose(wire.raw, topic(0), 0), PoseError) << size;
  }
  Wire<geometry_msgs::PoseArray> wire(array);
  const std::uint32_t huge = 0xfffffff0u;
  std::memcpy(wire.bytes.data() + 12, &huge, 4);
  EXPECT_THROW(readPose(wire.raw, topic(0), 0), PoseError);
}

}  // namespace
}  // namespace collision_node::messages

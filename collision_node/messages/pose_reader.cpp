#include "collision_node/messages/pose_reader.h"

#include <geometry_msgs/PoseArray.h>
#include <geometry_msgs/PoseStamped.h>
#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <geometry_msgs/TransformStamped.h>
#include <nav_msgs/Odometry.h>

#include "collision_node/messages/convert.h"
#include "collision_node/messages/deserialise.h"
#include "collision_node/messages/name_states.h"
#include "collision_node/messages/path_memory.h"

namespace collision_node::messages {

namespace {

using motion::StampedPose;
using scene::PoseSource;

const char* const kSupported =
    "geometry_msgs/PoseStamped, PoseWithCovarianceStamped, TransformStamped, PoseArray (with index), "
    "nav_msgs/Odometry, Path, gazebo_msgs/ModelStates (with model), LinkStates (with link)";

PoseReading stamped(const std_msgs::Header& header, const geometry_msgs::Pose& pose) {
  PoseReading out;
  out.frame = withoutSlash(header.frame_id);
  out.pose.stamp_ns = toNanoseconds(header.stamp);
  out.pose.pose = fromPose(pose);
  return out;
}

PoseReading read(const geometry_msgs::PoseStamped& m, const PoseSource&) { return stamped(m.header, m.pose); }

PoseReading read(const geometry_msgs::PoseWithCovarianceStamped& m, const PoseSource&) {
  return stamped(m.header, m.pose.pose);
}

PoseReading read(const geometry_msgs::TransformStamped& m, const PoseSource&) {
  geometry_msgs::Pose pose;
  pose.position.x = m.transform.translation.x;
  pose.position.y = m.transform.translation.y;
  pose.position.z = m.transform.translation.z;
  pose.orientation = m.transform.rotation;
  return stamped(m.header, pose);
}

PoseReading read(const nav_msgs::Odometry& m, const PoseSource&) {
  PoseReading out = stamped(m.header, m.pose.pose);
  StampedPose& pose = out.pose;
  const auto& twist = m.twist.twist;
  const Vec3 linear(twist.linear.x, twist.linear.y, twist.linear.z);
  const Vec3 angular(twist.angular.x, twist.angular.y, twist.angular.z);
  const double length2 = pose.pose.orientation.squaredNorm();
  if (!linear.allFinite() || !angular.allFinite() || !(length2 > 0.5 && length2 < 2.0)) return out;
  const Quat turn = pose.pose.orientation.normalized();  // a bad quaternion is refused later, with its pose
  pose.linear = turn * linear;
  pose.angular = turn * angular;
  pose.has_twist = true;
  return out;
}

PoseReading read(const geometry_msgs::PoseArray& m, const PoseSource& source) {
  if (source.index < 0 || static_cast<std::size_t>(source.index) >= m.poses.size())
    throw PoseError("index " + std::to_string(source.index) + " is beyond a PoseArray of " +
                    std::to_string(m.poses.size()) + " poses");
  return stamped(m.header, m.poses[static_cast<std::size_t>(source.index)]);
}

/// Calls `visit` with a default message of the named type; false when the type is none of ours.
template <typename Visit>
bool withType(const std::string& datatype, Visit&& visit) {
  return visit(geometry_msgs::PoseStamped(), datatype) ||
         visit(geometry_msgs::PoseWithCovarianceStamped(), datatype) ||
         visit(geometry_msgs::TransformStamped(), datatype) || visit(nav_msgs::Odometry(), datatype) ||
         visit(geometry_msgs::PoseArray(), datatype);
}

bool isGazebo(const std::string& datatype) { return datatype == kModelStates || datatype == kLinkStates; }

/// The keys beside the topic pick one of many; each goes with its own type.
void checkSelection(const std::string& datatype, const PoseSource& source) {
  const struct {
    const char* key;
    bool is_given;
    std::string type;
  } selections[] = {
      {"index", source.index >= 0, ros::message_traits::datatype<geometry_msgs::PoseArray>()},
      {"model", !source.model.empty(), kModelStates},
      {"link", !source.link.empty(), kLinkStates},
  };
  for (const auto& selection : selections) {
    if (datatype == selection.type && !selection.is_given)
      throw PoseError("type " + datatype + " needs `" + selection.key + "` beside the topic in the scene");
    if (datatype != selection.type && selection.is_given)
      throw PoseError("the scene's `" + std::string(selection.key) + "` is meant for " + selection.type +
                      ", the topic carries " + datatype);
  }
}

}  // namespace

void checkVersion(const std::string& datatype, const std::string& md5sum, const std::string& ours) {
  if (md5sum != ours)
    throw PoseError("type " + datatype + " has md5sum " + md5sum + ", this build knows " + ours +
                    ": recorded or sent with another version of the message");
}

void checkPoseType(const std::string& datatype, const std::string& md5sum, const PoseSource& source) {
  const bool known = withType(datatype, [&](auto message, const std::string& name) {
    using Message = decltype(message);
    if (name != ros::message_traits::datatype<Message>()) return false;
    checkVersion(name, md5sum, ros::message_traits::md5sum<Message>());
    return true;
  });
  if (!known && !isGazebo(datatype) && datatype != kPath)
    throw PoseError("type " + datatype + " carries no pose that can be read; supported: " + kSupported);
  if (isGazebo(datatype)) checkVersion(datatype, md5sum, kGazeboStatesMd5);
  if (datatype == kPath) checkVersion(datatype, md5sum, kPathMd5);
  checkSelection(datatype, source);
}

PoseReading readPose(const RawMessage& message, const PoseSource& source, motion::Nanoseconds received_ns) {
  checkPoseType(message.datatype, message.md5sum, source);
  PoseReading out;
  if (isGazebo(message.datatype)) {
    out.in_world = true;
    out.kind = StampKind::kGuessed;
    out.pose = readGazeboState(message, message.datatype == kModelStates ? source.model : source.link);
    out.pose.stamp_ns = received_ns;
    return out;
  }
  if (message.datatype == ros::message_traits::datatype<geometry_msgs::PoseArray>())
    checkArray(message, headerSize(message), ros::serialization::serializationLength(geometry_msgs::Pose()));
  withType(message.datatype, [&](auto empty, const std::string& name) {
    using Message = decltype(empty);
    if (name != ros::message_traits::datatype<Message>()) return false;
    out = read(deserialise<Message>(message), source);
    return true;
  });
  return out;
}

}  // namespace collision_node::messages

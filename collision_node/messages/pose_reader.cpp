#include "collision_node/messages/pose_reader.h"

#include <geometry_msgs/PoseArray.h>
#include <geometry_msgs/PoseStamped.h>
#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <geometry_msgs/TransformStamped.h>
#include <nav_msgs/Odometry.h>

#include "collision_node/messages/convert.h"
#include "collision_node/messages/deserialise.h"

namespace collision_node::messages {

namespace {

using motion::StampedPose;
using scene::PoseSource;

const char* const kSupported =
    "geometry_msgs/PoseStamped, PoseWithCovarianceStamped, TransformStamped, PoseArray (with index), "
    "nav_msgs/Odometry";

StampedPose stamped(const std_msgs::Header& header, const geometry_msgs::Pose& pose,
                    const std::string& world_frame) {
  if (withoutSlash(header.frame_id) != withoutSlash(world_frame))
    throw PoseError("header.frame_id is '" + header.frame_id + "', the scene's world_frame is '" +
                    world_frame +
                    "': poses must be given in world_frame (set it in the scene, or use pose: {tf: frame})");
  StampedPose out;
  out.stamp_ns = toNanoseconds(header.stamp);
  out.pose = fromPose(pose);
  return out;
}

StampedPose read(const geometry_msgs::PoseStamped& m, const PoseSource&, const std::string& world_frame) {
  return stamped(m.header, m.pose, world_frame);
}

StampedPose read(const geometry_msgs::PoseWithCovarianceStamped& m, const PoseSource&,
                 const std::string& world_frame) {
  return stamped(m.header, m.pose.pose, world_frame);
}

StampedPose read(const geometry_msgs::TransformStamped& m, const PoseSource&,
                 const std::string& world_frame) {
  geometry_msgs::Pose pose;
  pose.position.x = m.transform.translation.x;
  pose.position.y = m.transform.translation.y;
  pose.position.z = m.transform.translation.z;
  pose.orientation = m.transform.rotation;
  return stamped(m.header, pose, world_frame);
}

StampedPose read(const nav_msgs::Odometry& m, const PoseSource&, const std::string& world_frame) {
  StampedPose out = stamped(m.header, m.pose.pose, world_frame);
  const auto& twist = m.twist.twist;
  const Vec3 linear(twist.linear.x, twist.linear.y, twist.linear.z);
  const Vec3 angular(twist.angular.x, twist.angular.y, twist.angular.z);
  const double length2 = out.pose.orientation.squaredNorm();
  if (!linear.allFinite() || !angular.allFinite() || !(length2 > 0.5 && length2 < 2.0)) return out;
  const Quat turn = out.pose.orientation.normalized();  // a bad quaternion is refused later, with its pose
  out.linear = turn * linear;
  out.angular = turn * angular;
  out.has_twist = true;
  return out;
}

StampedPose read(const geometry_msgs::PoseArray& m, const PoseSource& source,
                 const std::string& world_frame) {
  if (source.index < 0 || static_cast<std::size_t>(source.index) >= m.poses.size())
    throw PoseError("index " + std::to_string(source.index) + " is beyond a PoseArray of " +
                    std::to_string(m.poses.size()) + " poses");
  return stamped(m.header, m.poses[static_cast<std::size_t>(source.index)], world_frame);
}

/// Calls `visit` with a default message of the named type; false when the type is none of ours.
template <typename Visit>
bool withType(const std::string& datatype, Visit&& visit) {
  return visit(geometry_msgs::PoseStamped(), datatype) ||
         visit(geometry_msgs::PoseWithCovarianceStamped(), datatype) ||
         visit(geometry_msgs::TransformStamped(), datatype) || visit(nav_msgs::Odometry(), datatype) ||
         visit(geometry_msgs::PoseArray(), datatype);
}

}  // namespace

void checkPoseType(const std::string& datatype, const std::string& md5sum, const PoseSource& source) {
  const bool known = withType(datatype, [&](auto message, const std::string& name) {
    using Message = decltype(message);
    if (name != ros::message_traits::datatype<Message>()) return false;
    const std::string ours = ros::message_traits::md5sum<Message>();
    if (md5sum != ours)
      throw PoseError("type " + name + " has md5sum " + md5sum + ", this build knows " + ours +
                      ": recorded or sent with another version of the message");
    return true;
  });
  if (!known)
    throw PoseError("type " + datatype + " carries no pose that can be read; supported: " + kSupported);
  if (datatype == ros::message_traits::datatype<geometry_msgs::PoseArray>() && source.index < 0)
    throw PoseError("type geometry_msgs/PoseArray needs `index` beside the topic in the scene");
}

StampedPose readPose(const RawMessage& message, const PoseSource& source, const std::string& world_frame) {
  checkPoseType(message.datatype, message.md5sum, source);
  if (message.datatype == ros::message_traits::datatype<geometry_msgs::PoseArray>())
    checkArray(message, headerSize(message), ros::serialization::serializationLength(geometry_msgs::Pose()));
  StampedPose out;
  withType(message.datatype, [&](auto empty, const std::string& name) {
    using Message = decltype(empty);
    if (name != ros::message_traits::datatype<Message>()) return false;
    out = read(deserialise<Message>(message), source, world_frame);
    return true;
  });
  return out;
}

}  // namespace collision_node::messages

/// Core facts <-> ROS messages, field by field.
#pragma once

#include <ros/time.h>

#include <string>

#include "collision_node/Impact.h"
#include "collision_node/IntervalStats.h"
#include "collision_node/scene/engine.h"

namespace collision_node::messages {

using geometry::Pose;
using geometry::Quat;
using geometry::Vec3;
using motion::Nanoseconds;

/// ROS 1 time is unsigned and 32 bits of seconds: anything outside [0, 2^32 s) becomes its nearest end.
ros::Time toTime(Nanoseconds ns);
Nanoseconds toNanoseconds(const ros::Time& time);

/// No slash in front: tf2 names. Both "/world" and "world" mean the same frame.
std::string withoutSlash(const std::string& frame);

Impact toMessage(const scene::Event& event, const std::string& world_frame);

/// The way back; exact, because toMessage loses nothing (stamps within ROS time).
scene::Event fromMessage(const Impact& message);

IntervalStats toMessage(const scene::Stats& stats, const std::string& world_frame);

geometry_msgs::Point toPoint(const Vec3& v);
geometry_msgs::Pose toPose(const Pose& pose);
Pose fromPose(const geometry_msgs::Pose& pose);

}  // namespace collision_node::messages

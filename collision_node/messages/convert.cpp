#include "collision_node/messages/convert.h"

#include <algorithm>
#include <limits>

namespace collision_node::messages {

namespace {

constexpr Nanoseconds kSecond = 1'000'000'000;

geometry_msgs::Vector3 toVector3(const Vec3& v) {
  geometry_msgs::Vector3 out;
  out.x = v.x();
  out.y = v.y();
  out.z = v.z();
  return out;
}

template <typename Message>
Vec3 fromXyz(const Message& m) {
  return {m.x, m.y, m.z};
}

ImpactSide toSide(const scene::EventSide& side) {
  ImpactSide out;
  out.object = side.object;
  out.link = side.link;
  out.zone = side.zone;
  out.zone_certain = side.zone_certain;
  out.shape = side.shape;
  out.feature = static_cast<std::uint8_t>(side.feature);
  out.triangle = side.triangle;
  out.point = toPoint(side.point);
  out.pose = toPose(side.pose);
  out.sample_before = toTime(side.sample_before_ns);
  out.sample_after = toTime(side.sample_after_ns);
  return out;
}

scene::EventSide fromSide(const ImpactSide& side) {
  scene::EventSide out;
  out.object = side.object;
  out.link = side.link;
  out.zone = side.zone;
  out.zone_certain = side.zone_certain;
  out.shape = side.shape;
  out.feature = static_cast<impact::Feature>(side.feature);
  out.triangle = side.triangle;
  out.point = fromXyz(side.point);
  out.pose = fromPose(side.pose);
  out.sample_before_ns = toNanoseconds(side.sample_before);
  out.sample_after_ns = toNanoseconds(side.sample_after);
  return out;
}

}  // namespace

ros::Time toTime(Nanoseconds ns) {
  const Nanoseconds last =
      (static_cast<Nanoseconds>(std::numeric_limits<std::uint32_t>::max()) + 1) * kSecond - 1;
  const Nanoseconds kept = std::clamp<Nanoseconds>(ns, 0, last);
  return {static_cast<std::uint32_t>(kept / kSecond), static_cast<std::uint32_t>(kept % kSecond)};
}

Nanoseconds toNanoseconds(const ros::Time& time) {
  return static_cast<Nanoseconds>(time.sec) * kSecond + static_cast<Nanoseconds>(time.nsec);
}

std::string withoutSlash(const std::string& frame) {
  return !frame.empty() && frame.front() == '/' ? frame.substr(1) : frame;
}

geometry_msgs::Point toPoint(const Vec3& v) {
  geometry_msgs::Point out;
  out.x = v.x();
  out.y = v.y();
  out.z = v.z();
  return out;
}

geometry_msgs::Pose toPose(const Pose& pose) {
  geometry_msgs::Pose out;
  out.position = toPoint(pose.position);
  out.orientation.x = pose.orientation.x();
  out.orientation.y = pose.orientation.y();
  out.orientation.z = pose.orientation.z();
  out.orientation.w = pose.orientation.w();
  return out;
}

Pose fromPose(const geometry_msgs::Pose& pose) {
  const auto& q = pose.orientation;
  return {fromXyz(pose.position), Quat(q.w, q.x, q.y, q.z)};
}

Impact toMessage(const scene::Event& event, const std::string& world_frame) {
  Impact out;
  out.header.stamp = toTime(event.stamp_ns);
  out.header.frame_id = world_frame;
  out.epoch = event.epoch;
  out.event_id = event.event_id;
  out.contact_id = event.contact_id;
  out.kind = static_cast<std::uint8_t>(event.kind);
  out.certificate = static_cast<std::uint8_t>(event.certificate);
  out.reason = static_cast<std::uint8_t>(event.reason);
  out.interval_start = toTime(event.interval_start_ns);
  out.interval_end = toTime(event.interval_end_ns);
  out.toi_lower = event.toi_lower;
  out.toi_upper = event.toi_upper;
  out.position = toPoint(event.position);
  out.position_error = event.position_error;
  out.multiple = event.multiple;
  out.normal = toVector3(event.normal);
  out.normal_error = event.normal_error;
  out.relative_velocity = toVector3(event.relative_velocity);
  out.closing_speed = event.closing_speed;
  out.model_toi_lower = event.model_toi_lower;
  out.model_toi_upper = event.model_toi_upper;
  out.model_position_error = event.model_position_error;
  out.a = toSide(event.a);
  out.b = toSide(event.b);
  return out;
}

scene::Event fromMessage(const Impact& message) {
  scene::Event out;
  out.stamp_ns = toNanoseconds(message.header.stamp);
  out.epoch = message.epoch;
  out.event_id = message.event_id;
  out.contact_id = message.contact_id;
  out.kind = static_cast<impact::Kind>(message.kind);
  out.certificate = static_cast<impact::Certificate>(message.certificate);
  out.reason = static_cast<impact::Reason>(message.reason);
  out.interval_start_ns = toNanoseconds(message.interval_start);
  out.interval_end_ns = toNanoseconds(message.interval_end);
  out.toi_lower = message.toi_lower;
  out.toi_upper = message.toi_upper;
  out.position = fromXyz(message.position);
  out.position_error = message.position_error;
  out.multiple = message.multiple;
  out.normal = fromXyz(message.normal);
  out.normal_error = message.normal_error;
  out.relative_velocity = fromXyz(message.relative_velocity);
  out.closing_speed = message.closing_speed;
  out.model_toi_lower = message.model_toi_lower;
  out.model_toi_upper = message.model_toi_upper;
  out.model_position_error = message.model_position_error;
  out.a = fromSide(message.a);
  out.b = fromSide(message.b);
  return out;
}

IntervalStats toMessage(const scene::Stats& stats, const std::string& world_frame) {
  IntervalStats out;
  out.header.stamp = toTime(stats.stamp_ns);
  out.header.frame_id = world_frame;
  if (stats.has_watermark) out.watermark = toTime(stats.watermark_ns);
  out.epoch = stats.epoch;
  out.pairs_culled = stats.pairs_culled;
  out.pairs_clear = stats.pairs_clear;
  out.pairs_impact = stats.pairs_impact;
  out.pairs_undecided = stats.pairs_undecided;
  out.pairs_uncovered = stats.pairs_uncovered;
  out.uncovered_objects = stats.uncovered_objects;
  out.accepted = stats.accepted;
  out.reordered = stats.reordered;
  out.late = stats.late;
  out.duplicate = stats.duplicate;
  out.rejected = stats.rejected;
  out.lost = stats.lost;
  out.node_tests = stats.node_tests;
  out.subdivisions = stats.subdivisions;
  out.worst_bracket = stats.worst_bracket;
  out.worst_position_error = stats.worst_position_error;
  out.wall_time = stats.wall_time;
  return out;
}

}  // namespace collision_node::messages

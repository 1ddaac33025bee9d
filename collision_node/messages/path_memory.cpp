#include "collision_node/messages/path_memory.h"

#include <nav_msgs/Path.h>

#include <algorithm>
#include <utility>

#include "collision_node/messages/convert.h"
#include "collision_node/messages/deserialise.h"
#include "collision_node/messages/event_text.h"
#include "collision_node/scene/fingerprint.h"

namespace collision_node::messages {

const char* const kPath = ros::message_traits::datatype<nav_msgs::Path>();
const char* const kPathMd5 = ros::message_traits::md5sum<nav_msgs::Path>();

namespace {

/// Bytes of a PoseStamped with an empty frame.
constexpr std::uint32_t kLeastPose = 16 + 7 * 8;

bool isSame(const motion::StampedPose& a, const motion::StampedPose& b) {
  return a.pose.position == b.pose.position && a.pose.orientation.coeffs() == b.pose.orientation.coeffs();
}

void checkStamps(const std::vector<PoseReading>& path) {
  if (path.empty()) return;
  const auto stamp = [&](std::size_t i) { return path[i].pose.stamp_ns; };
  const std::size_t last = path.size() - 1;
  for (std::size_t i = 1; i <= last; ++i)
    if (stamp(i) < stamp(i - 1))
      throw PoseError("the stamps of a nav_msgs/Path go back: pose " + std::to_string(i) + " has " +
                      secondsText(stamp(i)) + " s after " + secondsText(stamp(i - 1)) +
                      " s; each pose needs the instant when the object is there");
  const bool all_equal = last > 0 && stamp(0) == stamp(last);
  if (stamp(last) == 0 || all_equal)
    throw PoseError("all " + std::to_string(path.size()) + " poses of a nav_msgs/Path have the stamp " +
                    secondsText(stamp(0)) +
                    " s: a plan, not a track; each pose needs the instant when the object is there");
}

void checkFrames(const std::vector<PoseReading>& path) {
  for (const PoseReading& reading : path)
    if (reading.frame != path.front().frame)
      throw PoseError("the poses of a nav_msgs/Path are in the frames '" + path.front().frame + "' and '" +
                      reading.frame + "'; one is needed");
}

}  // namespace

std::vector<PoseReading> readPath(const RawMessage& message) {
  checkVersion(message.datatype, message.md5sum, kPathMd5);
  checkArray(message, headerSize(message), kLeastPose);
  const auto read = deserialise<nav_msgs::Path>(message);
  std::vector<PoseReading> path;
  path.reserve(read.poses.size());
  for (const auto& pose : read.poses) {
    PoseReading reading;
    reading.frame = withoutSlash(pose.header.frame_id.empty() ? read.header.frame_id : pose.header.frame_id);
    reading.pose.stamp_ns = toNanoseconds(pose.header.stamp);
    reading.pose.pose = fromPose(pose.pose);
    reading.pose.comes_ahead = true;
    path.push_back(std::move(reading));
  }
  checkStamps(path);
  checkFrames(path);
  return path;
}

std::vector<PoseReading> PathMemory::news(std::vector<PoseReading> path) {
  if (path.empty()) return {};
  const motion::Nanoseconds end_ns = path.back().pose.stamp_ns;
  if (newest_ && end_ns < *newest_ - jump_ns_) forget();
  if (!newest_) before_.clear();
  std::vector<PoseReading> out;
  for (const PoseReading& reading : path) {
    const motion::Nanoseconds stamp_ns = reading.pose.stamp_ns;
    const auto known = std::lower_bound(
        before_.begin(), before_.end(), stamp_ns,
        [](const PoseReading& one, motion::Nanoseconds ns) { return one.pose.stamp_ns < ns; });
    if (known != before_.end() && known->pose.stamp_ns == stamp_ns) {
      if (!isSame(known->pose, reading.pose)) ++duplicates_;
    } else if (newest_ && stamp_ns <= *newest_ - reorder_ns_) {
      ++late_;
    } else {
      out.push_back(reading);
    }
  }
  newest_ = std::max(end_ns, newest_.value_or(end_ns));
  before_ = std::move(path);
  return out;
}

void PathMemory::describe(scene::Fingerprint& to) const {
  to.add(newest_);
  if (!newest_) return;
  to.add(before_.size());
  for (const PoseReading& reading : before_) to.add(reading.pose);
}

}  // namespace collision_node::messages

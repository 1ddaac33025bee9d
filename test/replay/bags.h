/// Small bags and scenes for the tests of replay, in a folder that goes away.
#pragma once

#include <geometry_msgs/PoseStamped.h>
#include <rosbag/bag.h>
#include <tf2_msgs/TFMessage.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

#include "collision_node/replay/replay.h"
#include "test/support/temp_folder.h"

namespace collision_node::test {

inline std::string bytesOf(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

inline void writeBytes(const std::string& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary) << bytes;
}

/// A wall in the plane x = 0 (1 m thick) and a ball that flies through it along x at 1000 m/s, 30 Hz, 2 s; it
/// starts 100.3 m away. Impact: x = -0.5 - 0.1.
inline const char* const kScene = R"(world_frame: world
objects:
  ball:
    sphere: {radius: 0.1}
    pose: {topic: ball/pose}
  wall:
    box: {size: [1, 20, 20]}
    pose: {fixed: {position: [0, 0, 0], orientation: [0, 0, 0, 1]}}
time: {reorder: 0.1, max_gap: 0.3, timeout: 0.5, jump: 1.0}
)";

constexpr double kStart = -100.3, kSpeed = 1000.0;
constexpr std::int64_t kFirstNs = 1'700'000'000'000'000'000;

constexpr std::int64_t kMs = 1'000'000;

/// `ns` after the first stamp.
inline ros::Time after(std::int64_t ns) {
  ros::Time time;
  time.fromNSec(static_cast<std::uint64_t>(kFirstNs + ns));
  return time;
}

inline tf2_msgs::TFMessage transform(const std::string& parent, const std::string& child, std::int64_t ns,
                                     double x, double y = 0.0, double yaw = 0.0) {
  tf2_msgs::TFMessage out;
  out.transforms.resize(1);
  auto& t = out.transforms[0];
  t.header.frame_id = parent;
  t.header.stamp = after(ns);
  t.child_frame_id = child;
  t.transform.translation.x = x;
  t.transform.translation.y = y;
  t.transform.rotation.z = std::sin(0.5 * yaw);
  t.transform.rotation.w = std::cos(0.5 * yaw);
  return out;
}

inline geometry_msgs::PoseStamped ballPose(int i, const std::string& frame = "world") {
  geometry_msgs::PoseStamped p;
  const std::int64_t ns = kFirstNs + 33'333'333LL * i;
  p.header.stamp.fromNSec(static_cast<std::uint64_t>(ns));
  p.header.frame_id = frame;
  p.pose.position.x = kStart + kSpeed * 1e-9 * 33'333'333.0 * i;
  p.pose.orientation.w = 1.0;
  return p;
}

/// `chunk`: bytes per chunk; small ones leave something to damage in the middle.
inline void writeBall(const std::string& file, int count = 60, const std::string& topic = "/ball/pose",
                      const std::string& frame = "world", std::uint32_t chunk = 768 * 1024) {
  rosbag::Bag bag(file, rosbag::bagmode::Write);
  bag.setCompression(rosbag::compression::LZ4);
  bag.setChunkThreshold(chunk);
  for (int i = 0; i < count; ++i) {
    const auto pose = ballPose(i, frame);
    bag.write(topic, pose.header.stamp, pose);
  }
}

struct Outcome {
  int code = -1;
  std::string out, err;
};

inline Outcome replayed(const std::vector<std::string>& arguments) {
  std::ostringstream out, err;
  Outcome outcome;
  try {
    outcome.code = replay::run(replay::parseOptions(arguments), out, err, false);
  } catch (const replay::InputError& error) {
    err << error.what() << '\n';
    outcome.code = replay::kBadInput;
  }
  outcome.out = out.str();
  outcome.err = err.str();
  return outcome;
}

}  // namespace collision_node::test

/// Recordings with everything that makes windows hard: objects that pass through each other, streams of
/// different rates that are late, shuffled, broken off and in a loop, objects that spoke once, tf chains,
/// guessed stamps, tracks sent ahead, joints, and bounds of accelerations.
#pragma once

#include <geometry_msgs/PoseStamped.h>
#include <nav_msgs/Path.h>
#include <rosbag/bag.h>
#include <sensor_msgs/JointState.h>
#include <tf2_msgs/TFMessage.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "test/support/gazebo_states.h"

namespace collision_node::test {

/// The memory of the tracks (timeout + max_gap + reorder + jump) is 0.9 s.
inline const char* const kRandomScene = R"(world_frame: world
objects:
  ball:
    sphere: {radius: 0.4}
    pose: {topic: ball/pose}
    acceleration: 2
  block:
    box: {size: [1, 1, 1]}
    pose: {topic: block/pose}
    on_timeout: freeze
  dart:
    capsule: {radius: 0.1, length: 0.5}
    pose: {tf: tip}
  stone:
    box: {size: [2, 2, 0.5]}
    pose: {topic: stone/pose}
    on_timeout: freeze
  puck:
    sphere: {radius: 0.3}
    pose: {topic: gazebo/model_states, model: puck}
  lark:
    sphere: {radius: 0.2}
    pose: {topic: lark/path}
  crane:
    urdf: crane.urdf
    pose: {fixed: {position: [0, -1, 0]}}
    joints: {topic: crane/joints}
  floor:
    box: {size: [30, 30, 1]}
    pose: {fixed: {position: [0, 0, -2]}}
  post:
    box: {size: [0.4, 0.4, 4]}
    pose: {fixed: {position: [3, 0, 0]}}
time: {reorder: 0.05, max_gap: 0.15, timeout: 0.4, jump: 0.3}
)";

/// An arm of 3 m that turns about z.
inline const char* const kCraneUrdf = R"(<robot name="crane">
  <link name="foot"><collision><geometry><box size="0.3 0.3 0.3"/></geometry></collision></link>
  <link name="arm"><collision><origin xyz="1.5 0 0"/><geometry><box size="3 0.2 0.2"/></geometry></collision></link>
  <joint name="turn" type="continuous"><parent link="foot"/><child link="arm"/><origin xyz="0 0 0.3"/><axis xyz="0 0 1"/></joint>
</robot>)";

class RandomRecording {
 public:
  struct Traits {
    bool loops = false;       ///< stamps begin again, twice
    bool stone_once = false;  ///< the stone speaks once, at the begin
    bool holes = true;
  };

  RandomRecording(std::uint32_t seed, const Traits& traits) : random_(seed), traits_(traits) {
    constexpr double kSeconds = 8.0;
    tf("/tf_static", 0.0, 0.0, "dart", "tip", 0.0);
    stream("block", 0.031, kSeconds);
    stream("ball", 0.0173, kSeconds);
    stream("dart", 0.025, kSeconds);
    stream("puck", 0.04, kSeconds);
    stream("crane", 0.05, kSeconds);
    for (double t = 0.0; t < kSeconds; t += kChunk) path(t);
    if (traits.stone_once) {
      pose("stone", 0.01, 0.01, {2.0, 0.0, 0.0});
    } else {
      stream("stone", 0.09, kSeconds);
    }
    std::stable_sort(messages_.begin(), messages_.end(),
                     [](const Message& l, const Message& r) { return l.received < r.received; });
  }

  void write(const std::string& file) const {
    rosbag::Bag bag(file, rosbag::bagmode::Write);
    bag.setCompression(rosbag::compression::LZ4);
    bag.setChunkThreshold(4000);
    for (const Message& m : messages_) m.write(bag, m.received);
  }

  /// Receive times, in order, after the first one [ns].
  std::vector<std::int64_t> received() const {
    std::vector<std::int64_t> out;
    for (const Message& m : messages_)
      out.push_back(static_cast<std::int64_t>(m.received.toNSec() - messages_.front().received.toNSec()));
    return out;
  }

 private:
  struct Message {
    ros::Time received;
    std::function<void(rosbag::Bag&, const ros::Time&)> write;
  };
  static constexpr double kChunk = 0.5;  ///< of a track that is sent ahead; loops begin between two [s]
  struct Point {
    double x, y, z;
  };

  double between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  bool chance(double p) { return between(0.0, 1.0) < p; }
  static ros::Time time(double seconds) {
    ros::Time out;
    out.fromNSec(1'000'000'000'000ULL + static_cast<std::uint64_t>(std::llround(seconds * 1e9)));
    return out;
  }

  /// Stamps begin again at 3 and at 5.5 s.
  double stampOf(double t) const {
    if (!traits_.loops) return t;
    return t < 3.0 ? t : t < 5.5 ? t - 3.0 : t - 5.5;
  }

  void stream(const std::string& name, double period, double seconds) {
    const double turn[3] = {between(0.3, 2.0), between(0.2, 1.5), between(0.1, 0.7)};
    const double size[3] = {between(1.0, 4.0), between(0.1, 1.5), between(0.1, 1.5)};
    double silent_until = 0.0;
    const double begins = chance(0.3) ? between(0.0, 2.0) : 0.0;
    for (double t = begins + between(0.0, period); t < seconds; t += period * between(0.7, 1.3)) {
      if (traits_.holes && chance(0.01)) silent_until = t + (chance(0.5) ? 0.25 : between(0.5, 1.2));
      if (t < silent_until) continue;
      const double delay = chance(0.1) ? between(0.0, 0.08) : between(0.0, 0.005);
      const Point at{size[0] * std::sin(turn[0] * t), size[1] * std::sin(turn[1] * t),
                     size[2] * std::sin(turn[2] * t)};
      const double stamp = chance(0.005) ? stampOf(t) - 0.2 : stampOf(t);
      if (name == "puck") {
        states(t + delay, at);
      } else if (name == "crane") {
        joint(t + delay, stamp, at.x);
      } else if (name == "dart") {
        tf("/tf", t + delay, stamp, "world", "cart", at.x);
        tf("/tf", t + delay + 0.001, stampOf(t + 0.001), "cart", "dart", at.y);
      } else {
        pose(name, t + delay, stamp, at);
      }
    }
  }

  template <typename M>
  void add(double received, const std::string& topic, const M& message) {
    messages_.push_back({time(received), [topic, message](rosbag::Bag& bag, const ros::Time& at) {
                           bag.write(topic, at, message);
                         }});
  }

  static geometry_msgs::Pose poseAt(const Point& at) {
    geometry_msgs::Pose pose;
    pose.position.x = at.x;
    pose.position.y = at.y;
    pose.position.z = at.z;
    pose.orientation.w = 1.0;
    return pose;
  }

  static geometry_msgs::PoseStamped stamped(double stamp, const Point& at) {
    geometry_msgs::PoseStamped m;
    m.header.stamp = time(stamp);
    m.header.frame_id = "world";
    m.pose = poseAt(at);
    return m;
  }

  void pose(const std::string& name, double received, double stamp, const Point& at) {
    add(received, "/" + name + "/pose", stamped(stamp, at));
  }

  void states(double received, const Point& at) {
    test_support::ModelStates m;
    m.name = {"ground", "puck"};
    m.pose = {poseAt({0.0, 0.0, 0.0}), poseAt(at)};
    m.twist.resize(2);
    add(received, "/gazebo/model_states", m);
  }

  void joint(double received, double stamp, double position) {
    sensor_msgs::JointState m;
    m.header.stamp = time(stamp);
    m.name = {"turn"};
    m.position = {position};
    add(received, "/crane/joints", m);
  }

  void path(double begins) {
    nav_msgs::Path m;
    m.header.frame_id = "world";
    for (double t = 0.0; t < 0.99 * kChunk; t += 0.1 * kChunk)
      m.poses.push_back(
          stamped(stampOf(begins) + t, {3.0 * std::sin(begins + t), 0.3 * std::cos(begins + t), 0.1}));
    add(begins + between(0.0, 0.02), "/lark/path", m);
  }

  void tf(const std::string& topic, double received, double stamp, const std::string& parent,
          const std::string& child, double x) {
    tf2_msgs::TFMessage m;
    m.transforms.resize(1);
    auto& t = m.transforms[0];
    t.header.stamp = time(stamp);
    t.header.frame_id = parent;
    t.child_frame_id = child;
    t.transform.translation.x = x;
    t.transform.rotation.w = 1.0;
    add(received, topic, m);
  }

  std::mt19937 random_;
  Traits traits_;
  std::vector<Message> messages_;
};

}  // namespace collision_node::test

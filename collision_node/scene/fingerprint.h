/// A number that stands for a state: equal states have equal ones, different states do not by accident.
#pragma once

#include <cstdint>
#include <cstring>
#include <optional>
#include <string_view>
#include <type_traits>

#include "collision_node/motion/rigid_motion.h"
#include "collision_node/motion/stamped_pose.h"

namespace collision_node::scene {

/// FNV-1a over everything added, in order. Reals count by their bits.
class Fingerprint {
 public:
  template <typename T>
  std::enable_if_t<std::is_integral_v<T> || std::is_enum_v<T>> add(T value) {
    bytes(static_cast<std::uint64_t>(value));
  }
  void add(double value) {
    std::uint64_t bits;
    std::memcpy(&bits, &value, sizeof bits);
    bytes(bits);
  }
  void add(std::string_view text) {
    add(text.size());
    for (const char c : text) byte(static_cast<unsigned char>(c));
  }
  template <typename T>
  void add(const std::optional<T>& value) {
    add(value.has_value());
    if (value) add(*value);
  }
  void add(const geometry::Vec3& v) {
    for (int i = 0; i < 3; ++i) add(v[i]);
  }
  void add(const geometry::Quat& q) {
    for (int i = 0; i < 4; ++i) add(q.coeffs()[i]);
  }
  void add(const geometry::Pose& pose) {
    add(pose.position);
    add(pose.orientation);
  }
  void add(const motion::StampedPose& pose) {
    add(pose.stamp_ns);
    add(pose.pose);
    add(pose.has_twist);
    add(pose.linear);
    add(pose.angular);
    add(pose.turned);
    add(pose.comes_ahead);
    add(pose.model_position);
    add(pose.model_angle);
    add(pose.begins_anew);
    add(pose.may_alias);
  }
  void add(const motion::RigidMotion& motion) {
    add(motion.start_ns);
    add(motion.end_ns);
    add(motion.fixed);
    for (const auto& c : motion.c) add(c);
    add(motion.q0);
    add(motion.omega);
    add(motion.turn_error);
    add(motion.rate_error);
  }

  std::uint64_t value() const { return value_; }

 private:
  void byte(std::uint64_t value) { value_ = (value_ ^ value) * 1099511628211u; }
  void bytes(std::uint64_t value) {
    for (int i = 0; i < 8; ++i, value >>= 8) byte(value & 0xff);
  }

  std::uint64_t value_ = 14695981039346656037u;
};

}  // namespace collision_node::scene

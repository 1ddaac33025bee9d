#include "collision_node/messages/name_states.h"

#include <geometry_msgs/Pose.h>
#include <geometry_msgs/Twist.h>

#include <algorithm>
#include <vector>

#include "collision_node/messages/convert.h"
#include "collision_node/messages/deserialise.h"

namespace collision_node::messages {

const char* const kModelStates = "gazebo_msgs/ModelStates";
const char* const kLinkStates = "gazebo_msgs/LinkStates";
const char* const kGazeboStatesMd5 = "48c080191eb15c41858319b4d8a609c2";

namespace {

constexpr std::uint32_t kPoseSize = 7 * 8, kTwistSize = 6 * 8;

/// Reads front to back; whatever the bytes claim, no more is taken than they hold.
class Bytes {
 public:
  explicit Bytes(const RawMessage& raw) : raw_(raw) {}

  std::uint32_t count(std::uint32_t least) {
    checkArray(raw_, offset_, least);
    return take<std::uint32_t>();
  }
  std::vector<std::string> names() {
    std::vector<std::string> out(count(4));
    for (auto& name : out) {
      const std::uint32_t length = count(1);
      name.assign(reinterpret_cast<const char*>(raw_.data + offset_), length);
      offset_ += length;
    }
    return out;
  }
  template <typename Value>
  Value take() {
    Value value;
    ros::serialization::IStream stream(const_cast<std::uint8_t*>(raw_.data) + offset_, raw_.size - offset_);
    ros::serialization::deserialize(stream, value);
    offset_ += ros::serialization::serializationLength(value);
    return value;
  }
  void skip(std::uint32_t size) { offset_ += size; }

 private:
  const RawMessage& raw_;
  std::uint32_t offset_ = 0;
};

std::string listed(const std::vector<std::string>& names) {
  constexpr std::size_t kMost = 20;
  std::string out;
  for (std::size_t i = 0; i < names.size() && i < kMost; ++i) out += (i == 0 ? "" : ", ") + names[i];
  return names.empty() ? "nothing" : names.size() > kMost ? out + ", ..." : out;
}

void needSame(const RawMessage& raw, std::size_t names, const char* what, std::size_t values) {
  if (names == values) return;
  throw PoseError("a " + raw.datatype + " message has " + std::to_string(names) + " names and " +
                  std::to_string(values) + " " + what);
}

}  // namespace

motion::StampedPose readGazeboState(const RawMessage& message, const std::string& name) {
  Bytes bytes(message);
  const auto names = bytes.names();
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end())
    throw PoseError("'" + name + "' is not in the " + message.datatype + " message; it has " + listed(names));
  const auto index = static_cast<std::uint32_t>(found - names.begin());
  const std::uint32_t poses = bytes.count(kPoseSize);
  needSame(message, names.size(), "poses", poses);
  bytes.skip(index * kPoseSize);
  motion::StampedPose out;
  out.pose = fromPose(bytes.take<geometry_msgs::Pose>());
  bytes.skip((poses - 1 - index) * kPoseSize);
  const std::uint32_t twists = bytes.count(kTwistSize);
  needSame(message, names.size(), "twists", twists);
  bytes.skip(index * kTwistSize);
  const auto twist = bytes.take<geometry_msgs::Twist>();
  out.linear = Vec3(twist.linear.x, twist.linear.y, twist.linear.z);
  out.angular = Vec3(twist.angular.x, twist.angular.y, twist.angular.z);
  out.has_twist = out.linear.allFinite() && out.angular.allFinite();
  return out;
}

}  // namespace collision_node::messages

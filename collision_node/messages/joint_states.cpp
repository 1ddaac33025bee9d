#include "collision_node/messages/joint_states.h"

#include <sensor_msgs/JointState.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "collision_node/messages/convert.h"
#include "collision_node/messages/deserialise.h"

namespace collision_node::messages {

namespace {

template <typename Words>
std::string listed(const Words& words) {
  std::string out;
  for (const auto& word : words) out += (out.empty() ? "'" : ", '") + word + "'";
  return out.empty() ? "nothing" : out;
}

/// The arrays' claims of length, checked before room is made for them.
void checkArrays(const RawMessage& message) {
  std::uint32_t at = headerSize(message);
  std::uint32_t names = countArray(message, at, 4);
  for (at += 4; names > 0; --names) at += 4 + countArray(message, at, 1);
  for (int i = 0; i < 3; ++i) at += 4 + 8 * countArray(message, at, 8);
}

}  // namespace

void checkJointType(const std::string& datatype, const std::string& md5sum) {
  const std::string ours = ros::message_traits::datatype<sensor_msgs::JointState>();
  if (datatype != ours) throw PoseError("type " + datatype + " holds no joint states; " + ours + " is read");
  checkVersion(datatype, md5sum, ros::message_traits::md5sum<sensor_msgs::JointState>());
}

JointStates readJointStates(const RawMessage& message) {
  checkJointType(message.datatype, message.md5sum);
  checkArrays(message);
  const auto read = deserialise<sensor_msgs::JointState>(message);
  if (read.name.size() != read.position.size())
    throw PoseError("a sensor_msgs/JointState message has " + std::to_string(read.name.size()) +
                    " names and " + std::to_string(read.position.size()) +
                    " positions; each joint needs its position");
  JointStates states;
  states.stamp_ns = toNanoseconds(read.header.stamp);
  std::set<std::string> seen;
  for (std::size_t i = 0; i < read.name.size(); ++i) {
    if (!seen.insert(read.name[i]).second)
      throw PoseError("a sensor_msgs/JointState message names joint '" + read.name[i] + "' twice");
    JointStates::One one;
    one.name = read.name[i];
    one.position = read.position[i];
    if (read.velocity.size() == read.name.size() && std::isfinite(read.velocity[i]))
      one.rate = read.velocity[i];
    states.joints.push_back(std::move(one));
  }
  return states;
}

void JointEdges::add(Edge edge) {
  for (const Edge& known : edges_)
    if (known.child == edge.child) return;
  edges_.push_back(std::move(edge));
}

bool JointEdges::isFinite(const JointStates::One& one, std::string& fault) {
  if (std::isfinite(one.position)) return true;
  fault = "joint '" + one.name + "' is at " + std::to_string(one.position) + "; it must be finite";
  return false;
}

std::string JointEdges::noneIsKnown(const JointStates& states) const {
  std::vector<std::string> names;
  std::set<std::string> wanted;
  for (const auto& one : states.joints) names.push_back(one.name);
  for (const Edge& edge : edges_) wanted.insert(edge.joint.joint.driver);
  return "no joint of the message moves a shape here; it has " + listed(names) + ", waited for are " +
         listed(wanted);
}

std::vector<std::string> JointEdges::missing() const {
  std::vector<std::string> out;
  for (const Edge& edge : edges_) {
    if (edge.has_come) continue;
    const std::string& driver = edge.joint.joint.driver;
    const std::string line =
        "joint '" + driver + "' of object '" + edge.object + "'" +
        (others_.empty() ? "" : "; what came beside the joints it has: " + listed(others_));
    if (std::find(out.begin(), out.end(), line) == out.end()) out.push_back(line);
  }
  return out;
}

}  // namespace collision_node::messages

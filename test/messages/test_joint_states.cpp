/// Joint states as they come, good and bad, and what they move.
#include <gtest/gtest.h>
#include <nav_msgs/Odometry.h>
#include <sensor_msgs/JointState.h>

#include <limits>

#include "collision_node/messages/joint_states.h"
#include "test/messages/wire.h"

namespace collision_node::messages {
namespace {

sensor_msgs::JointState stateOf(const std::vector<std::string>& names, const std::vector<double>& positions) {
  sensor_msgs::JointState out;
  out.header.stamp = ros::Time(3);
  out.name = names;
  out.position = positions;
  return out;
}

std::string refusalOf(const sensor_msgs::JointState& state) {
  try {
    readJointStates(Wire<sensor_msgs::JointState>(state).raw);
  } catch (const PoseError& error) {
    return error.what();
  }
  return "taken";
}

JointEdges::Edge edgeOf(const std::string& joint, const std::string& driver) {
  JointEdges::Edge edge;
  edge.object = "arm";
  edge.parent = "before " + joint;
  edge.child = "behind " + joint;
  edge.joint.joint.kind = geometry::UrdfJoint::Kind::kPrismatic;
  edge.joint.joint.name = joint;
  edge.joint.joint.driver = driver;
  return edge;
}

struct Edges {
  Edges() {
    edges.add(edgeOf("lift", "lift"));
    edges.add(edgeOf("jaw", "lift"));
    edges.add(edgeOf("turn", "turn"));
    edges.add(edgeOf("turn", "turn"));
  }
  std::string send(const sensor_msgs::JointState& state) {
    try {
      edges.take(readJointStates(Wire<sensor_msgs::JointState>(state).raw),
                 [this](const JointEdges::Edge& edge, const motion::StampedPose& pose) {
                   moved.emplace_back(edge.child, pose.pose.position.x());
                 });
    } catch (const PoseError& error) {
      return error.what();
    }
    return "taken";
  }
  JointEdges edges;
  std::vector<std::pair<std::string, double>> moved;
};

TEST(JointStates, areReadByName) {
  auto state = stateOf({"a", "b"}, {1.0, 2.0});
  state.velocity = {std::numeric_limits<double>::quiet_NaN(), 5.0};
  const JointStates read = readJointStates(Wire<sensor_msgs::JointState>(state).raw);
  EXPECT_EQ(read.stamp_ns, 3'000'000'000);
  ASSERT_EQ(read.joints.size(), 2u);
  EXPECT_EQ(read.joints[1].name, "b");
  EXPECT_EQ(read.joints[1].position, 2.0);
  EXPECT_FALSE(read.joints[0].rate);
  EXPECT_EQ(read.joints[1].rate, 5.0);
}

TEST(JointStates, thatCannotBeReadAreRefused) {
  EXPECT_EQ(refusalOf(stateOf({"a", "b"}, {1.0})),
            "a sensor_msgs/JointState message has 2 names and 1 positions; each joint needs its position");
  EXPECT_EQ(refusalOf(stateOf({"a", "a"}, {1.0, 2.0})),
            "a sensor_msgs/JointState message names joint 'a' twice");
  const std::string odometry = ros::message_traits::datatype<nav_msgs::Odometry>();
  EXPECT_THROW(checkJointType(odometry, ros::message_traits::md5sum<nav_msgs::Odometry>()), PoseError);
  EXPECT_THROW(checkJointType("sensor_msgs/JointState", "0123"), PoseError);
  // Whatever length the bytes claim, and wherever they end.
  const Wire<sensor_msgs::JointState> good(stateOf({"abc", "d"}, {1.0, 2.0}));
  for (std::size_t i = 0; i < good.bytes.size(); ++i) {
    Wire<sensor_msgs::JointState> cut = good;
    cut.raw.data = cut.bytes.data();
    cut.raw.size = static_cast<std::uint32_t>(i);
    EXPECT_THROW(readJointStates(cut.raw), PoseError) << i;
    cut.raw.size = static_cast<std::uint32_t>(cut.bytes.size());
    cut.bytes[i] = 0xff;
    try {
      readJointStates(cut.raw);
    } catch (const PoseError&) {
    }
  }
}

TEST(JointStates, moveEveryEdgeOfTheirJoint) {
  Edges e;
  EXPECT_EQ(e.send(stateOf({"turn"}, {0.5})), "taken") << "each driver sends the joints that it knows";
  EXPECT_EQ(e.send(stateOf({"wheel", "lift"}, {9.0, 0.25})), "taken");
  using Moved = std::vector<std::pair<std::string, double>>;
  EXPECT_EQ(e.moved, (Moved{{"behind turn", 0.5}, {"behind lift", 0.25}, {"behind jaw", 0.25}}));
}

TEST(JointStates, whatIsNotKnownOrMissingIsNamed) {
  Edges e;
  EXPECT_EQ(
      e.send(stateOf({"wheel", "lft"}, {9.0, 1.0})),
      "no joint of the message moves a shape here; it has 'wheel', 'lft', waited for are 'lift', 'turn'");
  e.send(stateOf({"turn"}, {1.0}));
  EXPECT_EQ(e.edges.missing(),
            (std::vector<std::string>{
                "joint 'lift' of object 'arm'; what came beside the joints it has: 'lft', 'wheel'"}));
  e.send(stateOf({"lift"}, {1.0}));
  EXPECT_TRUE(e.edges.missing().empty());
}

TEST(JointStates, aPositionThatIsNotFiniteMovesNothing) {
  Edges e;
  EXPECT_EQ(e.send(stateOf({"lift", "turn"}, {std::numeric_limits<double>::quiet_NaN(), 1.0})),
            "joint 'lift' is at nan; it must be finite");
  ASSERT_EQ(e.moved.size(), 1u) << "the others of the message do";
  EXPECT_EQ(e.moved[0].first, "behind turn");
}

}  // namespace
}  // namespace collision_node::messages

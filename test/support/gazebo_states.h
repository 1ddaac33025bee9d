/// gazebo_msgs/ModelStates and LinkStates, written by hand: Debian has no gazebo_msgs.
#pragma once

#include <geometry_msgs/Pose.h>
#include <geometry_msgs/Twist.h>
#include <ros/message_traits.h>
#include <ros/serialization.h>

#include <string>
#include <vector>

namespace test_support {

struct GazeboStates {
  std::vector<std::string> name;
  std::vector<geometry_msgs::Pose> pose;
  std::vector<geometry_msgs::Twist> twist;
};
struct ModelStates : GazeboStates {};
struct LinkStates : GazeboStates {};

inline const char* const kStatesDefinition =
    "string[] name\ngeometry_msgs/Pose[] pose\ngeometry_msgs/Twist[] twist\n"
    "================================================================================\nMSG: "
    "geometry_msgs/Pose\n"
    "Point position\nQuaternion orientation\n"
    "================================================================================\nMSG: "
    "geometry_msgs/Point\n"
    "float64 x\nfloat64 y\nfloat64 z\n"
    "================================================================================\nMSG: "
    "geometry_msgs/Quaternion\nfloat64 x\nfloat64 y\nfloat64 z\nfloat64 w\n"
    "================================================================================\nMSG: "
    "geometry_msgs/Twist\n"
    "Vector3 linear\nVector3 angular\n"
    "================================================================================\nMSG: "
    "geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n";

}  // namespace test_support

namespace ros {
namespace message_traits {

#define TEST_SUPPORT_GAZEBO_TRAITS(Type)                                      \
  template <>                                                                 \
  struct IsMessage<test_support::Type> : TrueType {};                         \
  template <>                                                                 \
  struct DataType<test_support::Type> {                                       \
    static const char* value() { return "gazebo_msgs/" #Type; }               \
    static const char* value(const test_support::Type&) { return value(); }   \
  };                                                                          \
  template <>                                                                 \
  struct MD5Sum<test_support::Type> {                                         \
    static const char* value() { return "48c080191eb15c41858319b4d8a609c2"; } \
    static const char* value(const test_support::Type&) { return value(); }   \
  };                                                                          \
  template <>                                                                 \
  struct Definition<test_support::Type> {                                     \
    static const char* value() { return test_support::kStatesDefinition; }    \
    static const char* value(const test_support::Type&) { return value(); }   \
  };
TEST_SUPPORT_GAZEBO_TRAITS(ModelStates)
TEST_SUPPORT_GAZEBO_TRAITS(LinkStates)
#undef TEST_SUPPORT_GAZEBO_TRAITS

}  // namespace message_traits

namespace serialization {

template <typename States>
struct GazeboStatesSerializer {
  template <typename Stream, typename T>
  inline static void allInOne(Stream& stream, T states) {
    stream.next(states.name);
    stream.next(states.pose);
    stream.next(states.twist);
  }
  ROS_DECLARE_ALLINONE_SERIALIZER
};
template <>
struct Serializer<test_support::ModelStates> : GazeboStatesSerializer<test_support::ModelStates> {};
template <>
struct Serializer<test_support::LinkStates> : GazeboStatesSerializer<test_support::LinkStates> {};

}  // namespace serialization
}  // namespace ros

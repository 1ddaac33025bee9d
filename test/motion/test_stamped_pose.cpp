#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "collision_node/motion/stamped_pose.h"

namespace collision_node::motion {
namespace {

TEST(CheckAndNormalise, MakesTheQuaternionUnit) {
  StampedPose pose;
  pose.pose.orientation.coeffs() *= 1.004;  // |q|^2 - 1 = 0.008016
  EXPECT_EQ(checkAndNormalise(pose), PoseFault::kNone);
  EXPECT_NEAR(pose.pose.orientation.norm(), 1.0, 1e-15);
}

TEST(CheckAndNormalise, RefusesQuaternionsFarFromUnit) {
  for (const double scale : {0.0, 0.99, 1.006, 2.0}) {
    StampedPose pose;
    pose.pose.orientation.coeffs() *= scale;
    EXPECT_EQ(checkAndNormalise(pose), PoseFault::kQuaternion) << "scale " << scale;
  }
}

TEST(CheckAndNormalise, RefusesNumbersThatAreNotFinite) {
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    StampedPose position, orientation, twist;
    position.pose.position.y() = bad;
    orientation.pose.orientation.w() = bad;
    twist.has_twist = true;
    twist.angular.z() = bad;
    EXPECT_EQ(checkAndNormalise(position), PoseFault::kNotFinite);
    EXPECT_EQ(checkAndNormalise(orientation), PoseFault::kNotFinite);
    EXPECT_EQ(checkAndNormalise(twist), PoseFault::kNotFinite);
    twist.has_twist = false;  // a twist nobody meant is nobody's fault
    EXPECT_EQ(checkAndNormalise(twist), PoseFault::kNone);
  }
}

}  // namespace
}  // namespace collision_node::motion

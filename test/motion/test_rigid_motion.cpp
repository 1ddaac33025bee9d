#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "collision_node/motion/rigid_motion.h"

namespace collision_node::motion {
namespace {

constexpr double kPi = 3.141592653589793;

Quat about(const Vec3& axis, double angle) { return Quat(Eigen::AngleAxisd(angle, axis.normalized())); }

StampedPose stamped(Nanoseconds stamp, const Vec3& position, const Quat& orientation = Quat::Identity()) {
  StampedPose pose;
  pose.stamp_ns = stamp;
  pose.pose = {position, orientation};
  return pose;
}

/// Same rotation, whatever the quaternion's sign. [rad]
double angleBetween(const Quat& a, const Quat& b) { return a.angularDistance(b); }

TEST(StraightSlerp, MeetsBothPosesOnRandomSegments) {
  const unsigned seed = 20240611;
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 1000; ++i) {
    SCOPED_TRACE("seed " + std::to_string(seed) + " case " + std::to_string(i));
    const auto vec = [&] { return Vec3(normal(random), normal(random), normal(random)); };
    const auto quat = [&] {
      return Quat(normal(random), normal(random), normal(random), normal(random)).normalized();
    };
    const Nanoseconds start = 1'700'000'000'123'456'789;
    const StampedPose from = stamped(start, 100.0 * vec(), quat());
    const StampedPose to = stamped(start + 33'333'333, 100.0 * vec(), quat());
    const RigidMotion motion = straightSlerp(from, to);
    EXPECT_EQ(motion.c[0], from.pose.position);
    EXPECT_EQ(motion.q0.coeffs(), from.pose.orientation.coeffs());
    EXPECT_EQ(motion.at(0.0).position, from.pose.position);
    const Pose end = motion.at(secondsBetween(from.stamp_ns, to.stamp_ns));
    EXPECT_LT((end.position - to.pose.position).norm(), 1e-12);
    EXPECT_LT(angleBetween(end.orientation, to.pose.orientation), 1e-7);  // angularDistance's own limit
    EXPECT_LE(motion.omega.norm() * 0.033333333, kPi * (1 + 1e-12));
    const Pose middle = motion.at(0.5 * 0.033333333);
    EXPECT_LT(angleBetween(middle.orientation, from.pose.orientation.slerp(0.5, to.pose.orientation)), 1e-7);
  }
}

TEST(StraightSlerp, KeepsStepsThatAcosWouldLose) {
  const StampedPose from = stamped(0, Vec3::Zero());
  const StampedPose to = stamped(1'000'000'000, Vec3::Zero(), about(Vec3::UnitZ(), 1e-12));
  const RigidMotion motion = straightSlerp(from, to);
  EXPECT_NEAR(motion.omega.z(), 1e-12, 1e-24);
}

TEST(StraightSlerp, TurnsAboutWorldAxes) {
  const Quat start = about({1, 2, 3}, 1.0);
  const StampedPose from = stamped(0, Vec3::Zero(), start);
  const StampedPose to = stamped(500'000'000, Vec3::Zero(), about(Vec3::UnitX(), 0.4) * start);
  EXPECT_LT((straightSlerp(from, to).omega - Vec3(0.8, 0, 0)).norm(), 1e-14);
}

TEST(StraightSlerp, HalfATurnDoesNotDependOnTheQuaternionsSign) {
  const StampedPose from = stamped(0, Vec3::Zero());
  StampedPose to = stamped(1'000'000'000, Vec3::Zero(), Quat(0, 0, -1, 0));
  const Vec3 one = straightSlerp(from, to).omega;
  to.pose.orientation.coeffs() = -to.pose.orientation.coeffs();
  const Vec3 other = straightSlerp(from, to).omega;
  EXPECT_EQ(one, other);
  EXPECT_NEAR(one.y(), kPi, 1e-15);
}

TEST(FixedAt, StaysWhereItIs) {
  const Pose pose{{1, 2, 3}, about({1, 1, 0}, 0.3)};
  const RigidMotion motion = fixedAt(pose);
  EXPECT_TRUE(motion.fixed);
  EXPECT_EQ(motion.at(1e6).position, pose.position);
  EXPECT_EQ(motion.at(1e6).orientation.coeffs(), pose.orientation.coeffs());
}

TEST(Hermite, MeetsPositionsAndVelocitiesAtBothEnds) {
  StampedPose from = stamped(0, {1, 2, 3});
  StampedPose to = stamped(250'000'000, {4, -2, 0}, about(Vec3::UnitZ(), 0.1));
  from.has_twist = to.has_twist = true;
  from.linear = {10, 0, -3};
  to.linear = {-5, 7, 1};
  const RigidMotion motion = hermite(from, to);
  EXPECT_LT((motion.at(0.25).position - to.pose.position).norm(), 1e-13);
  EXPECT_LT((motion.velocity(0.0) - from.linear).norm(), 1e-13);
  EXPECT_LT((motion.velocity(0.25) - to.linear).norm(), 1e-12);
  EXPECT_EQ(motion.omega, straightSlerp(from, to).omega);
}

TEST(Hermite, ABallisticPathIsExact) {
  const Vec3 g(0, 0, -9.81), v0(300, 0, 20);
  const double h = 0.125;
  StampedPose from = stamped(0, Vec3::Zero());
  StampedPose to = stamped(125'000'000, v0 * h + 0.5 * g * h * h);
  from.has_twist = to.has_twist = true;
  from.linear = v0;
  to.linear = v0 + g * h;
  const RigidMotion motion = hermite(from, to);
  for (const double s : {0.01, 0.05, 0.1})
    EXPECT_LT((motion.at(s).position - (v0 * s + 0.5 * g * s * s)).norm(), 1e-12);
}

TEST(Spin, AddsTheTurnsThatTheTwistTells) {
  const double h = 0.1;
  for (const double angle : {0.3, 7.0, -7.0, 20.0, 4 * kPi}) {
    StampedPose from = stamped(0, Vec3::Zero(), about({1, 1, 1}, 0.7));
    StampedPose to = stamped(100'000'000, Vec3::Zero(), about(Vec3::UnitY(), angle) * from.pose.orientation);
    from.has_twist = to.has_twist = true;
    from.angular = to.angular = Vec3(0, angle / h, 0);
    const RigidMotion motion = spin(from, to);
    EXPECT_LT((motion.omega - from.angular).norm(), 1e-9 * std::abs(angle / h)) << "angle " << angle;
  }
}

}  // namespace
}  // namespace collision_node::motion

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
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

TEST(Spin, AnotherNumberOfTurnsThanTheExactOneIsSaidToBeAnywhere) {
  // Nearly equal quaternions p and q = p + d, with d exact: the vector of conj(p) q is that of conj(p) d.
  using Long = Eigen::Matrix<long double, 3, 1>;
  constexpr long double kTurn = 6.283185307179586476925286766559L;
  const unsigned seed = 20261127;
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> share(0.0, 1.0);
  int others = 0, unknown = 0;
  for (int i = 0; i < 20000; ++i) {
    SCOPED_TRACE("seed " + std::to_string(seed) + " case " + std::to_string(i));
    const auto vec = [&] { return Vec3(normal(random), normal(random), normal(random)); };
    const double angle = std::pow(10.0, -13.5 + 8.0 * share(random)),
                 far = std::pow(10.0, 5.0 * share(random));
    StampedPose from = stamped(0, Vec3::Zero(), about(vec(), 3.0 * share(random)));
    StampedPose to =
        stamped(1'000'000'000, Vec3::Zero(), (about(vec(), angle) * from.pose.orientation).normalized());
    from.has_twist = to.has_twist = true;
    from.angular = to.angular = far * vec().normalized();
    const Eigen::Quaternion<long double> p = from.pose.orientation.cast<long double>(),
                                         q = to.pose.orientation.cast<long double>();
    const Eigen::Quaternion<long double> d(q.w() - p.w(), q.x() - p.x(), q.y() - p.y(), q.z() - p.z());
    const Long step = (p.conjugate() * d).vec();
    const long double sine = step.norm();
    if (sine <= 1e-14L) continue;  // then the axis is the twist's
    const Long axis = p.normalized() * Long(step / sine);
    const long double turned = 2 * std::atan2(sine, p.dot(q));
    const long double extra = (axis.dot(from.angular.cast<long double>()) - turned) / kTurn;
    const Long truth = axis * (turned + kTurn * std::round(extra));
    const RigidMotion motion = spin(from, to);
    const Long omega = motion.omega.cast<long double>();
    unknown += motion.turn_error == 2.0;
    // rigid_motion.h: "and of their number: how much faster it may turn"
    EXPECT_GE(motion.omega.norm() + motion.rate_error,
              static_cast<double>(truth.norm()) * (1 - 1e-9) - 1e-14);
    if (std::abs(omega.norm() - truth.norm()) > 3.0L || omega.dot(truth) < 0) {
      ++others;
      EXPECT_EQ(motion.turn_error, 2.0) << "by " << omega.norm() << " rad instead of " << truth.norm();
    } else if (truth.norm() > 3.0L) {  // twice the axis's error
      EXPECT_LE(2 * (omega / omega.norm() - truth / truth.norm()).norm(), motion.turn_error + 64 * 0x1p-53L);
    }
  }
  EXPECT_GE(others, 20);
  EXPECT_LE(unknown, 4000);
  std::printf("another number of turns: %d, said to be anywhere: %d\n", others, unknown);
}

}  // namespace
}  // namespace collision_node::motion

// True motions that obey the bounds, integrated finely, against the model and its tube.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "collision_node/motion/model_error.h"
#include "collision_node/motion/rigid_motion.h"

namespace collision_node::motion {
namespace {

constexpr double kH = 0.1;  // [s] between the two poses
constexpr Nanoseconds kHns = 100'000'000;
constexpr int kSteps = 2000;

Vec3 anyDirection(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  return Vec3(normal(random), normal(random), normal(random)).normalized();
}

StampedPose poseAt(Nanoseconds ns, const Vec3& position, const Vec3& velocity = Vec3::Zero()) {
  StampedPose pose;
  pose.stamp_ns = ns;
  pose.pose.position = position;
  pose.has_twist = true;
  pose.linear = velocity;
  return pose;
}

/// A point's way under piecewise constant accelerations.
struct Way {
  std::vector<Vec3> position, velocity;  // at every step
};

Way wayUnder(const std::vector<Vec3>& accelerations, const Vec3& start_velocity) {
  Way way{{Vec3(1, 2, 3)}, {start_velocity}};
  const double dt = kH / kSteps;
  for (int i = 0; i < kSteps; ++i) {
    const Vec3& a = accelerations[static_cast<std::size_t>(i) * accelerations.size() / kSteps];
    way.position.push_back(way.position.back() + dt * way.velocity.back() + 0.5 * dt * dt * a);
    way.velocity.push_back(way.velocity.back() + dt * a);
  }
  return way;
}

double farthest(const Way& way, const RigidMotion& motion) {
  double most = 0.0;
  for (int i = 0; i <= kSteps; ++i)
    most = std::max(most, (way.position[i] - motion.at(kH * i / kSteps).position).norm());
  return most;
}

TEST(ModelError, NoPointThatObeysTheBoundLeavesTheTubeOfAStraightLineOrACubic) {
  const unsigned seed = 31;
  std::mt19937_64 random(seed);
  const double bound = 40.0;
  for (int round = 0; round < 500; ++round) {
    SCOPED_TRACE("seed " + std::to_string(seed) + " round " + std::to_string(round));
    std::vector<Vec3> accelerations;
    for (int i = 0; i < 1 + round % 8; ++i) accelerations.push_back(bound * anyDirection(random));
    const Way way = wayUnder(accelerations, 10.0 * anyDirection(random));
    const StampedPose from = poseAt(0, way.position.front(), way.velocity.front());
    const StampedPose to = poseAt(kHns, way.position.back(), way.velocity.back());
    EXPECT_LE(farthest(way, straightSlerp(from, to)), straightError(bound, kH) + 1e-12);
    EXPECT_LE(farthest(way, hermite(from, to)), cubicError(bound, from, to) + 1e-12);
  }
}

TEST(ModelError, TheTubesOfAStraightLineAndACubicCannotBeNarrower) {
  const double bound = 40.0;
  const Vec3 x(bound, 0, 0);
  const Way constant = wayUnder({x}, Vec3::Zero());
  EXPECT_GT(farthest(constant, straightSlerp(poseAt(0, constant.position.front()),
                                             poseAt(kHns, constant.position.back()))),
            0.999 * straightError(bound, kH));
  const Way there_and_back = wayUnder({x, -x, -x, x}, Vec3::Zero());
  const StampedPose from = poseAt(0, there_and_back.position.front(), there_and_back.velocity.front());
  const StampedPose to = poseAt(kHns, there_and_back.position.back(), there_and_back.velocity.back());
  EXPECT_GT(farthest(there_and_back, hermite(from, to)), 0.999 * cubicError(bound, from, to));
}

TEST(ModelError, VelocitiesThatNoMotionWithinTheBoundCanHaveGiveNoTube) {
  EXPECT_TRUE(
      std::isnan(cubicError(1.0, poseAt(0, {0, 0, 0}, {0, 0, 0}), poseAt(kHns, {0, 0, 0}, {0.2, 0, 0}))));
  EXPECT_TRUE(
      std::isnan(cubicError(1.0, poseAt(0, {0, 0, 0}, {1, 0, 0}), poseAt(kHns, {0, 0, 0}, {1, 0, 0}))));
  EXPECT_FALSE(
      std::isnan(cubicError(1.0, poseAt(0, {0, 0, 0}, {1, 0, 0}), poseAt(kHns, {0.1, 0, 0}, {1, 0, 0}))));
}

/// Orientations under a changing rate, and the largest of it.
struct Turning {
  std::vector<Quat> orientation;  // at every step
  double largest_rate = 0.0;
};

template <typename Rate>
Turning turningUnder(const Rate& rate) {
  Turning turning{{Quat::Identity()}, 0.0};
  const double dt = kH / kSteps;
  for (int i = 0; i < kSteps; ++i) {
    const Vec3 omega = rate((i + 0.5) * dt);
    const double angle = omega.norm() * dt;
    turning.largest_rate = std::max(turning.largest_rate, omega.norm());
    const Quat step(Eigen::AngleAxisd(angle, angle > 0.0 ? Vec3(omega.normalized()) : Vec3::UnitX()));
    turning.orientation.push_back((step * turning.orientation.back()).normalized());
  }
  return turning;
}

double farthestAngle(const Turning& turning) {
  StampedPose from = poseAt(0, Vec3::Zero()), to = poseAt(kHns, Vec3::Zero());
  from.pose.orientation = turning.orientation.front();
  to.pose.orientation = turning.orientation.back();
  const RigidMotion motion = straightSlerp(from, to);
  double most = 0.0;
  for (int i = 0; i <= kSteps; ++i)
    most = std::max(most, turning.orientation[i].angularDistance(motion.at(kH * i / kSteps).orientation));
  return most;
}

TEST(ModelError, NoBodyThatObeysTheBoundsLeavesTheTubeOfASlerp) {
  const unsigned seed = 32;
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> part(0.0, 1.0);
  double closest = 0.0;
  for (int round = 0; round < 1500; ++round) {
    SCOPED_TRACE("seed " + std::to_string(seed) + " round " + std::to_string(round));
    const double limit = 3.14 * std::sqrt(part(random)) / kH;  // [rad/s]
    const double bound = std::pow(10.0, -2.0 + 3.0 * part(random)) * limit / kH;
    // The rate follows a random way of its own; where it would be too fast it stands still.
    std::vector<Vec3> rates = {limit * std::cbrt(part(random)) * anyDirection(random)};
    const int changes = 1 + round % 6;
    Vec3 change = bound * anyDirection(random);
    for (int i = 0; i < kSteps; ++i) {
      if (i % (kSteps / changes) == 0) change = bound * anyDirection(random);
      const Vec3 next = rates.back() + kH / kSteps * change;
      rates.push_back(next.norm() <= limit ? next : rates.back());
    }
    const Turning turning = turningUnder([&](double t) {
      return rates[std::min<std::size_t>(kSteps, static_cast<std::size_t>(t / kH * kSteps))];
    });
    const double error = slerpError(bound, limit, kH);
    ASSERT_LE(farthestAngle(turning), error + 1e-7);
    closest = std::max(closest, farthestAngle(turning) / error);
  }
  EXPECT_GT(closest, 0.8);  // the tube is not wide by much
}

TEST(ModelError, AnEighthOfTheAccelerationIsNotEnoughForASlerp) {
  // The rate's change stays across the way on the unit quaternions, which itself turns at half the rate.
  const double rate = 2.9 / kH, bound = 2.0 / (kH * kH);
  Turning worst;
  double most = 0.0;
  for (const double twist : {-0.5, 0.5}) {
    Vec3 change = Vec3::Zero();
    std::vector<Vec3> rates;
    for (int i = 0; i < kSteps; ++i) {
      const double phase = twist * rate * (i + 0.5) * kH / kSteps - 0.5 * twist * rate * kH;
      change += kH / kSteps * bound * Vec3(0, std::cos(phase), std::sin(phase));
      rates.push_back(change);
    }
    const Vec3 middle = rates[kSteps / 2];
    const Turning turning = turningUnder([&](double t) -> Vec3 {
      return Vec3(rate, 0, 0) + rates[static_cast<std::size_t>(t / kH * kSteps)] - middle;
    });
    if (farthestAngle(turning) > most) worst = turning;
    most = std::max(most, farthestAngle(turning));
  }
  EXPECT_GT(most, 1.25 * bound * kH * kH / 8.0);
  EXPECT_LT(worst.largest_rate * kH, 3.14);
  EXPECT_LE(most, slerpError(bound, worst.largest_rate, kH));
}

TEST(ModelError, ATubeOfASlerpNeedsALimitOfTheSpinBelowHalfATurn) {
  EXPECT_FALSE(std::isnan(slerpError(1.0, 31.4, kH)));
  EXPECT_TRUE(std::isnan(slerpError(1.0, 31.5, kH)));
  EXPECT_TRUE(std::isnan(slerpError(1.0, std::numeric_limits<double>::infinity(), kH)));
  EXPECT_NEAR(slerpError(1e-3, 0.1, kH), 1e-3 * kH * kH / 8.0, 1e-9);
}

}  // namespace
}  // namespace collision_node::motion

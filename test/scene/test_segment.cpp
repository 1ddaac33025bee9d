/// Which segments are in doubt.
#include <gtest/gtest.h>

#include "collision_node/scene/tracks/segment.h"

namespace collision_node::scene {
namespace {

constexpr Nanoseconds kStep = 100'000'000;

motion::StampedPose poseAt(Nanoseconds stamp_ns, double x, bool has_twist) {
  motion::StampedPose pose;
  pose.stamp_ns = stamp_ns;
  pose.pose.position.x() = x;
  pose.has_twist = has_twist;
  pose.linear = Vec3(10, 0, 0);
  pose.angular = Vec3(0, 0, 50);  // most of a turn in a step
  return pose;
}

// README: "hermite and spin have twists that are the motion's own"
TEST(Segment, withoutTwistsHermiteAndSpinAreSlerpAndInDoubt) {
  for (const MotionModel model : {MotionModel::kHermite, MotionModel::kSpin}) {
    for (const int with : {0, 1, 2}) {  // none, only the first, only the second
      const Segment segment = makeSegment(model, poseAt(0, 0.0, with == 1), poseAt(kStep, 3.0, with == 2));
      EXPECT_EQ(segment.doubt, impact::Reason::kAlias);
      EXPECT_NEAR(segment.motion.c[1].x(), 30.0, 1e-12) << "a straight line";
      EXPECT_EQ(segment.motion.omega.norm(), 0.0);
    }
  }
  // Wrong ones are believed.
  const Segment hermite =
      makeSegment(MotionModel::kHermite, poseAt(0, 0.0, true), poseAt(kStep / 10, 3.0, true));
  EXPECT_EQ(hermite.doubt, impact::Reason::kNone);
  EXPECT_EQ(hermite.motion.c[1].x(), 10.0);
}

TEST(Segment, twistsThatDisagreeByMoreThanAQuarterTurnLeaveSpinInDoubt) {
  const auto doubt = [](double from, double to) {
    motion::StampedPose a = poseAt(0, 0.0, true), b = poseAt(kStep, 0.0, true);
    a.angular.z() = from;
    b.angular.z() = to;
    return makeSegment(MotionModel::kSpin, a, b).doubt;
  };
  EXPECT_EQ(doubt(62.8, 62.8), impact::Reason::kNone);
  EXPECT_EQ(doubt(62.8 - 7.0, 62.8 + 7.0), impact::Reason::kNone);
  EXPECT_EQ(doubt(62.8 - 8.5, 62.8 + 8.5), impact::Reason::kAlias);
}

}  // namespace
}  // namespace collision_node::scene

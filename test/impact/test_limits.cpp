// What the motion model cannot see, pinned: docs/limits.md shows a picture of each. A limit that is lifted
// turns a test red, and its picture comes off the page.
#include <gmpxx.h>

#include <array>

#include "collision_node/motion/rigid_motion.h"
#include "test/impact/nasty.h"

namespace nasty {
namespace {

/// A ball on a circle of 10 m about the origin, 100 m/s, two poses a tenth of a second apart: one radian. The
/// arc is 1.22 m off its chord in the middle.
struct Arc {
  static constexpr double kRadius = 10.0, kSpeed = 100.0;
  static motion::StampedPose at(double angle, Nanoseconds stamp) {
    motion::StampedPose pose;
    pose.stamp_ns = stamp;
    pose.pose.position = kRadius * Vec3(std::sin(angle), std::cos(angle), 0);
    pose.has_twist = true;
    pose.linear = kSpeed * Vec3(std::cos(angle), -std::sin(angle), 0);
    return pose;
  }
  const motion::StampedPose from = at(-0.5, 0), to = at(0.5, kSecond / 10);
};

TEST(Limits, limit_BetweenTwoPosesAnArcIsItsChord) {
  const Arc arc;
  const Vec3 top(0, Arc::kRadius, 0), on_chord(0, Arc::kRadius * std::cos(0.5), 0);
  struct {
    bool cubic;
    Vec3 post;
    const char* story;
  } const cases[] = {
      {false, top, ""},  // the true ball hits this post; the chord passes 1.22 m below it
      {false, on_chord, "IMPACT CONFIRMED, SEPARATION CONFIRMED"},  // and this one it never met
      {true, top, "IMPACT CONFIRMED, SEPARATION CONFIRMED"},        // twists tell of the bend
      {true, on_chord, ""}};
  for (const auto& c : cases) {
    Watched pair({sphere(0.3, c.post)}, {sphere(0.1)});
    pair.advance(0, kSecond / 10, resting(),
                 c.cubic ? motion::hermite(arc.from, arc.to) : motion::straightSlerp(arc.from, arc.to));
    EXPECT_EQ(pair.story(), c.story) << (c.cubic ? "hermite " : "slerp ") << c.post.transpose()
                                     << pair.list();
  }
}

TEST(Limits, limit_AWholeTurnBetweenTwoPosesIsNoTurn) {
  // A bar of 2 m that turns once about z in a tenth of a second, and a post beside it that its ends sweep
  // over.
  motion::StampedPose from, to;
  to.stamp_ns = kSecond / 10;
  from.has_twist = to.has_twist = true;
  from.angular = to.angular = Vec3(0, 0, 20 * kPi);
  Watched unseen({box(2, 0.1, 0.1)}, {sphere(0.1, {0, 0.8, 0})});
  unseen.advance(0, kSecond / 10, motion::straightSlerp(from, to), resting());
  EXPECT_EQ(unseen.story(), "") << unseen.list();
  Watched seen({box(2, 0.1, 0.1)}, {sphere(0.1, {0, 0.8, 0})});
  seen.advance(0, kSecond / 10, motion::spin(from, to), resting());
  EXPECT_EQ(seen.count(Kind::kImpact), 2) << "both ends pass\n" << seen.list();
}

TEST(Limits, limit_ABodyThatTurnsBackBetweenTwoPosesStoodStill) {
  // Out by a metre and back within a frame: both poses are the same, and so is everything between them.
  motion::StampedPose from, to;
  to.stamp_ns = kFrame;
  Watched pair({sphere(0.1, {0.5, 0, 0})}, {sphere(0.1)});
  pair.advance(0, kFrame, resting(), motion::straightSlerp(from, to));
  EXPECT_EQ(pair.story(), "") << pair.list();
}

TEST(Limits, limit_AtHalfATurnRoundingMayPickEitherWay) {
  // The exact step has a w of some 1e-17 then, of either sign, and the rounded one another.
  moving::Random random(20261127, 0);
  int other = 0;
  for (int i = 0; i < 2000; ++i) {
    motion::StampedPose from, to;
    to.stamp_ns = kSecond;
    const Quat half_turn(Eigen::AngleAxisd(M_PI, Vec3::UnitZ()));
    from.pose.orientation = random.orientation();
    to.pose.orientation = (half_turn * from.pose.orientation).normalized();
    const auto exact = [](const Quat& q) { return std::array<mpq_class, 4>{q.x(), q.y(), q.z(), q.w()}; };
    const auto p = exact(from.pose.orientation), q = exact(to.pose.orientation);
    const mpq_class w = p[0] * q[0] + p[1] * q[1] + p[2] * q[2] + p[3] * q[3],
                    z = p[3] * q[2] - p[2] * q[3] + p[0] * q[1] - p[1] * q[0];  // of to conj(from)
    const double turned = motion::straightSlerp(from, to).omega.z();
    EXPECT_NEAR(std::abs(turned), M_PI, 1e-14);
    other += sgn(w) != 0 && (turned > 0) != (sgn(w) * sgn(z) > 0);
  }
  EXPECT_GT(other, 0);
  EXPECT_LT(other, 500);
}

TEST(Limits, limit_AWheelThatRollsCostsWithTheRootOfOneOverItsDepth) {
  constexpr double kRadius = 0.3, kSpeed = 30;
  moving::PlacedShape wheel = moving::placed(collision_node::geometry::Cylinder{kRadius, 0.2});
  wheel.origin.orientation = Quat(Eigen::AngleAxisd(M_PI_2, Vec3::UnitX()));
  double before = 0;
  for (const double depth : {1e-5, 1e-7, 1e-9}) {
    moving::Watched pair({moving::placed(collision_node::geometry::Box{{4, 4, 1}}, {0, 0, -0.5})}, {wheel});
    const auto rolls = flight(0, kFrame, {0, 0, kRadius - depth}, {kSpeed, 0, 0}, {0, kSpeed / kRadius, 0});
    const auto tests = static_cast<double>(pair.advance(0, kFrame, resting(), rolls).node_tests);
    EXPECT_EQ(pair.story(), "INITIAL_OVERLAP CONFIRMED") << pair.list();
    if (before > 0) {
      EXPECT_NEAR(tests / before, 10, 5) << depth;
    }
    before = tests;
  }
  EXPECT_NEAR(before, 2e5, 1e5);
}

TEST(Limits, limit_WhatIsDeepInsideIsNotProvedWhileAnotherPartIsFlush) {
  const moving::PlacedShape ground = moving::boxMesh({5, 5, 1}, {0, 0, -1}),
                            plate = moving::placed(collision_node::geometry::Box{{1, 1, 0.2}}, {0, 0, 0.1}),
                            anchor = moving::placed(collision_node::geometry::Sphere{0.1}, {0, 0, -1});
  for (const bool flush : {true, false}) {
    moving::Watched pair({ground}, flush ? moving::Shapes{plate, anchor} : moving::Shapes{anchor});
    pair.advance(0, moving::kFrame, moving::resting(), moving::resting({0.3, 0.2, 0}));
    pair.finish();
    EXPECT_EQ(pair.story(), flush ? "INITIAL_OVERLAP POSSIBLE" : "INITIAL_OVERLAP CONFIRMED") << pair.list();
  }
}

}  // namespace
}  // namespace nasty

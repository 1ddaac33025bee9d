/// Nasty cases of tracks and stamps, with the real solver behind the engine; a case keeps its number from the
/// list of known traps (C13 and C33 also have tests in test_engine.cpp, the others in
/// test/impact/test_nasty_*.cpp).
#include <gtest/gtest.h>

#include <cmath>

#include "test/scene/engine_fixture.h"

namespace collision_node::scene {
namespace {

using Kinds = std::vector<std::string>;

/// A ball of radius 0.5 m against a ball of the same radius that is fixed at x = 10: they touch at x = 9.
struct Balls : Rig {
  Balls() : Rig(sceneOf({movingSphere("ball"), fixedSphere("wall", 10.0)}), impact::MethodName::kCertified) {}
};

TEST(EngineNasty, C31_AHitExactlyAtTheMiddleOfThreePosesIsOneEventWithTheIncomingVelocity) {
  // It arrives at x = 9 at 1 m/s, at the second stamp; then it goes on at 0.5 m/s, bounces back at 2 m/s, or
  // rests.
  for (const double after : {0.5, -2.0, 0.0}) {
    Balls rig;
    rig.engine.addPose(0, poseAt(0, 8.5));
    rig.engine.addPose(0, poseAt(500, 9.0));
    rig.engine.addPose(0, poseAt(1000, 9.0 + 0.5 * after));
    rig.engine.flush();
    ASSERT_EQ(rig.events.size(), 1u) << "then at " << after << " m/s";
    const Event& e = rig.events[0];
    EXPECT_EQ(e.kind, impact::Kind::kImpact);
    const double start = motion::secondsBetween(0, e.interval_start_ns);
    EXPECT_LE(start + e.toi_lower, 0.5);
    EXPECT_GE(start + e.toi_upper, 0.5 - 1e-16);
    EXPECT_EQ(e.certificate, after > 0 ? impact::Certificate::kConfirmed : impact::Certificate::kPossible);
    EXPECT_EQ(e.interval_end_ns, 500 * kMs) << "the piece that holds toi_lower";
    EXPECT_NEAR(e.relative_velocity.x(), -1.0, 1e-9) << "of the wall against the incoming ball";
    EXPECT_NEAR(e.closing_speed, 1.0, 1e-9);
  }
}

TEST(EngineNasty, C32_RepeatedStampsAndStampsOneNanosecondApartLoseNoJump) {
  // 2000 m/s: 2 micrometres from one stamp to the next, the touching place between them; and a stamp told
  // twice.
  Balls rig;
  const auto at = [](Nanoseconds stamp_ns, double x) {
    motion::StampedPose pose = poseAt(0, x);
    pose.stamp_ns = stamp_ns;
    return pose;
  };
  rig.engine.addPose(0, at(1000, 9.0 - 3e-6));
  rig.engine.addPose(0, at(1001, 9.0 - 1e-6));
  rig.engine.addPose(0, at(1001, 8.0));  // the first arrival wins
  rig.engine.addPose(0, at(1002, 9.0 + 1e-6));
  rig.engine.addPose(0, at(1003, 9.0 + 1e-6));
  rig.engine.flush();
  EXPECT_EQ(rig.engine.stats().duplicate, 1u);
  ASSERT_EQ(rig.events.size(), 1u);
  const Event& e = rig.events[0];
  EXPECT_EQ(e.kind, impact::Kind::kImpact);
  EXPECT_EQ(e.certificate, impact::Certificate::kConfirmed);
  EXPECT_EQ(e.interval_start_ns, 1001);
  EXPECT_LE(e.toi_lower, 0.5e-9 * (1 + 1e-6));
  EXPECT_GE(e.toi_upper, 0.5e-9 * (1 - 1e-6));
}

TEST(EngineNasty, C33_PosesThatAreNoneAreRefusedAndAlmostUnitQuaternionsAreMadeUnit) {
  const double nan = std::nan(""), infinite = std::numeric_limits<double>::infinity(), denormal = 5e-324;
  Balls rig;
  rig.engine.addPose(0, poseAt(0, 8.0));
  int refused = 0;
  for (const double bad : {nan, infinite, -infinite}) {
    for (int part = 0; part < 2; ++part) {
      motion::StampedPose pose = poseAt(100, 8.2);
      (part == 0 ? pose.pose.position.y() : pose.pose.orientation.x()) = bad;
      rig.engine.addPose(0, pose);
      ++refused;
    }
  }
  for (const double length : {0.0, denormal, 2.0}) {
    motion::StampedPose pose = poseAt(100, 8.2);
    pose.pose.orientation.coeffs() *= length;
    rig.engine.addPose(0, pose);
    ++refused;
  }
  EXPECT_EQ(rig.engine.stats().rejected, static_cast<std::uint64_t>(refused));
  // These are good: lengths that rounding may leave, places as small as numbers get.
  for (int i = 1; i <= 5; ++i) {
    motion::StampedPose pose = poseAt(200 * i, 8.0 + 0.4 * i);
    pose.pose.orientation.coeffs() *= i % 2 ? 1 + 1e-6 : 1 - 1e-6;
    pose.pose.position.z() = denormal;
    rig.engine.addPose(0, pose);
  }
  rig.engine.flush();
  EXPECT_EQ(rig.engine.stats().rejected, static_cast<std::uint64_t>(refused));
  ASSERT_EQ(kinds(rig.events), Kinds{"IMPACT/CONFIRMED/NONE"}) << "never a silent clear";
  EXPECT_NEAR(1e-9 * static_cast<double>(rig.events[0].interval_start_ns) + rig.events[0].toi_lower, 0.5,
              1e-9);
}

/// A tank of two plates side by side and a hammer that is flat in front: both links are met at once, but for
/// `off`.
std::shared_ptr<Scene> twoLinks(double off) {
  Object tank = fixedSphere("tank", 0.0);
  tank.links.clear();
  for (int i = 0; i < 2; ++i) {
    Link link;
    link.name = i == 0 ? "hull" : "turret";
    link.shapes = {{geometry::Box{{1.0, 1.0, 1.0}},
                    {Vec3(10.0 + off * i, i == 0 ? -0.75 : 0.75, 0.0), geometry::Quat::Identity()},
                    "box"}};
    link.body = std::make_shared<geometry::Body>(link.shapes);
    tank.links.push_back(link);
  }
  Object hammer = movingSphere("hammer");
  hammer.links[0].shapes = {{geometry::Box{{1.0, 4.0, 1.0}}, {}, "box"}};
  hammer.links[0].body = std::make_shared<geometry::Body>(hammer.links[0].shapes);
  auto scene = sceneOf({hammer, tank});
  scene->pairs = {{0, 0, 1, 0, 0.0}, {0, 0, 1, 1, 0.0}};
  return scene;
}

TEST(EngineNasty, C37_TwoLinksHitWithinAPicosecondAreTwoEventsWithTheSameIdsOnEveryRun) {
  // At 20 m/s, 1e-11 m are half a picosecond.
  for (const double off : {0.0, 1e-11, -1e-11}) {
    std::vector<std::string> first;
    for (int run = 0; run < 2; ++run) {
      Rig rig(twoLinks(off), impact::MethodName::kCertified);
      rig.feedLine(0, 0, 500, 100, 0.0, 20.0);
      rig.engine.flush();
      ASSERT_EQ(rig.events.size(), 2u) << off;
      for (std::size_t i = 0; i < 2; ++i) {
        const Event& e = rig.events[i];
        EXPECT_EQ(e.kind, impact::Kind::kImpact);
        EXPECT_EQ(e.certificate, impact::Certificate::kConfirmed);
        EXPECT_EQ(e.event_id, i);
        EXPECT_EQ(e.contact_id, i);
        const double at = motion::secondsBetween(0, e.interval_start_ns);
        const double truth = (9.0 + (e.b.link == "turret" ? off : 0.0)) / 20.0;
        EXPECT_LE(at + e.toi_lower, truth + 1e-15);
        EXPECT_GE(at + e.toi_upper, truth - 1e-15);
      }
      EXPECT_NE(rig.events[0].b.link, rig.events[1].b.link);
      if (off == 0.0) {
        EXPECT_EQ(rig.events[0].b.link, "hull") << "equal instants are ordered by names";
      }
      if (run == 0) first = texts(rig.events);
      EXPECT_EQ(texts(rig.events), first);
    }
  }
}

}  // namespace
}  // namespace collision_node::scene

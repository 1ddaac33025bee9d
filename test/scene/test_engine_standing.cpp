// Pairs that cannot move against each other, and objects that turn out to stand.
#include <gtest/gtest.h>

#include "test/scene/engine_fixture.h"

namespace collision_node::scene {
namespace {

using Kinds = std::vector<std::string>;

TEST(EngineStanding, TwoFixedObjectsAreTestedOncePerEpoch) {
  int advances = 0;
  auto scene = sceneOf({movingSphere("ball"), fixedSphere("slab", 9.6), fixedSphere("wall", 10.0)});
  scene->pairs = {{0, 0, 2, 0, 0.0}, {1, 0, 2, 0, 0.0}};
  const auto counting = [&](const geometry::Body&, const geometry::Body&, const impact::PairOptions&) {
    return std::make_unique<LineMethod>(&advances);
  };
  Rig rig(scene, counting, {});  // the ball is too far to be asked for
  rig.feedLine(0, 1000, 4000, 100, 0.0, 0.0);
  EXPECT_EQ(advances, 1);
  ASSERT_EQ(kinds(rig.events), Kinds{"INITIAL_OVERLAP/CONFIRMED/NONE"});
  EXPECT_EQ(rig.events[0].stamp_ns, 1000 * kMs);
  rig.engine.reset();
  EXPECT_EQ(rig.events.back().reason, impact::Reason::kReset);
  EXPECT_EQ(rig.events.back().stamp_ns, 4000 * kMs);
  rig.feedLine(0, 5000, 6000, 100, 0.0, 0.0);
  EXPECT_EQ(rig.events.size(), 3u);
}

TEST(EngineStanding, TwoFixedObjectsAreTestedThoughNoPoseEverComes) {
  Rig rig(sceneOf({fixedSphere("slab", 9.6), fixedSphere("wall", 10.0)}));
  rig.engine.flush();
  ASSERT_EQ(kinds(rig.events), Kinds{"INITIAL_OVERLAP/CONFIRMED/NONE"});
  EXPECT_EQ(rig.events[0].stamp_ns, 0);
  ASSERT_EQ(rig.beats.size(), 1u);
  EXPECT_EQ(rig.beats[0].pairs_impact, 1u);
  rig.engine.flush();
  EXPECT_EQ(rig.events.size(), 1u);
  EXPECT_EQ(rig.beats.size(), 1u);
  rig.engine.reset();
  EXPECT_EQ(kinds(rig.events), (Kinds{"INITIAL_OVERLAP/CONFIRMED/NONE", "SEPARATION/UNCERTIFIED/RESET"}));
}

/// Two links 0.4 m apart on one body: they overlap wherever it goes.
Object movingTwin(double distance) {
  Object twin = movingSphere("twin");
  Link other = twin.links[0];
  other.name = "other";
  other.T_o_l.position.x() = distance;
  other.shapes[0].origin.position.x() = distance;
  other.body = std::make_shared<geometry::Body>(other.shapes);
  twin.links.push_back(other);
  return twin;
}

TEST(EngineStanding, LinksOfOneObjectAreTestedOncePerEpoch) {
  for (const double distance : {0.4, 3.0}) {
    SCOPED_TRACE(distance);
    auto scene = sceneOf({movingTwin(distance), fixedSphere("wall", 100.0)});
    scene->pairs = {{0, 0, 0, 1, 0.0}, {0, 0, 1, 0, 0.0}};
    Rig rig(scene, impact::MethodName::kCertified);
    rig.feedLine(0, 1000, 30000, 100, 5.0, 1.0);  // long enough for samples to be forgotten
    rig.engine.flush();
    const bool touch = distance < 1.0;
    ASSERT_EQ(kinds(rig.events), touch ? Kinds{"INITIAL_OVERLAP/CONFIRMED/NONE"} : Kinds{});
    EXPECT_EQ(rig.beats.back().pairs_clear + rig.beats.back().pairs_culled, touch ? 1u : 2u);
    EXPECT_EQ(rig.beats.back().pairs_impact, touch ? 1u : 0u);
    if (!touch) continue;
    EXPECT_EQ(rig.events[0].stamp_ns, 1000 * kMs);
    EXPECT_EQ(rig.events[0].a.link, "body");
    EXPECT_EQ(rig.events[0].b.link, "other");
    EXPECT_EQ(rig.events[0].a.pose.position.x(), 6.0);
    rig.engine.reset();
    ASSERT_EQ(rig.events.size(), 2u);
    EXPECT_EQ(rig.events[1].reason, impact::Reason::kReset);
    EXPECT_EQ(rig.events[1].stamp_ns, 30000 * kMs);
    EXPECT_EQ(rig.events[1].a.pose.position.x(), 35.0);
  }
}

TEST(EngineStanding, LinksOfOneObjectAreTestedAtItsFirstPoseHoweverLateTheTestComes) {
  auto scene = sceneOf({movingSphere("absent"), movingTwin(0.4)});
  scene->pairs = {{0, 0, 1, 0, 0.0}, {1, 0, 1, 1, 0.0}};
  Rig rig(scene, impact::MethodName::kCertified);
  rig.feedLine(1, 1000, 4000, 5, 5.0, 1.0);  // some 300 poses while the other one is waited for
  ASSERT_EQ(kinds(rig.events), Kinds{"INITIAL_OVERLAP/CONFIRMED/NONE"});
  EXPECT_EQ(rig.events[0].stamp_ns, 1000 * kMs);
}

TEST(EngineStanding, anObjectThatTurnsOutToBeFixedIsOneFromTheStart) {
  auto scene = sceneOf({movingSphere("ball"), movingSphere("wall")});
  Rig rig(scene);
  rig.feedLine(0, 0, 500, 50, -2.0, 10.0);
  EXPECT_FALSE(rig.engine.stats().has_watermark) << "the wall is waited for";
  Pose pose;
  pose.position.x() = 1.0;
  rig.engine.fix(1, pose);
  rig.feedLine(0, 550, 1000, 50, -2.0, 10.0);
  rig.engine.flush();
  EXPECT_EQ(kinds(rig.events),
            (std::vector<std::string>{"IMPACT/CONFIRMED/NONE", "SEPARATION/CONFIRMED/NONE"}));
  EXPECT_EQ(rig.engine.stats().pairs_uncovered, 0u);
  rig.engine.fix(0, pose);  // it has sent poses: left as it is
  rig.feedLine(0, 1050, 1100, 50, -2.0, 10.0);
  EXPECT_EQ(rig.engine.stats().accepted, 23u);
}

TEST(EngineStanding, anObjectThatIsFixedLateSaysNothingOfWhatIsDecided) {
  auto scene = sceneOf({movingSphere("ball"), movingSphere("other"), movingSphere("wall")});
  Rig rig(scene);
  for (int t = 0; t <= 5000; t += 50) {  // through the wall's place at 0.3 s; the wall is given up at 1.6 s
    rig.engine.addPose(0, poseAt(t, -2.0 + 0.01 * t));
    rig.engine.addPose(1, poseAt(t, 100.0));
  }
  const auto decided = rig.engine.stats().watermark_ns;
  Pose pose;
  pose.position.x() = 1.0;
  rig.engine.fix(2, pose);
  rig.engine.flush();
  EXPECT_TRUE(rig.events.empty());
  EXPECT_GT(decided, 4000 * kMs);
  EXPECT_EQ(rig.engine.stats().pairs_uncovered, 0u);
}

TEST(EngineStanding, twoObjectsThatTurnOutToBeFixedAreTestedOnce) {
  auto scene = sceneOf({movingSphere("ball"), fixedSphere("floor", 0.5), movingSphere("wall")});
  Rig rig(scene);
  rig.engine.fix(2, Pose());
  rig.feedLine(0, 0, 500, 50, 50.0, 1.0);
  rig.engine.flush();
  EXPECT_EQ(kinds(rig.events), (std::vector<std::string>{"INITIAL_OVERLAP/CONFIRMED/NONE"}));
}

}  // namespace
}  // namespace collision_node::scene

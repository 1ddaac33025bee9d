// What breaks a stream, and what is said of it: holes, silence, and time that goes back.
#include <gtest/gtest.h>

#include "test/scene/engine_fixture.h"

namespace collision_node::scene {
namespace {

using Kinds = std::vector<std::string>;

TEST(EngineBreaks, NothingIsSweptThroughAGap) {
  Rig rig(sceneOf({movingSphere("ball"), fixedSphere("wall", 10.0)}));
  rig.feedLine(0, 0, 400, 100, 0.0, 20.0);      // up to 8 m
  rig.feedLine(0, 2000, 2400, 100, 20.0, 0.0);  // passed unseen
  rig.engine.flush();
  EXPECT_TRUE(rig.events.empty());
}

// README: "two poses are at most `max_gap` apart"
TEST(EngineBreaks, AGapEndsAnOpenContact) {
  Rig rig(sceneOf({movingSphere("ball"), fixedSphere("wall", 10.0)}));
  rig.feedLine(0, 0, 500, 100, 0.0, 20.0);
  rig.feedLine(0, 2000, 2400, 100, 10.0, 0.0);
  rig.engine.flush();
  ASSERT_EQ(kinds(rig.events),
            (Kinds{"IMPACT/CONFIRMED/NONE", "SEPARATION/UNCERTIFIED/GAP", "INITIAL_OVERLAP/CONFIRMED/NONE"}));
  EXPECT_EQ(rig.events[1].stamp_ns, 500 * kMs);
  EXPECT_EQ(rig.events[1].contact_id, 0u);
  EXPECT_EQ(rig.events[2].stamp_ns, 2000 * kMs);
  EXPECT_EQ(rig.events[2].contact_id, 1u);
}

// README: "no stream is silent, or behind the others, for longer than `timeout` of data time (a bag played
// ten times as fast has a tenth of it in wall time)"
TEST(EngineBreaks, ASilentObjectIsDroppedAndItsContactEnds) {
  Rig rig(sceneOf({movingSphere("ball"), movingSphere("clock"), fixedSphere("wall", 10.0)}));
  rig.feedLine(1, 0, 300, 100, 100.0, 0.0);
  rig.feedLine(0, 0, 500, 100, 0.0, 20.0);
  rig.feedLine(1, 400, 3000, 100, 100.0, 0.0);
  ASSERT_EQ(kinds(rig.events), (Kinds{"IMPACT/CONFIRMED/NONE", "SEPARATION/UNCERTIFIED/TIMEOUT"}));
  const Stats stats = rig.engine.stats();
  EXPECT_EQ(stats.uncovered_objects, std::vector<std::string>{"ball"});
  EXPECT_EQ(stats.pairs_uncovered, 2u);
  EXPECT_EQ(stats.pairs_clear + stats.pairs_impact + stats.pairs_culled + stats.pairs_undecided, 1u);
}

TEST(EngineBreaks, AFrozenObjectIsMetWhereItStoppedButNotCertified) {
  Object sleeper = movingSphere("sleeper");
  sleeper.on_timeout = OnTimeout::kFreeze;
  Rig rig(sceneOf({movingSphere("ball"), sleeper}));
  rig.feedLine(1, 0, 200, 100, 60.0, 0.0);
  rig.feedLine(0, 0, 5000, 100, 0.0, 20.0);  // meets 59 m at 2.95 s
  EXPECT_EQ(kinds(rig.events), (Kinds{"IMPACT/UNCERTIFIED/TIMEOUT", "SEPARATION/UNCERTIFIED/TIMEOUT"}));
  EXPECT_EQ(rig.events[0].b.sample_before_ns, 200 * kMs);
  EXPECT_TRUE(rig.engine.stats().uncovered_objects.empty());
}

/// A sleeper (object 1) froze at 17 m after 0.2 s. A slow ball (2), a pose a second, meets it at 3.2 s,
/// between two of its stamps. A clock (0) stands at 3.6 s, and the watermark at the slow one's last stamp
/// before that.
struct BesideASleeper {
  static std::shared_ptr<Scene> scene() {
    Object sleeper = movingSphere("sleeper");
    sleeper.on_timeout = OnTimeout::kFreeze;
    const auto scene = sceneOf({movingSphere("clock"), sleeper, movingSphere("slow")});
    scene->stats_period = 100.0;  // a heartbeat would solve what waits
    return scene;
  }
  Rig rig{scene()};

  BesideASleeper() {
    rig.feedLine(1, 0, 200, 100, 17.0, 0.0);
    for (Nanoseconds t = 0; t <= 5000; t += 100) {
      if (t % 1000 == 0) rig.engine.addPose(2, poseAt(t, 0.005 * static_cast<double>(t)));
      if (t >= 1400) rig.engine.addPose(0, poseAt(t - 1400, 100.0));
    }
    EXPECT_TRUE(rig.events.empty());
    EXPECT_EQ(rig.engine.stats().watermark_ns, 3000 * kMs);
  }
};

// engine.h: "everything before it is decided and published"
TEST(EngineBreaks, TheWatermarkWaitsForWhatMovesBesideAFrozenObject) {
  BesideASleeper beside;
  Rig& rig = beside.rig;
  rig.feedLine(0, 3700, 5000, 100, 100.0, 0.0);
  EXPECT_EQ(rig.engine.stats().watermark_ns, 4000 * kMs);
  ASSERT_EQ(kinds(rig.events), (Kinds{"IMPACT/UNCERTIFIED/TIMEOUT", "SEPARATION/UNCERTIFIED/TIMEOUT"}));
  EXPECT_EQ(rig.events[0].stamp_ns, 3200 * kMs);
}

// engine.h: "Every event of earlier epochs, and of `epoch` up to and including `stamp_ns`, has been
// published."
TEST(EngineBreaks, AFrozenObjectThatComesBackDecidesNothing) {
  BesideASleeper beside;
  Rig& rig = beside.rig;
  // Whether it waits or is released, the contact at 3.2 s is not published.
  for (const Nanoseconds t : {5000, 5200}) {
    rig.engine.addPose(1, poseAt(t, 17.0));
    EXPECT_TRUE(rig.events.empty());
    EXPECT_EQ(rig.engine.stats().watermark_ns, 3000 * kMs) << t;
    EXPECT_FALSE(rig.engine.hasPublished(0, 3300 * kMs)) << t;
  }
  rig.feedLine(0, 3700, 5000, 100, 100.0, 0.0);
  EXPECT_EQ(rig.events.size(), 2u);
  EXPECT_TRUE(rig.engine.hasPublished(0, 3300 * kMs));
}

TEST(EngineBreaks, AnObjectThatNeverComesIsNamed) {
  Rig rig(sceneOf({movingSphere("absent"), movingSphere("ball"), fixedSphere("wall", 10.0)}));
  rig.feedLine(1, 0, 1600, 100, 0.0, 20.0);
  EXPECT_TRUE(rig.events.empty());
  rig.feedLine(1, 1700, 2000, 100, 0.0, 20.0);
  EXPECT_EQ(rig.events.size(), 2u);
  EXPECT_EQ(rig.engine.stats().uncovered_objects, std::vector<std::string>{"absent"});
  EXPECT_EQ(rig.engine.stats().pairs_uncovered, 2u);
}

// README: "stamps go forward"
TEST(EngineBreaks, ALoopGivesTheSameEventsInANewEpoch) {
  Rig rig(sceneOf({movingSphere("ball"), movingSphere("other"), fixedSphere("wall", 10.0)}));
  for (int round = 0; round < 3; ++round)
    for (Nanoseconds t = 5000; t <= 7000; t += 100) {
      rig.engine.addPose(
          0, poseAt(t, 0.01 * static_cast<double>(t) - 50.0));  // ends inside the wall's sphere… and on
      rig.engine.addPose(1, poseAt(t + 7, 30.0));
    }
  rig.engine.flush();
  std::vector<std::vector<std::string>> rounds(3);
  for (Event event : rig.events) {
    ASSERT_LT(event.epoch, 3u);
    const std::uint32_t epoch = event.epoch;
    event.epoch = 0;
    rounds[epoch].push_back(text(event));
  }
  ASSERT_EQ(rounds[0].size(), 2u);
  EXPECT_EQ(rounds[0], rounds[1]);
  EXPECT_EQ(rounds[0], rounds[2]);
  EXPECT_EQ(rig.engine.stats().late, 0u);
}

TEST(EngineBreaks, GoingBackInTimeEndsAnOpenContact) {
  Rig rig(sceneOf({movingSphere("ball"), fixedSphere("wall", 10.0)}));
  rig.feedLine(0, 0, 500, 100, 0.0, 20.0);
  rig.engine.clockWentBack();
  rig.feedLine(0, 0, 500, 100, 0.0, 20.0);
  rig.engine.flush();
  EXPECT_EQ(kinds(rig.events),
            (Kinds{"IMPACT/CONFIRMED/NONE", "SEPARATION/UNCERTIFIED/RESET", "IMPACT/CONFIRMED/NONE"}));
  EXPECT_EQ(rig.events[1].epoch, 0u);
  EXPECT_EQ(rig.events[2].epoch, 1u);
  EXPECT_EQ(rig.events[2].event_id, 0u);
}

TEST(EngineBreaks, ResetForgetsAllAndBeginsAnEpoch) {
  Rig rig(sceneOf({movingSphere("ball"), fixedSphere("wall", 10.0)}));
  rig.feedLine(0, 0, 500, 100, 0.0, 20.0);
  rig.engine.reset();
  EXPECT_EQ(kinds(rig.events), (Kinds{"IMPACT/CONFIRMED/NONE", "SEPARATION/UNCERTIFIED/RESET"}));
  rig.feedLine(0, 600, 1000, 100, 0.0, 20.0);  // from 12 m: no segment joins it to 10 m
  rig.engine.flush();
  EXPECT_EQ(rig.events.size(), 2u);
  EXPECT_EQ(rig.engine.stats().epoch, 1u);
}

TEST(EngineBreaks, nothingIsSweptWhereTheSourceKnowsNothingOfTheWay) {
  auto scene = sceneOf({movingSphere("ball"), fixedSphere("wall", 0.0)});
  Rig rig(scene);
  rig.engine.addPose(0, poseAt(0, -5.0));
  auto after = poseAt(100, 5.0);
  after.begins_anew = true;
  rig.engine.addPose(0, after);
  rig.engine.addPose(0, poseAt(200, 5.0));
  rig.engine.flush();
  EXPECT_TRUE(rig.events.empty());
  EXPECT_EQ(rig.engine.stats().holes, 1u);
}

}  // namespace
}  // namespace collision_node::scene

// Poses in, events out: order, numbers, breaks and certificates. The pairs are solved by a stand-in in closed
// form.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <stdexcept>

#include "engine_fixture.h"

namespace collision_node::scene {
namespace {

using Kinds = std::vector<std::string>;

TEST(Engine, AnImpactAndItsSeparationShareAContact) {
  Rig rig(sceneOf({movingSphere("ball"), fixedSphere("wall", 10.0)}));
  rig.feedLine(0, 0, 1000, 100, 0.0, 20.0);  // meets at 9 m (0.45 s), leaves at 11 m (0.55 s)
  rig.engine.flush();
  ASSERT_EQ(kinds(rig.events), (Kinds{"IMPACT/CONFIRMED/NONE", "SEPARATION/CONFIRMED/NONE"}));
  const Event& hit = rig.events[0];
  EXPECT_EQ(hit.event_id, 0u);
  EXPECT_EQ(hit.contact_id, 0u);
  EXPECT_EQ(rig.events[1].event_id, 1u);
  EXPECT_EQ(rig.events[1].contact_id, 0u);
  EXPECT_EQ(hit.interval_start_ns, 400 * kMs);
  EXPECT_EQ(hit.interval_end_ns, 500 * kMs);
  EXPECT_NEAR(hit.toi_lower, 0.05, 1e-12);
  EXPECT_NEAR(static_cast<double>(hit.stamp_ns), 450e6, 1.0);
  EXPECT_EQ(hit.a.object, "ball");
  EXPECT_EQ(hit.b.object, "wall");
  EXPECT_EQ(hit.a.sample_before_ns, 400 * kMs);
  EXPECT_TRUE(std::isnan(hit.model_toi_lower));
  EXPECT_LT((hit.a.pose.position - Vec3(9, 0, 0)).norm(), 1e-9);
}

TEST(Engine, AnImpactInTheLastSegmentIsReported) {
  Rig rig(sceneOf({movingSphere("ball"), fixedSphere("wall", 10.0)}));
  rig.feedLine(0, 0, 500, 100, 0.0, 20.0);
  EXPECT_TRUE(rig.events.empty());  // the last stamp is not released before the end
  rig.engine.flush();
  EXPECT_EQ(kinds(rig.events), Kinds{"IMPACT/CONFIRMED/NONE"});  // still touching: no event
}

TEST(Engine, NothingIsPublishedBeforeTheWatermarkPassesIt) {
  Rig rig(sceneOf({movingSphere("a"), movingSphere("b"), fixedSphere("wall", 10.0)}));
  rig.feedLine(0, 0, 1000, 100, 0.0, 20.0);  // hits the wall at 0.45 s
  rig.feedLine(1, 0, 500, 100, 100.0, 0.0);
  EXPECT_TRUE(rig.events.empty());  // b is known up to 0.4 s
  rig.feedLine(1, 600, 600, 100, 100.0, 0.0);
  EXPECT_EQ(rig.events.size(), 1u);  // up to 0.5 s
  EXPECT_EQ(rig.engine.stats().watermark_ns, 500 * kMs);
}

TEST(Engine, EventsOfManyPairsComeInOrder) {
  const unsigned seed = 31;
  std::mt19937_64 random(seed);
  std::size_t seen = 0;
  for (int round = 0; round < 50; ++round) {
    SCOPED_TRACE("seed " + std::to_string(seed) + " round " + std::to_string(round));
    std::vector<Object> objects;
    for (int i = 0; i < 5; ++i) objects.push_back(movingSphere("o" + std::to_string(i)));
    Rig rig(sceneOf(objects));
    // Each has its own rate, phase and speed; arrival is by stamp with jitter less than `reorder`.
    std::vector<std::tuple<Nanoseconds, int, motion::StampedPose>> arrivals;
    for (int i = 0; i < 5; ++i) {
      const Nanoseconds step = 20 + static_cast<Nanoseconds>(random() % 80);
      const double v = static_cast<double>(random() % 40) - 20.0, x0 = 8.0 * i;
      for (Nanoseconds t = static_cast<Nanoseconds>(random() % 50); t < 3000; t += step)
        arrivals.emplace_back(t, i, poseAt(t, x0 + v * 1e-3 * static_cast<double>(t)));
    }
    std::stable_sort(arrivals.begin(), arrivals.end(),
                     [](const auto& l, const auto& r) { return std::get<0>(l) < std::get<0>(r); });
    for (const auto& [when, object, pose] : arrivals) rig.engine.addPose(object, pose);
    rig.engine.flush();
    seen += rig.events.size();
    for (std::size_t i = 0; i < rig.events.size(); ++i) {
      EXPECT_EQ(rig.events[i].event_id, i);
      if (i > 0) {
        EXPECT_LE(rig.events[i - 1].stamp_ns, rig.events[i].stamp_ns);
      }
    }

    // The same poses in another order of arrival: the same events.
    Rig other(sceneOf(objects));
    for (auto& arrival : arrivals) std::get<0>(arrival) += static_cast<Nanoseconds>(random() % 100);
    std::stable_sort(arrivals.begin(), arrivals.end(),
                     [](const auto& l, const auto& r) { return std::get<0>(l) < std::get<0>(r); });
    for (const auto& [when, object, pose] : arrivals) other.engine.addPose(object, pose);
    other.engine.flush();
    EXPECT_EQ(other.engine.stats().late, 0u);
    EXPECT_GT(other.engine.stats().reordered, 0u);
    EXPECT_EQ(texts(rig.events), texts(other.events));
  }
  EXPECT_GT(seen, 300u);
}

TEST(Engine, EqualInstantsAreOrderedByNames) {
  // Three balls at rest are met at the same moment.
  std::vector<Object> objects;
  for (const char* name : {"a", "b", "c", "hammer"})
    objects.push_back(name[0] == 'h' ? movingSphere(name) : fixedSphere(name, 10.0));
  auto scene = sceneOf(objects);
  scene->pairs = {{0, 0, 3, 0, 0.0}, {1, 0, 3, 0, 0.0}, {2, 0, 3, 0, 0.0}};
  Rig rig(scene);
  rig.feedLine(3, 0, 1000, 100, 0.0, 20.0);
  rig.engine.flush();
  ASSERT_EQ(rig.events.size(), 6u);
  EXPECT_EQ(rig.events[0].a.object, "a");
  EXPECT_EQ(rig.events[1].a.object, "b");
  EXPECT_EQ(rig.events[2].a.object, "c");
  EXPECT_EQ(rig.events[3].contact_id, 0u);
  EXPECT_EQ(rig.events[4].contact_id, 1u);
}

TEST(Engine, NothingIsSweptThroughAGap) {
  Rig rig(sceneOf({movingSphere("ball"), fixedSphere("wall", 10.0)}));
  rig.feedLine(0, 0, 400, 100, 0.0, 20.0);      // up to 8 m
  rig.feedLine(0, 2000, 2400, 100, 20.0, 0.0);  // passed unseen
  rig.engine.flush();
  EXPECT_TRUE(rig.events.empty());
}

// README: "two poses are at most `max_gap` apart"
TEST(Engine, AGapEndsAnOpenContact) {
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
TEST(Engine, ASilentObjectIsDroppedAndItsContactEnds) {
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

TEST(Engine, AFrozenObjectIsMetWhereItStoppedButNotCertified) {
  Object sleeper = movingSphere("sleeper");
  sleeper.on_timeout = OnTimeout::kFreeze;
  Rig rig(sceneOf({movingSphere("ball"), sleeper}));
  rig.feedLine(1, 0, 200, 100, 60.0, 0.0);
  rig.feedLine(0, 0, 5000, 100, 0.0, 20.0);  // meets 59 m at 2.95 s
  EXPECT_EQ(kinds(rig.events), (Kinds{"IMPACT/UNCERTIFIED/TIMEOUT", "SEPARATION/UNCERTIFIED/TIMEOUT"}));
  EXPECT_EQ(rig.events[0].b.sample_before_ns, 200 * kMs);
  EXPECT_TRUE(rig.engine.stats().uncovered_objects.empty());
}

// engine.h: "everything before it is decided and published"
TEST(Engine, TheWatermarkWaitsForWhatMovesBesideAFrozenObject) {
  Object sleeper = movingSphere("sleeper");
  sleeper.on_timeout = OnTimeout::kFreeze;
  Rig rig(sceneOf({movingSphere("clock"), sleeper, movingSphere("slow")}));
  rig.feedLine(1, 0, 200, 100, 17.0, 0.0);
  for (Nanoseconds t = 0; t <= 5000; t += 100) {
    // Meets the sleeper at 3.2 s, between two of its stamps.
    if (t % 1000 == 0) rig.engine.addPose(2, poseAt(t, 0.005 * static_cast<double>(t)));
    if (t >= 1400) rig.engine.addPose(0, poseAt(t - 1400, 100.0));
  }
  EXPECT_TRUE(rig.events.empty());
  EXPECT_EQ(rig.engine.stats().watermark_ns, 3000 * kMs);
  rig.feedLine(0, 3700, 5000, 100, 100.0, 0.0);
  EXPECT_EQ(rig.engine.stats().watermark_ns, 4000 * kMs);
  ASSERT_EQ(kinds(rig.events), (Kinds{"IMPACT/UNCERTIFIED/TIMEOUT", "SEPARATION/UNCERTIFIED/TIMEOUT"}));
  EXPECT_EQ(rig.events[0].stamp_ns, 3200 * kMs);
}

// engine.h: "Every event of earlier epochs, and of `epoch` up to and including `stamp_ns`, has been
// published."
TEST(Engine, AFrozenObjectThatComesBackDecidesNothing) {
  Object sleeper = movingSphere("sleeper");
  sleeper.on_timeout = OnTimeout::kFreeze;
  const auto scene = sceneOf({movingSphere("clock"), sleeper, movingSphere("slow")});
  scene->stats_period = 100.0;  // a heartbeat would solve what waits
  Rig rig(scene);
  rig.feedLine(1, 0, 200, 100, 17.0, 0.0);
  for (Nanoseconds t = 0; t <= 5000; t += 100) {
    if (t % 1000 == 0) rig.engine.addPose(2, poseAt(t, 0.005 * static_cast<double>(t)));
    if (t >= 1400) rig.engine.addPose(0, poseAt(t - 1400, 100.0));
  }
  ASSERT_EQ(rig.engine.stats().watermark_ns, 3000 * kMs);
  // Whether it waits or is released, the contact at 3.2 s is not published: the clock stands at 3.5 s.
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

TEST(Engine, AnObjectThatNeverComesIsNamed) {
  Rig rig(sceneOf({movingSphere("absent"), movingSphere("ball"), fixedSphere("wall", 10.0)}));
  rig.feedLine(1, 0, 1600, 100, 0.0, 20.0);
  EXPECT_TRUE(rig.events.empty());
  rig.feedLine(1, 1700, 2000, 100, 0.0, 20.0);
  EXPECT_EQ(rig.events.size(), 2u);
  EXPECT_EQ(rig.engine.stats().uncovered_objects, std::vector<std::string>{"absent"});
  EXPECT_EQ(rig.engine.stats().pairs_uncovered, 2u);
}

// README: "stamps go forward"
TEST(Engine, ALoopGivesTheSameEventsInANewEpoch) {
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

TEST(Engine, GoingBackInTimeEndsAnOpenContact) {
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

TEST(Engine, ResetForgetsAllAndBeginsAnEpoch) {
  Rig rig(sceneOf({movingSphere("ball"), fixedSphere("wall", 10.0)}));
  rig.feedLine(0, 0, 500, 100, 0.0, 20.0);
  rig.engine.reset();
  EXPECT_EQ(kinds(rig.events), (Kinds{"IMPACT/CONFIRMED/NONE", "SEPARATION/UNCERTIFIED/RESET"}));
  rig.feedLine(0, 600, 1000, 100, 0.0, 20.0);  // from 12 m: no segment joins it to 10 m
  rig.engine.flush();
  EXPECT_EQ(rig.events.size(), 2u);
  EXPECT_EQ(rig.engine.stats().epoch, 1u);
}

TEST(Engine, AFlushInTheMiddleMissesNothing) {
  for (Nanoseconds flush_at = 100; flush_at <= 900; flush_at += 100) {
    Rig rig(sceneOf({movingSphere("ball"), fixedSphere("wall", 10.0)}));
    for (Nanoseconds t = 0; t <= 1000; t += 100) {
      rig.engine.addPose(0, poseAt(t, 0.02 * static_cast<double>(t)));
      if (t == flush_at) rig.engine.flush();
    }
    rig.engine.flush();
    EXPECT_EQ(kinds(rig.events), (Kinds{"IMPACT/CONFIRMED/NONE", "SEPARATION/CONFIRMED/NONE"})) << flush_at;
    EXPECT_EQ(rig.events[1].contact_id, 0u);
  }
}

// README: "a stamp is when the object was there"
TEST(Engine, AGuessedStampIsNotCertified) {
  Rig rig(sceneOf({movingSphere("ball"), fixedSphere("wall", 10.0)}));
  for (Nanoseconds t = 0; t <= 1000; t += 100)
    rig.engine.addPose(0, poseAt(t, 0.02 * static_cast<double>(t)), t == 400);
  rig.engine.flush();
  EXPECT_EQ(kinds(rig.events), (Kinds{"IMPACT/UNCERTIFIED/STAMP_GUESSED", "SEPARATION/CONFIRMED/NONE"}));
}

TEST(Engine, C13_ATurnTooFarForSlerpIsNotCertified) {
  Rig rig(sceneOf({movingSphere("ball"), fixedSphere("wall", 10.0)}));
  for (Nanoseconds t = 0; t <= 1000; t += 100) {
    motion::StampedPose pose = poseAt(t, 0.02 * static_cast<double>(t));
    pose.has_twist = true;
    pose.angular = Vec3(0, 0, 40.0);
    rig.engine.addPose(0, pose);
  }
  rig.engine.flush();
  EXPECT_EQ(kinds(rig.events), (Kinds{"IMPACT/UNCERTIFIED/ALIAS", "SEPARATION/UNCERTIFIED/ALIAS"}));
}

TEST(Engine, TwoFixedObjectsAreTestedOncePerEpoch) {
  int advances = 0;
  auto scene = sceneOf({movingSphere("ball"), fixedSphere("slab", 9.6), fixedSphere("wall", 10.0)});
  scene->pairs = {{1, 0, 2, 0, 0.0}};
  Rig rig(scene, &advances);
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

TEST(Engine, TwoFixedObjectsAreTestedThoughNoPoseEverComes) {
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

TEST(Engine, LinksOfOneObjectAreTestedOncePerEpoch) {
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

TEST(Engine, LinksOfOneObjectAreTestedAtItsFirstPoseHoweverLateTheTestComes) {
  auto scene = sceneOf({movingSphere("absent"), movingTwin(0.4)});
  scene->pairs = {{0, 0, 1, 0, 0.0}, {1, 0, 1, 1, 0.0}};
  Rig rig(scene, impact::MethodName::kCertified);
  rig.feedLine(1, 1000, 4000, 5, 5.0, 1.0);  // some 300 poses while the other one is waited for
  ASSERT_EQ(kinds(rig.events), Kinds{"INITIAL_OVERLAP/CONFIRMED/NONE"});
  EXPECT_EQ(rig.events[0].stamp_ns, 1000 * kMs);
}

// README: "poses are finite, their quaternions of length 1, and one topic keeps to one type and one frame"
TEST(Engine, C33_BadPosesAreCountedAndHarmless) {
  Rig rig(sceneOf({movingSphere("ball"), fixedSphere("wall", 10.0)}));
  rig.feedLine(0, 0, 400, 100, 0.0, 20.0);
  motion::StampedPose bad = poseAt(450, 9.0);
  bad.pose.orientation.w() = std::nan("");
  rig.engine.addPose(0, bad);
  rig.feedLine(0, 400, 1000, 100, 0.0, 20.0);  // 400 comes twice
  rig.engine.flush();
  const Stats stats = rig.engine.stats();
  EXPECT_EQ(stats.rejected, 1u);
  EXPECT_EQ(stats.duplicate, 1u);
  EXPECT_EQ(stats.accepted, 11u);
  EXPECT_EQ(rig.events.size(), 2u);
}

TEST(Engine, anObjectThatTurnsOutToBeFixedIsOneFromTheStart) {
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

TEST(Engine, anObjectThatIsFixedLateSaysNothingOfWhatIsDecided) {
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

TEST(Engine, twoObjectsThatTurnOutToBeFixedAreTestedOnce) {
  auto scene = sceneOf({movingSphere("ball"), fixedSphere("floor", 0.5), movingSphere("wall")});
  Rig rig(scene);
  rig.engine.fix(2, Pose());
  rig.feedLine(0, 0, 500, 50, 50.0, 1.0);
  rig.engine.flush();
  EXPECT_EQ(kinds(rig.events), (std::vector<std::string>{"INITIAL_OVERLAP/CONFIRMED/NONE"}));
}

TEST(Engine, nothingIsSweptWhereTheSourceKnowsNothingOfTheWay) {
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

TEST(Engine, aComposedPathWithATwistAgainstItMakesAlias) {
  auto scene = sceneOf({movingSphere("ball"), fixedSphere("wall", 0.0)});
  Rig rig(scene);
  rig.engine.addPose(0, poseAt(0, -5.0));
  auto after = poseAt(100, 5.0);
  after.may_alias = true;
  rig.engine.addPose(0, after);
  rig.engine.flush();
  ASSERT_EQ(rig.events.size(), 2u);
  EXPECT_EQ(rig.events[0].reason, impact::Reason::kAlias);
  EXPECT_EQ(rig.events[0].certificate, impact::Certificate::kUncertified);
}

TEST(Engine, RefusesWhatItCannotDo) {
  auto scene = sceneOf({movingSphere("ball"), fixedSphere("wall", 10.0)});
  Rig rig(scene);
  EXPECT_THROW(rig.engine.addPose(2, poseAt(0, 0)), std::invalid_argument);
  EXPECT_THROW(rig.engine.addPose(-1, poseAt(0, 0)), std::invalid_argument);
  EXPECT_THROW(rig.engine.addPose(1, poseAt(0, 0)), std::invalid_argument);
  scene->time.timeout = 1.05;  // < max_gap + reorder
  EXPECT_THROW(Rig{scene}, std::invalid_argument);
}

}  // namespace
}  // namespace collision_node::scene

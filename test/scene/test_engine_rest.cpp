// Pairs that rest while they are far apart give the answers of pairs that are solved on every piece.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>

#include "test/scene/random_streams.h"
#include "test/scene/same_run.h"

namespace collision_node::scene {
namespace {

constexpr auto kCertified = impact::MethodName::kCertified;

struct Tally {
  std::size_t events = 0, beats = 0;
  std::uint64_t uncovered = 0, undecided = 0, impact = 0, tests = 0, tests_of_all = 0;
};

void compare(unsigned seed, int objects, Tally& tally) {
  SCOPED_TRACE("seed " + std::to_string(seed) + ", " + std::to_string(objects) + " objects");
  RandomScene random(seed, objects);
  const RandomStreams streams(random);
  Rig planned(random.scene, kCertified, {false, 1 + static_cast<int>(seed % 3)});
  Rig all(random.scene, kCertified, {true, 1});
  streams.play(planned);
  streams.play(all);
  EXPECT_EQ(difference(texts(planned.events), texts(all.events)), "");
  EXPECT_EQ(difference(texts(planned.beats), texts(all.beats)), "");
  const std::uint64_t pairs = random.scene->pairs.count(random.scene->objects);
  for (const Stats& beat : planned.beats) {
    EXPECT_EQ(allBins(beat), pairs);
    tally.uncovered += beat.pairs_uncovered;
    tally.undecided += beat.pairs_undecided;
    tally.impact += beat.pairs_impact;
  }
  tally.events += planned.events.size();
  tally.beats += planned.beats.size();
  tally.tests += planned.engine.stats().node_tests;
  tally.tests_of_all += all.engine.stats().node_tests;
}

TEST(EngineRest, RestingPairsChangeNoEventAndNoCountOnRandomScenes) {
  Tally tally;
  const unsigned scenes = std::getenv("COLLISION_NODE_LONG") != nullptr ? 5000 : 150;
  for (unsigned seed = 1; seed <= scenes && !testing::Test::HasFailure(); ++seed)
    compare(seed, 2 + static_cast<int>(seed % 9), tally);
  // The scenes are what they are for.
  EXPECT_GT(tally.events, 400u);
  EXPECT_GT(tally.beats, 300u);
  EXPECT_GT(tally.uncovered, 300u);
  EXPECT_GT(tally.undecided, 100u);
  EXPECT_GT(tally.impact, 100u);
  std::printf("%zu events, %zu heartbeats; node tests %lu, %lu with every pair on every piece\n",
              tally.events, tally.beats, tally.tests, tally.tests_of_all);
}

TEST(EngineRest, ManyObjectsWithABroadPhaseChangeNoEventAndNoCount) {
  Tally tally;
  const unsigned scenes = std::getenv("COLLISION_NODE_LONG") != nullptr ? 500 : 6;
  for (unsigned seed = 1; seed <= scenes && !testing::Test::HasFailure(); ++seed)
    compare(100000 + seed, 49 + static_cast<int>(seed % 40), tally);
  EXPECT_GT(tally.events, 200u);
  EXPECT_GT(tally.impact, 50u);
}

TEST(EngineRest, AnyNumberOfThreadsGivesTheSame) {
  RandomScene random(7, 60);
  const RandomStreams streams(random);
  Rig one(random.scene, kCertified), three(random.scene, kCertified, {false, 3});
  streams.play(one);
  streams.play(three);
  EXPECT_EQ(texts(three.events), texts(one.events));
  ASSERT_EQ(texts(three.beats), texts(one.beats));
  for (std::size_t i = 0; i < one.beats.size(); ++i) {
    EXPECT_EQ(three.beats[i].pairs_culled, one.beats[i].pairs_culled);
    EXPECT_EQ(three.beats[i].node_tests, one.beats[i].node_tests);
  }
}

/// Pairs that count how often they are asked.
Engine::MethodFactory counting(int* advances) {
  return [advances](const geometry::Body&, const geometry::Body&, const impact::PairOptions&) {
    return std::make_unique<LineMethod>(advances);
  };
}

TEST(EngineRest, AnObjectThatRestsForAHundredSegmentsAndThenFiresIsSeen) {
  int advances = 0;
  auto scene = sceneOf({movingSphere("shot"), movingSphere("tank")});
  Rig rig(scene, counting(&advances), {});
  for (Nanoseconds t = 0; t <= 10000; t += 100) {
    rig.engine.addPose(0, poseAt(t, 0.0));
    rig.engine.addPose(1, poseAt(t, 1000.0));
  }
  EXPECT_EQ(advances, 0);
  for (Nanoseconds t = 10100; t <= 12000; t += 100) {  // 2000 m/s: through the tank in the sixth segment
    rig.engine.addPose(0, poseAt(t, 2.0 * static_cast<double>(t - 10000)));
    rig.engine.addPose(1, poseAt(t, 1000.0));
  }
  rig.engine.flush();
  EXPECT_EQ(kinds(rig.events),
            (std::vector<std::string>{"IMPACT/CONFIRMED/NONE", "SEPARATION/CONFIRMED/NONE"}));
  EXPECT_EQ(rig.events[0].interval_start_ns, 10400 * kMs);
  EXPECT_GE(advances, 1);
  EXPECT_LE(advances, 4);
}

TEST(EngineRest, WhatIsFarIsNotAskedHoweverLongItFlies) {
  int advances = 0;
  auto scene = sceneOf({movingSphere("a"), movingSphere("b"), fixedSphere("c", -50.0)});
  Rig rig(scene, counting(&advances), {});
  for (Nanoseconds t = 0; t <= 60000; t += 100) {  // side by side, 10 m apart
    rig.engine.addPose(0, poseAt(t, 0.01 * static_cast<double>(t)));
    rig.engine.addPose(1, poseAt(t, 0.01 * static_cast<double>(t) + 10.0));
  }
  rig.engine.flush();
  EXPECT_EQ(advances, 0);
  EXPECT_TRUE(rig.events.empty());
  EXPECT_EQ(rig.beats.back().pairs_culled, 3u);
}

TEST(EngineRest, AResumedObjectThatWasFrozenIsMetFromWhereItComesBack) {
  for (const bool everything : {false, true}) {
    auto scene = sceneOf({movingSphere("ball"), movingSphere("clock"), movingSphere("sleeper")});
    scene->objects[2].on_timeout = OnTimeout::kFreeze;
    Rig rig(scene, kCertified, {everything, 1});
    for (Nanoseconds t = 0; t <= 9000; t += 50) {
      rig.engine.addPose(0, poseAt(t, 0.0));
      rig.engine.addPose(1, poseAt(t, 500.0));
      // Silent from 1 s to 6 s; then 100 m nearer, and through the ball.
      if (t <= 1000 || t >= 6000)
        rig.engine.addPose(2, poseAt(t, t <= 1000 ? 150.0 : 650.0 - 0.1 * static_cast<double>(t)));
    }
    rig.engine.flush();
    EXPECT_EQ(kinds(rig.events),
              (std::vector<std::string>{"IMPACT/CONFIRMED/NONE", "SEPARATION/CONFIRMED/NONE"}));
    EXPECT_EQ(rig.events[0].interval_start_ns, 6450 * kMs);
  }
}

/// A dropped object may come back at the watermark, which a third one holds back, and meet what the second
/// one did since: the second one's newest samples must not count as settled for the two.
TEST(EngineRest, AnObjectThatComesBackMeetsWhereAnotherWasSinceTheWatermark) {
  for (const int bystanders : {0, 60}) {
    std::vector<Object> objects = {movingSphere("back"), movingSphere("runner"), movingSphere("slow clock")};
    for (int i = 0; i < bystanders; ++i)
      objects.push_back(fixedSphere("w" + std::to_string(100 + i), 1e4 + 9.0 * i));
    for (const bool everything : {false, true}) {
      SCOPED_TRACE(std::to_string(bystanders) + (everything ? ", everything" : ", planned"));
      Rig rig(sceneOf(objects), kCertified, {everything, 1});
      const auto runs = [](Nanoseconds t) { return t < 2400 ? 0.0 : 0.05 * static_cast<double>(t - 2400); };
      for (Nanoseconds t = 0; t <= 3400; t += 20) {
        if (t <= 1000) rig.engine.addPose(0, poseAt(t, 46.0));
        rig.engine.addPose(1, poseAt(t, runs(t)));
        if (t >= 1000) rig.engine.addPose(2, poseAt(t - 1000, 1000.0 + 1e-3 * static_cast<double>(t)));
      }
      // The runner is known up to 3.3 s, where it is nearly at the place that the first one was seen last.
      for (Nanoseconds t = 2300; t <= 3400; t += 20) rig.engine.addPose(0, poseAt(t, 0.25));
      for (Nanoseconds t = 2420; t <= 3400; t += 20) rig.engine.addPose(2, poseAt(t, 1000.0));
      rig.engine.flush();
      ASSERT_EQ(kinds(rig.events),
                (std::vector<std::string>{"INITIAL_OVERLAP/CONFIRMED/NONE", "SEPARATION/CONFIRMED/NONE"}));
      EXPECT_EQ(rig.events[0].stamp_ns, 2300 * kMs);
    }
  }
}

/// The first pose of an object is released and the object frozen at once: nothing of it was settled before.
TEST(EngineRest, AnObjectThatIsFrozenAtItsFirstPoseMeetsWhereAnotherWasThen) {
  std::vector<Object> objects = {movingSphere("late"), movingSphere("runner"), movingSphere("slow clock")};
  objects[0].on_timeout = OnTimeout::kFreeze;
  for (int i = 0; i < 60; ++i) objects.push_back(fixedSphere("w" + std::to_string(100 + i), 1e4 + 9.0 * i));
  for (const bool everything : {false, true}) {
    Rig rig(sceneOf(objects), kCertified, {everything, 1});
    for (Nanoseconds t = 0; t <= 4000; t += 20) {  // the runner is at 0 until 2.2 s
      rig.engine.addPose(1, poseAt(t, t < 2200 ? 0.0 : 0.05 * static_cast<double>(t - 2200)));
      if (t >= 1000) rig.engine.addPose(2, poseAt(t - 1000, 1000.0));
      if (t == 3000) rig.engine.addPose(0, poseAt(2000, 0.25));
    }
    rig.engine.flush();
    ASSERT_EQ(kinds(rig.events), (std::vector<std::string>{"INITIAL_OVERLAP/UNCERTIFIED/TIMEOUT",
                                                           "SEPARATION/UNCERTIFIED/TIMEOUT"}))
        << everything;
    EXPECT_EQ(rig.events[0].stamp_ns, 2000 * kMs);
  }
}

/// Writes down what was known of the pair before each piece.
class PhaseMethod : public LineMethod {
 public:
  explicit PhaseMethod(std::vector<impact::PairState::Phase>* phases) : phases_(phases) {}
  impact::PieceOutcome advance(const impact::Piece& piece, impact::PairState& state,
                               std::vector<impact::PairEvent>& events) const override {
    phases_->push_back(state.phase);
    return LineMethod::advance(piece, state, events);
  }

 private:
  std::vector<impact::PairState::Phase>* phases_;
};

TEST(EngineRest, APairThatIsWokenIsApartAndOneThatBeginsIsNew) {
  using Phase = impact::PairState::Phase;
  std::vector<Phase> phases;
  auto scene = sceneOf({movingSphere("shot"), movingSphere("tank")});
  const auto factory = [&](const geometry::Body&, const geometry::Body&, const impact::PairOptions&) {
    return std::make_unique<PhaseMethod>(&phases);
  };
  Rig rig(scene, factory, {});
  for (Nanoseconds t = 0; t <= 10000; t += 100) {  // 200 m away; then it comes at 50 m/s
    rig.engine.addPose(0, poseAt(t, t < 5000 ? 0.0 : 0.05 * static_cast<double>(t - 5000)));
    rig.engine.addPose(1, poseAt(t, 200.0));
  }
  ASSERT_FALSE(phases.empty());
  EXPECT_EQ(phases[0], Phase::kApart);
  phases.clear();
  rig.engine.addPose(0, poseAt(12000, 0.0));  // a hole; then from near by
  for (Nanoseconds t = 10100; t <= 12500; t += 100) {
    if (t > 12000) rig.engine.addPose(0, poseAt(t, 199.2));
    rig.engine.addPose(1, poseAt(t, 200.0));
  }
  rig.engine.flush();
  ASSERT_FALSE(phases.empty());
  EXPECT_EQ(phases[0], Phase::kNew);
}

/// A shot flies in from afar, says nothing more after 1 s, and is frozen at 0; others come by, before that is
/// known and after.
TEST(EngineRest, AShotThatIsFrozenWhereItsLastSegmentEndedIsMetThereFromItsLastStampOn) {
  std::vector<Object> objects = {movingSphere("shot"), movingSphere("x clock"), movingSphere("y first"),
                                 movingSphere("z second")};
  objects[0].on_timeout = OnTimeout::kFreeze;
  for (int i = 0; i < 60; ++i) objects.push_back(fixedSphere("zz" + std::to_string(100 + i), 1e4 + 9.0 * i));
  for (const int round : {0, 1, 2, 3}) {
    const bool everything = round % 2 == 1;
    const auto scene = sceneOf(objects);
    if (round >= 2)
      scene->time.reorder = 0.0;  // the last sample is settled before it is known to be the last
    Rig rig(scene, kCertified, {everything, 1});
    for (Nanoseconds t = 0; t <= 5000; t += 20) {
      const double s = 1e-3 * static_cast<double>(t);
      if (t <= 1000) rig.engine.addPose(0, poseAt(t, 2000.0 * (s - 1.0)));
      rig.engine.addPose(1, poseAt(t, 5000.0));
      rig.engine.addPose(2, poseAt(t, -100.0 * (s - 1.505)));  // at 0 at 1.5 s; the shot is frozen at 2.6 s
      rig.engine.addPose(3, poseAt(t, -200.0 * (s - 4.0)));    // at 0 at 4 s
    }
    rig.engine.flush();
    std::vector<std::string> met;
    for (const Event& e : rig.events)
      if (e.a.object == "shot" && e.kind == impact::Kind::kImpact)
        met.push_back(e.b.object + " " + toString(e.reason) + " " + std::to_string(e.stamp_ns / (10 * kMs)));
    EXPECT_EQ(met, (std::vector<std::string>{"y first TIMEOUT 149", "z second TIMEOUT 399"})) << everything;
  }
}

/// Each goes less than half of what was between them until they meet.
TEST(EngineRest, TwoThatComeTowardsEachOtherAreWokenInTime) {
  Rig rig(sceneOf({movingSphere("left"), movingSphere("right")}), kCertified);
  for (Nanoseconds t = 0; t <= 10000; t += 50) {  // 100 m apart, 10 m/s each: 1 m apart at 4.95 s
    rig.engine.addPose(0, poseAt(t, 0.01 * static_cast<double>(t)));
    rig.engine.addPose(1, poseAt(t, 100.0 - 0.01 * static_cast<double>(t)));
  }
  rig.engine.flush();
  EXPECT_EQ(kinds(rig.events),
            (std::vector<std::string>{"IMPACT/CONFIRMED/NONE", "SEPARATION/CONFIRMED/NONE"}));
}

/// Says what it found half a second later: heartbeats come before.
class LateMethod : public LineMethod {
 public:
  impact::PieceOutcome advance(const impact::Piece& piece, impact::PairState& state,
                               std::vector<impact::PairEvent>& events) const override {
    using Phase = impact::PairState::Phase;
    if (state.phase == Phase::kUndecided) {
      if (piece.start_ns < state.last_piece.end_ns + 500 * kMs) return {};
      events.push_back(state.pending);
      state.phase = Phase::kApart;
      return {};
    }
    std::vector<impact::PairEvent> found;
    const impact::PieceOutcome outcome = LineMethod::advance(piece, state, found);
    if (found.empty()) return outcome;
    state.phase = Phase::kUndecided;
    state.pending = found.front();
    state.last_piece = piece;
    return outcome;
  }
};

TEST(EngineRest, APairWithAnOpenBracketDoesNotRestHoweverFarApartItIs) {
  const auto factory = [](const geometry::Body&, const geometry::Body&, const impact::PairOptions&) {
    return std::make_unique<LateMethod>();
  };
  for (const int bystanders : {0, 60}) {  // with many, pairs that rest are taken away at heartbeats
    // `other` comes near a bystander meanwhile, so what was taken away is used again.
    std::vector<Object> objects = {movingSphere("shot"), movingSphere("tank"), movingSphere("other")};
    for (int i = 0; i < bystanders; ++i)
      objects.push_back(fixedSphere("w" + std::to_string(100 + i), 1e4 + 9.0 * i));
    const auto scene = sceneOf(objects);
    scene->stats_period = 0.1;
    Rig rig(scene, factory, {});
    for (Nanoseconds t = 0; t <= 2000;
         t += 100) {  // through the tank in one segment, then at rest 100 m behind
      rig.engine.addPose(0, poseAt(t, t < 1000 ? -100.0 : 100.0));
      rig.engine.addPose(1, poseAt(t, 0.0));
      rig.engine.addPose(2, poseAt(t, t < 1300 ? 9500.0 : 9998.9));
    }
    rig.engine.flush();
    EXPECT_EQ(kinds(rig.events), std::vector<std::string>{"IMPACT/CONFIRMED/NONE"}) << bystanders;
  }
}

}  // namespace
}  // namespace collision_node::scene

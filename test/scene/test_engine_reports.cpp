// What the engine says beside the bare events: open brackets, contacts, heartbeats, zones; and the real
// solver once.
#include <gtest/gtest.h>

#include "collision_node/scene/zones.h"
#include "engine_fixture.h"

namespace collision_node::scene {
namespace {

using Phase = impact::PairState::Phase;

/// Opens a bracket on its first piece and closes it as an impact on its fifth.
class SlowMethod : public LineMethod {
 public:
  impact::PieceOutcome advance(const impact::Piece& piece, impact::PairState& state,
                               std::vector<impact::PairEvent>& events) const override {
    impact::PieceOutcome outcome;
    if (state.phase == Phase::kNew) {
      state.phase = Phase::kUndecided;
      state.pending = eventAt(piece, impact::Kind::kImpact, 0.05);
      outcome.answer = impact::Answer::kUndecided;
    } else if (piece.end_ns == 500 * kMs) {
      state.phase = Phase::kTouching;
      events.push_back(state.pending);
      events.back().toi_upper = 0.45;
      outcome.answer = impact::Answer::kImpact;
    }
    state.last_piece = piece;
    return outcome;
  }
};

Engine::MethodFactory slowFirst() {
  auto count = std::make_shared<int>(0);
  return [count](const geometry::Body&, const geometry::Body&,
                 const impact::PairOptions&) -> std::unique_ptr<impact::PairMethod> {
    if ((*count)++ == 0) return std::make_unique<SlowMethod>();
    return std::make_unique<LineMethod>();
  };
}

TEST(EngineBrackets, AnOpenBracketHoldsBackTheWatermarkAndWhatComesLater) {
  auto scene = sceneOf({movingSphere("ball"), fixedSphere("fog", 100.0), fixedSphere("wall", 5.0)});
  scene->pairs = {{0, 0, 1, 0, 0.0}, {0, 0, 2, 0, 0.0}};
  Rig rig(scene, slowFirst());
  rig.feedLine(0, 0, 500, 100, 0.0, 20.0);  // meets the wall at 0.2 s, leaves it at 0.3 s
  EXPECT_TRUE(rig.events.empty());
  EXPECT_EQ(rig.engine.stats().watermark_ns, 50 * kMs);
  EXPECT_EQ(rig.engine.stats().pairs_undecided, 1u);
  rig.feedLine(0, 600, 600, 100, 0.0, 20.0);
  ASSERT_EQ(rig.events.size(), 3u);
  EXPECT_EQ(rig.events[0].b.object, "fog");
  EXPECT_EQ(rig.events[0].toi_upper, 0.45);  // carried over its piece's end
  EXPECT_EQ(rig.events[1].b.object, "wall");
  EXPECT_EQ(rig.engine.stats().watermark_ns, 500 * kMs);
  EXPECT_EQ(rig.engine.stats().worst_bracket, 0.45 - 0.05);
}

TEST(EngineBrackets, ACarriedBracketKeepsTheDoubtOfWhereItOpened) {
  Rig rig(sceneOf({movingSphere("ball"), fixedSphere("fog", 100.0)}), slowFirst());
  for (Nanoseconds t = 0; t <= 600; t += 100) rig.engine.addPose(0, poseAt(t, 0.0), t == 0);
  ASSERT_EQ(rig.events.size(), 1u);
  EXPECT_EQ(rig.events[0].certificate, impact::Certificate::kUncertified);
  EXPECT_EQ(rig.events[0].reason, impact::Reason::kStampGuessed);
}

/// IMPACT confirmed, then a POSSIBLE one inside the contact, then the separation.
class DoubtfulMethod : public LineMethod {
 public:
  impact::PieceOutcome advance(const impact::Piece& piece, impact::PairState& state,
                               std::vector<impact::PairEvent>& events) const override {
    if (state.phase == Phase::kNew) {
      events.push_back(eventAt(piece, impact::Kind::kImpact, 0.01));
      events.push_back(eventAt(piece, impact::Kind::kImpact, 0.02));
      events.back().certificate = impact::Certificate::kPossible;
      events.push_back(eventAt(piece, impact::Kind::kSeparation, 0.03));
    }
    state.phase = Phase::kApart;
    return {};
  }
};

TEST(EngineContacts, APossibleImpactStandsAlone) {
  Rig rig(sceneOf({movingSphere("ball"), fixedSphere("fog", 100.0)}),
          [](const geometry::Body&, const geometry::Body&, const impact::PairOptions&) {
            return std::make_unique<DoubtfulMethod>();
          });
  rig.feedLine(0, 0, 300, 100, 0.0, 0.0);
  ASSERT_EQ(rig.events.size(), 3u);
  EXPECT_EQ(rig.events[0].contact_id, 0u);
  EXPECT_EQ(rig.events[1].contact_id, 1u);
  EXPECT_EQ(rig.events[2].contact_id, 0u);
}

TEST(EngineStats, EveryPairIsInExactlyOneBin) {
  std::vector<Object> objects = {movingSphere("absent"), movingSphere("ball"), movingSphere("other"),
                                 fixedSphere("wall", 10.0)};
  Rig rig(sceneOf(objects));
  for (Nanoseconds t = 0; t <= 7000; t += 100) {
    rig.engine.addPose(1, poseAt(t, 0.002 * static_cast<double>(t)));  // touches the wall from 4.5 s to 5.5 s
    rig.engine.addPose(2, poseAt(t, 50.0));
  }
  rig.engine.flush();
  ASSERT_EQ(rig.beats.size(), 7u);
  for (std::size_t i = 0; i < rig.beats.size(); ++i) {
    const Stats& beat = rig.beats[i];
    EXPECT_EQ(beat.pairs_culled + beat.pairs_clear + beat.pairs_impact + beat.pairs_undecided, 3u);
    EXPECT_EQ(beat.pairs_uncovered, 3u);
    EXPECT_EQ(beat.stamp_ns, static_cast<Nanoseconds>(i + 1) * 1000 * kMs);
    // Named only when it has been waited for long enough.
    EXPECT_EQ(beat.uncovered_objects.size(), i == 0 ? 0u : 1u);
    EXPECT_EQ(beat.has_watermark, i > 0);
    EXPECT_EQ(beat.pairs_impact, i == 4 || i == 5 ? 1u : 0u) << i;
  }
  EXPECT_EQ(rig.beats.back().accepted, 142u);
}

std::uint64_t binsOf(const Stats& s) {
  return s.pairs_culled + s.pairs_clear + s.pairs_impact + s.pairs_undecided;
}

TEST(EngineStats, APairWithAHoleIsUncoveredUntilTheNextHeartbeat) {
  auto scene = sceneOf({movingSphere("ball"), movingSphere("other"), fixedSphere("wall", 10.0)});
  scene->pairs = {{0, 0, 2, 0, 0.0}, {1, 0, 2, 0, 0.0}};
  for (const bool teleport : {false, true}) {
    SCOPED_TRACE(teleport);
    scene->objects[0].max_speed = teleport ? 50.0 : 1e9;
    Rig rig(scene);
    for (Nanoseconds t = 0; t <= 5000; t += 100) {
      rig.engine.addPose(1, poseAt(t, 50.0));
      // Through the wall unseen, between 2.1 s and 3.3 s or in one step.
      if (teleport || t <= 2100 || t >= 3300) rig.engine.addPose(0, poseAt(t, t <= 2100 ? 0.0 : 20.0));
    }
    rig.engine.flush();
    EXPECT_TRUE(rig.events.empty());
    ASSERT_EQ(rig.beats.size(), 5u);
    const std::size_t with_hole = teleport ? 2 : 3;  // a gap is known at its end
    for (std::size_t i = 0; i < rig.beats.size(); ++i) {
      SCOPED_TRACE(i);
      const Stats& beat = rig.beats[i];
      const bool has_hole = i == with_hole;
      EXPECT_EQ(binsOf(beat), has_hole ? 1u : 2u);
      EXPECT_EQ(beat.pairs_uncovered, has_hole ? 1u : 0u);
      EXPECT_EQ(beat.uncovered_objects, std::vector<std::string>(has_hole ? 1 : 0, "ball"));
      EXPECT_EQ(beat.holes, i >= with_hole ? 1u : 0u);
    }
    const Stats stats = rig.engine.stats();
    ASSERT_TRUE(stats.first_hole);
    EXPECT_EQ(stats.first_hole_object, "ball");
    EXPECT_EQ(stats.first_hole->after_ns, 2100 * kMs);
    EXPECT_EQ(stats.first_hole->reason, impact::Reason::kGap);
  }
}

TEST(EngineStats, ADroppedObjectIsUncoveredUntilTheHeartbeatAfterItsReturn) {
  auto scene = sceneOf({movingSphere("ball"), movingSphere("clock"), fixedSphere("wall", 10.0)});
  scene->pairs = {{0, 0, 2, 0, 0.0}, {1, 0, 2, 0, 0.0}};
  Rig rig(scene);
  for (Nanoseconds t = 0; t <= 8000; t += 100) {
    rig.engine.addPose(1, poseAt(t, 50.0));
    if (t <= 1200 || t >= 5300) rig.engine.addPose(0, poseAt(t, 0.0));
  }
  rig.engine.flush();
  ASSERT_EQ(rig.beats.size(), 8u);
  for (std::size_t i = 0; i < rig.beats.size(); ++i) {
    const bool is_missed = i >= 2 && i <= 5;  // silent since 1.2 s, known at 2.8 s; back at 5.3 s
    EXPECT_EQ(rig.beats[i].pairs_uncovered, is_missed ? 1u : 0u) << i;
    EXPECT_EQ(rig.beats[i].uncovered_objects, std::vector<std::string>(is_missed ? 1 : 0, "ball")) << i;
    EXPECT_EQ(rig.beats[i].holes, i >= 2 ? 1u : 0u) << i;
  }
  EXPECT_EQ(rig.engine.stats().first_hole->reason, impact::Reason::kTimeout);
}

TEST(EngineStats, APairThatSharedNoTimeIsUncoveredAndNotCulled) {
  Rig rig(sceneOf({movingSphere("a"), movingSphere("b")}));
  rig.engine.addPose(0, poseAt(0, 0.0));
  rig.engine.addPose(1, poseAt(0, 0.0));
  rig.engine.flush();
  ASSERT_EQ(rig.beats.size(), 1u);
  EXPECT_EQ(rig.beats[0].pairs_uncovered, 1u);
  EXPECT_EQ(rig.engine.stats().pairs_uncovered, 1u);
  EXPECT_EQ(binsOf(rig.engine.stats()), 0u);
  rig.feedLine(0, 100, 1000, 100, 0.0, 0.0);
  rig.feedLine(1, 100, 1000, 100, 50.0, 0.0);
  EXPECT_EQ(rig.engine.stats().pairs_uncovered, 1u);  // there was a heartbeat before
  rig.engine.flush();
  EXPECT_EQ(rig.engine.stats().pairs_uncovered, 0u);
}

TEST(EngineStats, AStaticTestCoversTheWholeEpochHoweverLateItComes) {
  auto scene = sceneOf(
      {movingSphere("absent"), movingSphere("ball"), fixedSphere("slab", 8.0), fixedSphere("wall", 10.0)});
  scene->pairs = {{0, 0, 3, 0, 0.0}, {1, 0, 3, 0, 0.0}, {2, 0, 3, 0, 0.0}};
  Rig rig(scene);
  rig.feedLine(1, 0, 3000, 100, 50.0, 0.0);
  ASSERT_EQ(rig.beats.size(), 2u);
  EXPECT_EQ(rig.beats[0].pairs_uncovered, 2u);  // before the watermark: the test, and who is absent
  EXPECT_EQ(rig.beats[1].pairs_uncovered, 1u);
  EXPECT_EQ(rig.beats[1].pairs_clear, 2u);
}

TEST(EngineStats, AnObjectThatIsFixedBetweenHeartbeatsIsCountedOnce) {
  Rig rig(sceneOf(
      {movingSphere("absent"), movingSphere("ball"), fixedSphere("post", 8.0), fixedSphere("wall", 10.0)}));
  rig.feedLine(1, 0, 1200, 100, 50.0, 0.0);  // a heartbeat while all wait for the first one
  ASSERT_EQ(rig.beats.size(), 1u);
  Pose pose;
  pose.position.x() = 20.0;
  rig.engine.fix(0, pose);
  const Stats stats = rig.engine.stats();
  // Three pairs stand and are tested; the ball has met what stands, and not yet who has just come.
  EXPECT_EQ(stats.pairs_uncovered, 1u);
  EXPECT_EQ(stats.pairs_clear, 5u);
  EXPECT_EQ(stats.pairs_culled + stats.pairs_impact + stats.pairs_undecided, 0u);
}

TEST(EngineStats, WhatIsInDoubtIsNeverClearNorCulled) {
  Rig rig(sceneOf({fixedSphere("post", 0.0), movingSphere("visitor")}), impact::MethodName::kCertified);
  for (Nanoseconds t = 0; t <= 3000; t += 100) rig.engine.addPose(1, poseAt(t, 50.0), true);
  ASSERT_GE(rig.beats.size(), 2u);
  for (const Stats& beat : rig.beats) {
    EXPECT_EQ(beat.pairs_undecided, 1u);
    EXPECT_EQ(beat.pairs_clear + beat.pairs_culled + beat.pairs_impact + beat.pairs_uncovered, 0u);
  }
}

/// What a consumer knows from heartbeats alone: clear up to a watermark that moves, or nothing new.
TEST(EngineStats, ClearUpToTheWatermarkIsToldFromNothingArrived) {
  Rig rig(sceneOf({movingSphere("a"), movingSphere("b")}), impact::MethodName::kCertified);
  rig.feedLine(0, 0, 5000, 100, 0.0, 0.0);
  EXPECT_EQ(rig.beats.back().has_watermark, true);  // b is given up after `timeout`, and said to be uncovered
  EXPECT_EQ(rig.beats.back().pairs_uncovered, 1u);
  EXPECT_EQ(rig.beats.back().uncovered_objects, std::vector<std::string>{"b"});
  Rig both(sceneOf({movingSphere("a"), movingSphere("b")}), impact::MethodName::kCertified);
  for (Nanoseconds t = 0; t <= 5000; t += 100) {
    both.engine.addPose(0, poseAt(t, 0.0));
    both.engine.addPose(1, poseAt(t, 9.0));
  }
  const Stats& last = both.beats.back();
  EXPECT_EQ(last.pairs_clear + last.pairs_culled, 1u);
  EXPECT_EQ(last.stamp_ns, 4000 * kMs);
  EXPECT_EQ(last.watermark_ns, 3900 * kMs);  // b's pose of that time is not there yet
  // While nothing arrives the watermark stands.
  EXPECT_EQ(both.engine.stats().watermark_ns, 4900 * kMs);
  EXPECT_DOUBLE_EQ(both.engine.stats().latency, 0.1);
}

TEST(EngineStats, TheEndOfAnEpochIsNoHole) {
  Rig rig(sceneOf({movingSphere("ball"), fixedSphere("wall", 10.0)}));
  rig.feedLine(0, 5000, 6500, 100, 0.0, 0.0);
  rig.feedLine(0, 0, 400, 100, 0.0, 0.0);
  ASSERT_EQ(rig.beats.size(), 2u);
  EXPECT_EQ(rig.beats[1].stamp_ns, 6500 * kMs);
  EXPECT_EQ(rig.beats[1].pairs_clear, 1u);
  EXPECT_EQ(rig.engine.stats().epoch, 1u);
  EXPECT_EQ(rig.engine.stats().pairs_clear, 1u);
  EXPECT_EQ(rig.engine.stats().holes, 0u);
}

TEST(EngineStats, DataThatLeapOverSeveralPeriodsBringOneHeartbeat) {
  Rig rig(sceneOf({movingSphere("ball"), fixedSphere("wall", 10.0)}));
  rig.feedLine(0, 0, 500, 100, 0.0, 0.0);
  rig.feedLine(0, 7500, 7700, 100, 0.0, 0.0);
  ASSERT_EQ(rig.beats.size(), 1u);
  EXPECT_EQ(rig.beats[0].stamp_ns, 7000 * kMs);
}

// ---- zones

Zone boxZone(const std::string& name, const Vec3& centre, const Vec3& size) {
  Zone zone;
  zone.name = name;
  zone.link = "turret";
  zone.has_box = true;
  zone.size = size;
  zone.pose.position = centre;
  return zone;
}

TEST(Zones, TheFirstThatHoldsThePointWins) {
  Object tank;
  tank.zones = {boxZone("hatch", {0, 0, 1}, {1, 1, 1}), boxZone("cockpit", {0, 0, 0}, {4, 4, 4})};
  EXPECT_EQ(findZone(tank, "turret", {0, 0, 1}, {0, 0, 1}, 0.1).name, "hatch");
  EXPECT_EQ(findZone(tank, "turret", {0, 0, -1}, {0, 0, -1}, 0.1).name, "cockpit");
  EXPECT_EQ(findZone(tank, "turret", {0, 0, 3}, {0, 0, 3}, 0.1).name, "");
  EXPECT_EQ(findZone(tank, "turret", {0, 0, 3}, {0, 0, 3}, std::nan("")).name, "");
  EXPECT_EQ(findZone(tank, "hull", {0, 0, 1}, {0, 0, 1}, 0.1).name, "");
}

TEST(Zones, AWitnessJustOutsideIsInTheZoneThatItsBallMeets) {
  // Boxes that end on the link's own surface: the witness lies a rounding beyond it.
  Object tank;
  tank.zones = {boxZone("left", {-0.5, 0, 0}, {1, 2, 2}), boxZone("right", {0.5, 0, 0}, {1, 2, 2})};
  const Vec3 hit(1.0 + 3e-13, 0.2, 0.3);
  const ZoneAnswer answer = findZone(tank, "turret", hit, hit, 1e-9);
  EXPECT_EQ(answer.name, "right");
  EXPECT_FALSE(answer.certain);
  EXPECT_EQ(findZone(tank, "turret", hit, hit, 1e-13).name, "");
  // On the seam the first wins; nothing is certain.
  const Vec3 seam(0, 0, 1.0 + 1e-12);
  EXPECT_EQ(findZone(tank, "turret", seam, seam, 1e-9).name, "left");
}

TEST(Zones, CertainMeansTheWholeBall) {
  Object tank;
  tank.zones = {boxZone("hatch", {0, 0, 1}, {1, 1, 1}), boxZone("cockpit", {0, 0, 0}, {4, 4, 4})};
  const auto certain = [&](double z, double radius) {
    return findZone(tank, "turret", {0, 0, z}, {0, 0, z}, radius).certain;
  };
  EXPECT_TRUE(certain(1.0, 0.49));
  EXPECT_FALSE(certain(1.0, 0.51));
  EXPECT_TRUE(certain(0.0, 0.49));
  EXPECT_FALSE(certain(0.0, 0.51));  // it reaches into the hatch, which comes first
  EXPECT_TRUE(certain(3.0, 0.99));
  EXPECT_FALSE(certain(3.0, 1.01));  // it touches a zone, so "none" is not certain
  EXPECT_FALSE(certain(1.0, std::nan("")));
}

TEST(Zones, AWholeLinkIsAlwaysCertain) {
  Object tank;
  Zone zone;
  zone.name = "turret";
  zone.link = "turret";
  tank.zones = {zone};
  const ZoneAnswer answer = findZone(tank, "turret", {9, 9, 9}, {9, 9, 9}, 1e9);
  EXPECT_EQ(answer.name, "turret");
  EXPECT_TRUE(answer.certain);
}

TEST(Zones, AreInTheLinksFrame) {
  Object tank = fixedSphere("tank", 10.0);
  Link& link = tank.links[0];
  link.name = "turret";
  link.T_o_l.position = {0, 0, -2};
  tank.zones = {boxZone("front", {-0.5, 0, 2}, {0.2, 0.2, 0.2})};
  Rig rig(sceneOf({movingSphere("ball"), tank}));
  rig.feedLine(0, 0, 1000, 100, 0.0, 20.0);
  rig.engine.flush();
  ASSERT_EQ(rig.events.size(), 2u);
  EXPECT_EQ(rig.events[0].b.zone, "front");
  EXPECT_TRUE(rig.events[0].b.zone_certain);
  EXPECT_LT((rig.events[0].b.point - Vec3(-0.5, 0, 2)).norm(), 1e-9);
  EXPECT_LT((rig.events[0].b.pose.position - Vec3(10, 0, -2)).norm(), 1e-12);
  EXPECT_EQ(rig.events[1].b.zone, "");  // out at the other side
}

// ---- with the real solver

TEST(EngineEndToEnd, TwoSpheresFlyPastEachOtherAt2000MetresPerSecond) {
  Rig rig(sceneOf({movingSphere("efp"), movingSphere("tank")}), impact::MethodName::kCertified);
  const Nanoseconds epoch = 1'700'000'000'000'000'000;
  // The efp at 30 Hz along x, offset by 0.6 m in y; the tank at 7 Hz, driving at 15 m/s along y.
  for (int i = 0; i <= 15; ++i) {
    motion::StampedPose pose;
    pose.stamp_ns = epoch + i * 33'333'333LL;
    const double t = static_cast<double>(i) * 0.033333333;
    pose.pose.position = {-500.0 + 2000.0 * t, 0.6, 0.0};
    rig.engine.addPose(0, pose);
  }
  for (int i = 0; i <= 4; ++i) {
    motion::StampedPose pose;
    pose.stamp_ns = epoch + i * 142'857'143LL;
    pose.pose.position = {0.0, -3.75 + 15.0 * 0.142857143 * i, 0.0};
    rig.engine.addPose(1, pose);
  }
  rig.engine.flush();
  ASSERT_EQ(kinds(rig.events),
            (std::vector<std::string>{"IMPACT/CONFIRMED/NONE", "SEPARATION/CONFIRMED/NONE"}));
  // |(-500 + 2000 t, 0.6 + 3.75 - 15 t)| = 1
  const double a = 2000.0 * 2000.0 + 15.0 * 15.0, b = -500.0 * 2000.0 - 4.35 * 15.0;
  const double c = 500.0 * 500.0 + 4.35 * 4.35 - 1.0;
  const double half = std::sqrt(b * b - a * c) / a, middle = -b / a;
  for (const Event& event : rig.events) {
    const double truth = event.kind == impact::Kind::kImpact ? middle - half : middle + half;
    const double start = motion::secondsBetween(epoch, event.interval_start_ns);
    EXPECT_LE(start + event.toi_lower, truth + 1e-12);
    EXPECT_GE(start + event.toi_upper, truth - 1e-12);
    EXPECT_LE(event.toi_upper - event.toi_lower, 1e-9);
    EXPECT_LE(event.position_error, 1e-6);
  }
  EXPECT_EQ(rig.events[0].contact_id, rig.events[1].contact_id);
}

}  // namespace
}  // namespace collision_node::scene

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
  EXPECT_EQ(findZone(tank, "hull", {0, 0, 1}, {0, 0, 1}, 0.1).name, "");
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

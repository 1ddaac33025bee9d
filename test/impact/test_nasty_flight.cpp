/// Nasty cases of fast straight flight: great steps, small bodies, far origins, paths that hit an edge, a
/// vertex, a stamp exactly. The right answers are in closed form; a case keeps its number from the list of
/// known traps.
#include "test/impact/nasty.h"

namespace nasty {
namespace {

TEST(Nasty, C01_AFiveMillimetreSphereThroughATenMillimetrePlateIsTimedToAPicosecond) {
  PairOptions options;
  options.time_precision = 1e-12;
  for (const bool as_mesh : {false, true}) {
    Watched pair({as_mesh ? moving::boxMesh({1, 1, 0.005}) : box(2, 2, 0.01)}, {sphere(0.005)}, options);
    fly(pair, {0.3, 0.1, 33.25}, {0, 0, -2000});
    ASSERT_EQ(pair.story(), kInAndOut) << pair.list();
    const Real thick = 0.005L * 2;  // both lengths are doubles near 0.005: 1e-18 m off
    EXPECT_TRUE(holds(pair.events[0], 0, (33.25L - thick) / 2000)) << pair.list();
    EXPECT_TRUE(holds(pair.events[1], 0, (33.25L + thick) / 2000)) << pair.list();
    for (const PairEvent& e : pair.events) EXPECT_LE(widthOf(e), 1e-12) << pair.list();
    EXPECT_TRUE(coneHolds(pair.events[0], {0, 0, 1})) << "the front face\n" << pair.list();
    EXPECT_LE(pair.events[0].normal_error, 1e-3) << pair.list();
    EXPECT_EQ(pair.events[0].a.feature, Feature::kFace) << pair.list();
    EXPECT_EQ(pair.events[0].b.feature, Feature::kSmooth) << pair.list();
    EXPECT_TRUE(ballHolds(pair.events[0], {0.3, 0.1, 0.005})) << pair.list();
    EXPECT_DOUBLE_EQ(pair.events[0].closing_speed, 2000.0);
  }
}

/// A sphere through a plate whose poses carry `world`; returns the true times for the rounded poses.
std::array<Real, 2> farAway(Watched& pair, const Vec3& world) {
  motion::StampedPose from, to;
  const Vec3 plate = world;
  from.pose.position = world + Vec3(0.25, 0.125, 33.25);
  to.pose.position = world + Vec3(0.25, 0.125, -33.5);
  from.stamp_ns = 1'700'000'000'000'000'000;
  to.stamp_ns = from.stamp_ns + kFrame;
  pair.advance(from.stamp_ns, to.stamp_ns, resting(plate), motion::straightSlerp(from, to));
  const Real z0 = static_cast<Real>(from.pose.position.z()) - plate.z();
  const Real z1 = static_cast<Real>(to.pose.position.z()) - plate.z();
  const Real touch = 0.0078125L * 2, h = static_cast<Real>(kFrame) * 1e-9L;
  return {h * (z0 - touch) / (z0 - z1), h * (z0 + touch) / (z0 - z1)};
}

TEST(Nasty, C02_TenThousandKilometresFromTheOriginTheAnswerIsThatOfTheRoundedPoses) {
  const auto plate = box(2, 2, 0.015625);
  const auto ball = sphere(0.0078125);
  Watched near({plate}, {ball});
  farAway(near, Vec3::Zero());
  ASSERT_EQ(near.story(), kInAndOut) << near.list();
  for (const double offset : {1e7, 1e7 + 1.0 / 3.0, -1e8 / 7.0}) {
    Watched far({plate}, {ball});
    const std::array<Real, 2> truth = farAway(far, Vec3::Constant(offset));
    ASSERT_EQ(far.story(), kInAndOut) << far.list();
    for (int i = 0; i < 2; ++i) {
      EXPECT_TRUE(holds(far.events[i], 1'700'000'000'000'000'000, truth[i], 1e-17L)) << offset << far.list();
      EXPECT_LE(widthOf(far.events[i]), 1e-9) << far.list();
      if (offset != 1e7) continue;
      EXPECT_EQ(far.events[i].toi_lower, near.events[i].toi_lower) << "an exact offset costs no bit";
      EXPECT_EQ(far.events[i].toi_upper, near.events[i].toi_upper);
    }
  }
}

TEST(Nasty, C03_APointThatEndsExactlyOnAVertexIsOneImpactWhateverComesNext) {
  // The end belongs to the piece. What follows: through, back, along an edge of the octahedron, at rest.
  const Vec3 vertex(0, 0, 0.5);
  for (const double reach : {66.0, 1024.0, 1e5}) {
    const Vec3 way(0.25 * reach, -0.125 * reach, reach);  // arrives by -way within a second
    for (const Vec3& next : {Vec3(-way), way, Vec3(1, 0, -1), Vec3(0, 0, 0)}) {
      for (const bool ended : {false, true}) {
        Watched pair({octahedron(0.5)}, {point()});
        pair.advance(0, kSecond, resting(), flight(0, kSecond, vertex + way, -way));
        if (!ended) pair.advance(kSecond, 2 * kSecond, resting(), flight(kSecond, 2 * kSecond, vertex, next));
        pair.finish();
        ASSERT_EQ(pair.count(Kind::kImpact), 1) << "then " << next.transpose() << '\n' << pair.list();
        EXPECT_EQ(pair.count(Kind::kInitialOverlap), 0) << pair.list();
        EXPECT_TRUE(holds(pair.events[0], 0, 1.0L)) << pair.list();
        EXPECT_TRUE(ballHolds(pair.events[0], vertex)) << pair.list();
        if (!ended && next.z() == -reach) {
          EXPECT_EQ(pair.events[0].certificate, Certificate::kConfirmed) << "it goes in\n" << pair.list();
        }
      }
    }
  }
}

TEST(Nasty, C04_limit_APointThatStartsExactlyOnAFaceIsAPossibleOverlapAlone) {
  // Wanted: INITIAL_OVERLAP CONFIRMED, then SEPARATION with 0 in its bracket. Rounded arithmetic proves no
  // touching without depth, and a POSSIBLE stands alone; never an IMPACT, never nothing.
  for (const auto& solid : {box(2, 2, 2), moving::boxMesh({1, 1, 1})}) {
    Watched pair({solid}, {point()});
    fly(pair, {0.2, 0.1, 1}, {0, 0, 100});
    pair.finish();
    EXPECT_EQ(pair.story(), "INITIAL_OVERLAP POSSIBLE") << pair.list();
    EXPECT_EQ(pair.events[0].toi_lower, 0.0);
    EXPECT_LE(pair.events[0].toi_upper, 1e-9) << "a contact that follows at once would be in the bracket";
    EXPECT_EQ(pair.state.phase, Phase::kApart) << "it is proved to have left";
  }
  // A nanometre of depth is proved, and so is its end.
  Watched deeper({box(2, 2, 2)}, {point()});
  fly(deeper, {0.2, 0.1, 1 - 1e-9}, {0, 0, 100});
  ASSERT_EQ(deeper.story(), "INITIAL_OVERLAP CONFIRMED, SEPARATION CONFIRMED") << deeper.list();
  EXPECT_TRUE(holds(deeper.events[1], 0, (1 - static_cast<Real>(1 - 1e-9)) / 100)) << deeper.list();
}

TEST(Nasty, C05_ThroughASharedEdgeOrVertexIsExactlyOneImpact) {
  std::vector<Vec3> rim = {{0, 0, 0}};
  std::vector<Corners> fan;
  for (int k = 0; k < 6; ++k) {
    rim.push_back({std::cos(kPi / 3 * k), std::sin(kPi / 3 * k), 0});
    fan.push_back({0, 1 + k, 1 + (k + 1) % 6});
  }
  const auto wheel = moving::mesh(rim, fan), sheet = moving::sheet(1);
  struct Row {
    PlacedShape target;
    Vec3 aim;
  };
  for (const Row& row : {Row{sheet, {0.25, 0.25, 0}}, Row{sheet, {1.0 / 3, 1.0 / 3, 0}},
                         Row{wheel, {0, 0, 0}}, Row{wheel, {0.25, 0, 0}}}) {
    for (const Vec3& way : {Vec3(0, 0, 10), Vec3(3, -2, 10), Vec3(-7, 5, 10)}) {
      Watched pair({row.target}, {point()});
      fly(pair, row.aim + way, -200 * way);
      ASSERT_EQ(pair.story(), kInAndOut) << row.aim.transpose() << pair.list();
      EXPECT_TRUE(holds(pair.events[0], 0, 0.005L, 1e-17L)) << pair.list();
      EXPECT_TRUE(ballHolds(pair.events[0], row.aim)) << pair.list();
      EXPECT_GE(pair.events[0].a.triangle, 0) << pair.list();
    }
  }
  Watched miss({sheet}, {point()});
  fly(miss, {1.001, 0, 10}, {0, 0, -2000});
  EXPECT_EQ(miss.story(), "");
  EXPECT_EQ(miss.state.phase, Phase::kApart);
}

TEST(Nasty, C06_AFallInThePlaneOfAFaceHitsItsEdge) {
  Watched pair({moving::sheet(1)}, {sphere(0.01)});
  fly(pair, {-10, 0.3, 0}, {2000, 0, 0});
  ASSERT_EQ(pair.story(), kInAndOut) << pair.list();
  EXPECT_TRUE(holds(pair.events[0], 0, 8.99L / 2000)) << pair.list();
  EXPECT_TRUE(coneHolds(pair.events[0], {-1, 0, 0})) << "in the plane\n" << pair.list();
  EXPECT_LT(pair.events[0].normal_error, 0.01) << pair.list();
  EXPECT_EQ(pair.events[0].a.feature, Feature::kEdge) << pair.list();
  EXPECT_TRUE(ballHolds(pair.events[0], {-1, 0.3, 0})) << pair.list();
  EXPECT_LT(pair.events[0].position_error, 1e-3);
  // A body without radius: the octahedron an eighth of a metre off its middle, where it is 0.375 m wide.
  Watched flank({moving::sheet(1)}, {octahedron(0.5)});
  fly(flank, {-10, 0.3, 0.125}, {2000, 0, 0});
  ASSERT_EQ(flank.story(), kInAndOut) << flank.list();
  EXPECT_TRUE(holds(flank.events[0], 0, 8.625L / 2000)) << flank.list();
  EXPECT_TRUE(ballHolds(flank.events[0], {-1, 0.3, 0})) << flank.list();
}

TEST(Nasty, C06_limit_AMeshWhoseEdgesLieInTheSurfacesPlaneIsPossibleAllTheWay) {
  // No triangle of the octahedron goes through the plane of the sheet: no two of them share more than rims.
  Watched tip({moving::sheet(1)}, {octahedron(0.5)});
  fly(tip, {-10, 0.3, 0}, {2000, 0, 0});
  tip.finish();
  ASSERT_EQ(tip.story(), "IMPACT POSSIBLE") << tip.list();
  EXPECT_TRUE(holds(tip.events[0], 0, 8.5L / 2000)) << tip.list();
  EXPECT_TRUE(ballHolds(tip.events[0], {-1, 0.3, 0})) << tip.list();
}

TEST(Nasty, C10_ASphereFlyByAtTheRounding) {
  // +gap: clear or POSSIBLE; 0 or -gap: POSSIBLE or CONFIRMED, and the bracket holds the closest instant.
  const double r = 0.5;
  for (const double gap : {1e-12 * r, 0.0, -1e-12 * r}) {
    Watched pair({sphere(r)}, {sphere(r)});
    fly(pair, {-20, 2 * r + gap, 0}, {2000, 0, 0});
    pair.finish();
    if (gap > 0.0) {
      for (const PairEvent& e : pair.events) EXPECT_EQ(e.certificate, Certificate::kPossible) << pair.list();
      EXPECT_LE(pair.events.size(), 1u) << pair.list();
      continue;
    }
    ASSERT_FALSE(pair.events.empty()) << "gap " << gap;
    EXPECT_EQ(pair.events[0].kind, Kind::kImpact);
    EXPECT_LE(moving::lowerOf(pair.events[0], 0), 0.01L);
    EXPECT_GE(moving::upperOf(pair.events.back(), 0), 0.01L) << pair.list();
    EXPECT_EQ(pair.count(Kind::kImpact), 1) << pair.list();
  }
}

TEST(Nasty, C11_AFlyByIsClear) {
  // Gaps down to a nanometre at 66 m a frame.
  for (const double gap : {5e-4, 1e-5, 1e-9}) {
    Watched spheres({sphere(0.5)}, {sphere(0.5)});
    fly(spheres, {-33, 1.0 + gap, 0}, {2000, 0, 0});
    EXPECT_EQ(spheres.story(), "") << gap << spheres.list();
    Watched mesh({moving::boxMesh({1, 1, 1})}, {sphere(0.05)});
    fly(mesh, {-33, 1.05 + gap, 0.3}, {2000, 0, 0});
    EXPECT_EQ(mesh.story(), "") << gap << mesh.list();
    Watched boxes({box(2, 2, 2)}, {box(1, 1, 1)});
    fly(boxes, {-33, 1.5 + gap, 0.3}, {2000, 0, 0});
    EXPECT_EQ(boxes.story(), "") << gap << boxes.list();
  }
}

TEST(Nasty, C20_NoRelativeMotionIsClearWithoutWorkOrOneOverlap) {
  Watched apart({box(2, 2, 2)}, {box(1, 1, 1)}), overlap({box(2, 2, 2)}, {box(1, 1, 1)});
  for (int i = 0; i < 3; ++i) {
    const Nanoseconds from = i * kFrame, to = from + kFrame;
    const auto both = [&](const Vec3& at) { return flight(from, to, at, {1000, -500, 20}); };
    const PieceOutcome outcome = apart.advance(from, to, both(Vec3::Zero()), both({0, 0, 1.6}));
    EXPECT_LT(outcome.node_tests, 20u);
    EXPECT_TRUE(outcome.answer == Answer::kClear || outcome.answer == Answer::kCulled);
    overlap.advance(from, to, both(Vec3::Zero()), both({0.1, 0.2, 1.4}));
  }
  EXPECT_EQ(apart.story(), "");
  EXPECT_EQ(overlap.story(), "INITIAL_OVERLAP CONFIRMED") << overlap.list();
}

TEST(Nasty, C29_AGrazeIsNotLostBeforeARealHitANanosecondLater) {
  // Two micrometres behind the instant at which it grazes a ball exactly, the bullet meets a wall.
  const auto graze = sphere(0.5, {0, 1, 0});
  const Real at = 0.01L, later = at + 1e-9L;
  const auto wall = box(1, 4, 4, {0.5 + 0.5 + 2000e-9, 0, 0});
  Watched pair({graze, wall}, {sphere(0.5)});
  fly(pair, {-20, 0, 0}, {2000, 0, 0});
  pair.finish();
  ASSERT_FALSE(pair.events.empty());
  EXPECT_TRUE(anyHolds(pair, Kind::kImpact, 0, at)) << pair.list();
  EXPECT_TRUE(anyHolds(pair, Kind::kImpact, 0, later, 1e-14L)) << pair.list();
  EXPECT_LE(pair.count(Kind::kImpact), 2) << pair.list();
  EXPECT_TRUE(holds(pair.events[0], 0, at)) << "never only the second\n" << pair.list();
}

/// A sphere falls on a box at 1 m/s, both on the same orbit.
void fallInOrbit(Watched& pair, Nanoseconds now, const Vec3& orbit) {
  const Vec3 far = Vec3::Constant(0x1p22);
  pair.advance(now, now + kSecond, flight(now, now + kSecond, far, orbit),
               flight(now, now + kSecond, far + Vec3(0.25, 0, 2), orbit + Vec3(0, 0, -1)));
}

TEST(Nasty, C38_ACommonOrbitAtThirtyKilometresASecondIsTheOneMetreASecondProblem) {
  const Nanoseconds now = 1'700'000'000'000'000'000;
  for (const double speed : {0.0, 30000.0}) {
    Watched pair({box(2, 2, 2)}, {sphere(0.5)});
    fallInOrbit(pair, now, speed * Vec3(1, -1, 0.5));
    ASSERT_EQ(pair.story(), "IMPACT CONFIRMED") << pair.list();
    EXPECT_TRUE(holds(pair.events[0], now, 0.5L)) << pair.list();
    EXPECT_LE(widthOf(pair.events[0]), 1e-9) << "the orbit costs no width\n" << pair.list();
  }
}

}  // namespace
}  // namespace nasty

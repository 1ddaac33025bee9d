/// Cases that other solvers are known to get wrong, with the right answer in closed form.
#include <gtest/gtest.h>

#include "test/impact/watched_pair.h"

namespace collision_node::impact {
namespace {

using moving::Corners;
using moving::flight;
using moving::holds;
using moving::kFrame;
using moving::kInAndOut;
using moving::resting;
using moving::Watched;
using oracle::Real;
using Phase = PairState::Phase;

constexpr double kPi = 3.141592653589793;

geometry::PlacedShape point() { return moving::placed(geometry::Point{}); }
geometry::PlacedShape sphere(double radius) { return moving::placed(geometry::Sphere{radius}); }
geometry::PlacedShape box(double x, double y, double z) { return moving::placed(geometry::Box{{x, y, z}}); }

/// b from `from` at `velocity` for one frame, a at rest in the origin.
void fly(Watched& pair, const Vec3& from, const Vec3& velocity, const Vec3& omega = Vec3::Zero(),
         const geometry::Quat& turn = geometry::Quat::Identity()) {
  pair.advance(0, kFrame, resting(), flight(0, kFrame, from, velocity, omega, turn));
}

TEST(CertifiedNasty, AFlyByIsClear) {
  // Gaps of 1e-5 m and 0.5 mm at 66 m a frame.
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

TEST(CertifiedNasty, ASphereFlyByAtTheRounding) {
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

TEST(CertifiedNasty, ABarThatTurns170DegreesHitsABallAt120) {
  Watched pair({box(2, 0.04, 0.04)}, {sphere(0.05)});
  const double turn = 170.0 / 180.0 * kPi, at = 120.0 / 180.0 * kPi, rate = turn / (kFrame * 1e-9);
  pair.advance(0, kFrame, flight(0, kFrame, Vec3::Zero(), Vec3::Zero(), {0, 0, rate}),
               resting({0.8 * std::cos(at), 0.8 * std::sin(at), 0}));
  ASSERT_EQ(pair.story(), kInAndOut) << pair.list();
  EXPECT_TRUE(holds(pair.events[0], 0, (at - std::asin(0.07L / 0.8L)) / rate, 1e-13L)) << pair.list();
  EXPECT_LE(moving::widthOf(pair.events[0]), 1e-9);
}

TEST(CertifiedNasty, AFarPivot) {
  // A rod tip 1 km from its pivot sweeps 1e-3 rad: a point on its arc, off the chord by 0.1 mm, is hit.
  const double reach = 1000.0, turn = 1e-3, rate = turn / (kFrame * 1e-9);
  const auto tip = moving::placed(geometry::Sphere{1e-4}, {reach, 0, 0});
  const Real half = 0.5L * turn;
  // On the arc's middle; the chord passes reach (1 - cos(turn / 2)) = 1.25e-4 m nearer to the pivot.
  const Vec3 target(static_cast<double>(reach * std::cos(half)), static_cast<double>(reach * std::sin(half)),
                    0);
  Watched pair({tip}, {moving::placed(geometry::Sphere{1e-5})});
  const auto turning = flight(0, kFrame, Vec3::Zero(), Vec3::Zero(), {0, 0, rate});
  pair.advance(0, kFrame, turning, resting(target));
  ASSERT_EQ(pair.story(), kInAndOut) << pair.list();
  const Real touch = half - 2 * std::asin(1.1e-4L / (2 * 1000.0L));
  EXPECT_TRUE(holds(pair.events[0], 0, touch / rate, 1e-13L)) << pair.list();

  Watched chord({tip}, {moving::placed(geometry::Sphere{1e-5})});
  chord.advance(0, kFrame, turning, resting(target * static_cast<double>(std::cos(half))));
  EXPECT_EQ(chord.story(), "") << "the chord's middle is not on the path\n" << chord.list();
}

TEST(CertifiedNasty, TrianglesWithoutAreaAreHit) {
  const std::vector<Vec3> line = {{-1, 0, 0}, {1, 0, 0}, {0.25, 0, 0}};
  Watched needle({moving::mesh(line, {{0, 1, 2}})}, {sphere(0.01)});
  fly(needle, {0.3, 0.002, 10}, {0, 0, -2000});
  ASSERT_EQ(needle.story(), kInAndOut) << needle.list();
  EXPECT_TRUE(holds(needle.events[0], 0, (10 - std::sqrt(1e-4L - 4e-6L)) / 2000, 1e-14L)) << needle.list();
  EXPECT_TRUE(needle.events[0].normal.allFinite());
  Watched past({moving::mesh(line, {{0, 1, 2}})}, {sphere(0.01)});
  fly(past, {0.3, 0.0101, 10}, {0, 0, -2000});
  EXPECT_EQ(past.story(), "") << past.list();

  Watched dot({moving::mesh({{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}, {{0, 1, 2}})}, {sphere(0.01)});
  fly(dot, {0.002, 0, 10}, {0, 0, -2000});
  EXPECT_EQ(dot.story(), kInAndOut) << dot.list();

  // A sliver of 1e-9 rad and a needle in an otherwise closed box.
  const double top = 1 + 1e-9;
  Watched sliver({moving::mesh({{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, {1, top, 0}},
                               {{0, 1, 2}, {0, 2, 3}, {3, 2, 4}, {0, 3, 0}})},
                 {moving::boxMesh({0.05, 0.05, 0.05})});
  fly(sliver, {0.3, 1.0, 10}, {0, 0, -2000}, {3, 2, 1});
  ASSERT_EQ(sliver.story(), kInAndOut) << sliver.list();
  EXPECT_FALSE(std::isnan(sliver.events[0].position_error));
}

TEST(CertifiedNasty, DuplicatesWoundBothWaysChangeNothing) {
  const std::vector<Vec3> corners = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  const std::vector<Corners> once = {{0, 1, 2}, {0, 2, 3}};
  const std::vector<Corners> thrice = {{0, 1, 2}, {0, 2, 3}, {0, 2, 1}, {0, 3, 2}, {0, 1, 2}};
  for (const bool from_below : {false, true}) {
    std::vector<PairEvent> all[2];
    for (const bool repeated : {false, true}) {
      Watched pair({moving::mesh(corners, repeated ? thrice : once)}, {sphere(0.05)});
      const double up = from_below ? -1.0 : 1.0;
      fly(pair, {0.3, 0.1, 10 * up}, {0, 0, -2000 * up});
      ASSERT_EQ(pair.story(), kInAndOut) << pair.list();
      EXPECT_TRUE(holds(pair.events[0], 0, 9.95L / 2000)) << pair.list();
      EXPECT_NEAR(pair.events[0].normal.z(), up, 1e-9 + pair.events[0].normal_error)
          << "from a to b, back faces too";
      EXPECT_LE(moving::widthOf(pair.events[0]), 1e-9);
    }
  }
}

TEST(CertifiedNasty, APointThroughDuplicatesIsOneImpact) {
  const std::vector<Corners> twice = {{0, 1, 2}, {0, 2, 1}};
  Watched pair({moving::mesh({{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}}, twice)}, {point()});
  fly(pair, {0.05, 0.1, 10}, {0, 0, -2000});
  EXPECT_EQ(pair.story(), kInAndOut) << pair.list();
}

TEST(CertifiedNasty, VertexAgainstVertexHeadOn) {
  // Two octahedra, tip to tip at 2000 m/s: impact, an honest cone of normals, a small ball.
  const std::vector<Vec3> tips = {{0.1, 0, 0},  {-0.1, 0, 0}, {0, 0.1, 0},
                                  {0, -0.1, 0}, {0, 0, 0.1},  {0, 0, -0.1}};
  const std::vector<Corners> faces = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                                      {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  Watched pair({moving::mesh(tips, faces)}, {moving::mesh(tips, faces)});
  fly(pair, {0, 0, 10}, {0, 0, -2000});
  ASSERT_EQ(pair.story(), kInAndOut) << pair.list();
  const PairEvent& e = pair.events[0];
  EXPECT_TRUE(holds(e, 0, 9.8L / 2000)) << pair.list();
  EXPECT_LE((e.position - Vec3(0, 0, 0.1)).norm(), e.position_error);
  EXPECT_LE(e.position_error, 1e-5) << pair.list();
  EXPECT_GE(e.normal_error, 0.6) << "every normal between the two tips' cones is one\n" << pair.list();
}

TEST(CertifiedNasty, AFallInThePlaneOfAFaceHitsItsEdge) {
  Watched pair({moving::sheet(1)}, {sphere(0.01)});
  fly(pair, {-10, 0.3, 0}, {2000, 0, 0});
  ASSERT_EQ(pair.story(), kInAndOut) << pair.list();
  EXPECT_TRUE(holds(pair.events[0], 0, 8.99L / 2000)) << pair.list();
  EXPECT_NEAR(pair.events[0].normal.x(), -1.0, 1e-9 + pair.events[0].normal_error) << pair.list();
  EXPECT_LT(pair.events[0].position_error, 1e-3);
}

TEST(CertifiedNasty, AScrewAdvancesByItsPathAlone) {
  // A drill on its own axis: the spin changes nothing. 1e5 rad/s is 3333 rad in the frame.
  for (const double rate : {0.0, 300.0, 1e5}) {
    Watched pair({box(2, 2, 2)}, {moving::placed(geometry::Cylinder{0.02, 0.5})});
    fly(pair, {0.1, 0.2, 2}, {0, 0, -30}, {0, 0, rate});
    ASSERT_FALSE(pair.events.empty()) << "rate " << rate;
    EXPECT_EQ(pair.events[0].kind, Kind::kImpact);
    EXPECT_TRUE(holds(pair.events[0], 0, 0.75L / 30)) << "rate " << rate << '\n' << pair.list();
    EXPECT_LE(moving::widthOf(pair.events[0]), 1e-8) << "rate " << rate << '\n' << pair.list();
    EXPECT_EQ(pair.events[0].certificate, Certificate::kConfirmed) << "rate " << rate << '\n' << pair.list();
    EXPECT_EQ(pair.count(Kind::kImpact), 1) << pair.list();
  }
}

TEST(CertifiedNasty, APathThatLoopsThroughTheTargetIsHit) {
  // The chord passes 3 m above; the cubic dips to 0.25 h^3-scaled depth in between.
  Watched pair({box(2, 2, 2)}, {sphere(0.05)});
  auto m = flight(0, kFrame, {-20, 0.3, 4}, {1200, 0, 0});
  const double h = kFrame * 1e-9;
  m.c[1].z() = -16.0 / h;  // z = 4 - 16 u + 16 u^2, u = t / h: lowest at u = 1/2, z = 0
  m.c[2].z() = 16.0 / (h * h);
  m.c[1].x() = 40.0 / h;
  pair.advance(0, kFrame, resting(), m);
  // It meets the side x = -1.05 at u = 0.47375, where z = 0.011.
  ASSERT_EQ(pair.story(), kInAndOut) << pair.list();
  EXPECT_TRUE(holds(pair.events[0], 0, (18.95L / 40) * static_cast<Real>(kFrame) * 1e-9L, 1e-14L))
      << pair.list();
}

TEST(CertifiedNasty, StampsOneNanosecondApart) {
  // 2000 m/s moves 2 micrometres: hit if the jump crosses.
  Watched hit({moving::sheet(1)}, {sphere(1e-7)});
  hit.advance(5, 6, resting(), flight(5, 6, {0.3, 0.1, 1e-6}, {0, 0, -2000}));
  EXPECT_EQ(hit.story(), kInAndOut) << hit.list();
  Watched miss({moving::sheet(1)}, {sphere(1e-7)});
  miss.advance(5, 6, resting(), flight(5, 6, {0.3, 0.1, 3e-6}, {0, 0, -2000}));
  EXPECT_EQ(miss.story(), "") << miss.list();
}

/// A sphere falls on a box at 1 m/s, both on the same orbit.
void fallInOrbit(Watched& pair, Nanoseconds now, const Vec3& orbit) {
  constexpr Nanoseconds kSecond = 1'000'000'000;
  const Vec3 far = Vec3::Constant(0x1p22);
  pair.advance(now, now + kSecond, flight(now, now + kSecond, far, orbit),
               flight(now, now + kSecond, far + Vec3(0.25, 0, 2), orbit + Vec3(0, 0, -1)));
}

TEST(CertifiedNasty, ACommonOrbitIsTheOneMetreASecondProblem) {
  const Nanoseconds now = 1'700'000'000'000'000'000;
  for (const double speed : {0.0, 30000.0}) {
    Watched pair({box(2, 2, 2)}, {sphere(0.5)});
    fallInOrbit(pair, now, speed * Vec3(1, -1, 0.5));
    ASSERT_EQ(pair.story(), "IMPACT CONFIRMED") << pair.list();
    EXPECT_TRUE(holds(pair.events[0], now, 0.5L)) << pair.list();
    EXPECT_LE(moving::widthOf(pair.events[0]), 1e-8) << pair.list();
  }
}

TEST(CertifiedNasty, ACommonOrbitCostsNoWidth) {
  Watched pair({box(2, 2, 2)}, {sphere(0.5)});
  fallInOrbit(pair, 0, 30000.0 * Vec3(1, -1, 0.5));
  ASSERT_EQ(pair.story(), "IMPACT CONFIRMED") << pair.list();
  EXPECT_LE(moving::widthOf(pair.events[0]), 1e-9) << pair.list();
}

TEST(CertifiedNasty, NoRelativeMotionCostsNothing) {
  Watched apart({box(2, 2, 2)}, {box(1, 1, 1)}), overlap({box(2, 2, 2)}, {box(1, 1, 1)});
  for (int i = 0; i < 3; ++i) {
    const Nanoseconds from = i * kFrame, to = from + kFrame;
    const PieceOutcome outcome = apart.advance(from, to, resting(), resting({0, 0, 1.6}));
    EXPECT_LT(outcome.node_tests, 20u);
    overlap.advance(from, to, resting(), resting({0.1, 0.2, 1.4}));
  }
  EXPECT_EQ(apart.story(), "");
  EXPECT_EQ(overlap.story(), "INITIAL_OVERLAP CONFIRMED") << overlap.list();
}

}  // namespace
}  // namespace collision_node::impact

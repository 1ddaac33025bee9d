/// A spinning body stays in its shell; what the shell does not meet costs no turns.
#include <gtest/gtest.h>

#include "collision_node/impact/walk/revolution_shell.h"
#include "collision_node/impact/walk/search.h"
#include "test/impact/fuzz_object.h"
#include "test/impact/watched_pair.h"

namespace collision_node::impact {
namespace {

using moving::flight;
using moving::kFrame;
using moving::resting;
using moving::Watched;
using oracle::Real;
using oracle::V3;

constexpr std::uint64_t kSeed = 530;
constexpr double kTurns = 2 * M_PI / 0.033333333;  ///< [rad/s] per turn in a frame

TEST(RevolutionShell, HoldsEveryPointOfTheBodyAtEveryAngle) {
  for (int i = 0; i < 400; ++i) {
    fuzz::Random random(kSeed, i);
    const auto kind = static_cast<fuzz::ShapeKind>(random.below(fuzz::kShapeKinds));
    const fuzz::Object object = fuzz::makeObject(random, kind, random.decade(-3, 3));
    const Body body(object.shapes);
    const Vec3 axis = random.direction();
    const Revolution r = revolve(body, axis);
    const V3 u = (1 / norm(oracle::exact(axis))) * oracle::exact(axis);
    for (const oracle::Part& part : oracle::makeModel(object.shapes).parts) {
      const auto holds = [&](const V3& p) {
        const Real z = dot(p, u), rho = norm(p - z * u);
        EXPECT_LE(z, r.highest) << object.kind << " case " << i << " seed " << kSeed;
        EXPECT_GE(z, r.lowest) << object.kind << " case " << i << " seed " << kSeed;
        EXPECT_LE(rho, r.radius) << object.kind << " case " << i << " seed " << kSeed;
      };
      for (int k = 0; k < 40; ++k) {
        const V3 way = oracle::exact(random.direction());
        for (int v = 0; v < part.count; ++v) holds(part.vertex[v] + part.radius * way);
        if (part.count == 0) holds(oracle::supportOfCylinder(part.cylinder, way) + part.radius * way);
      }
    }
  }
}

TEST(RevolutionShell, OfALargeMeshLooksAtFewNodesAndStillHoldsIt) {
  const moving::Shapes ring = {moving::torus(1.0, 0.2, 100, 60)};
  const Body body(ring);
  const Revolution r = revolve(body, Vec3::UnitZ());
  EXPECT_GE(r.radius, 1.2);
  EXPECT_GE(r.highest, 0.2 * std::sin(M_PI / 2) * 0.999);
  EXPECT_LT(r.radius, 1.4);
}

TEST(RevolutionShell, ACylinderMadeAnotherOneIsAsGoodAsANewOne) {
  const auto cylinder = [](double radius, double length, double z) {
    return Body({moving::placed(geometry::Cylinder{radius, length}, {0, 0, z})});
  };
  Body kept = cylinder(1.0, 1.0, 0.0);
  for (int i = 0; i < 200; ++i) {
    fuzz::Random random(kSeed + 1, i);
    const double radius = random.decade(-3, 3), length = random.decade(-3, 3), z = random.in(-1, 1) * length;
    kept.resize({radius, length}, {0, 0, z});
    const Body made = cylinder(radius, length, z);
    const Element &k = kept.primitive(0), &m = made.primitive(0);
    EXPECT_TRUE(k.centre == m.centre && k.axis == m.axis && k.rim_radius == m.rim_radius &&
                k.half_length == m.half_length && k.frame->centre == m.frame->centre);
    EXPECT_EQ(kept.reach(), made.reach());
    EXPECT_NEAR(kept.radius(), made.radius(), 1e-6 * made.radius());
    // Its box holds the cylinder, and hardly more.
    const Vec3 half(radius, radius, 0.5 * length), away = (kept.bvh().centre(0) - k.centre).cwiseAbs();
    EXPECT_TRUE(((kept.bvh().half(0) - away - half).array() >= 0.0).all()) << i;
    EXPECT_TRUE(((kept.bvh().half(0) - half).array() <= 1e-6 * half.maxCoeff()).all()) << i;
    EXPECT_GE(kept.bvh()[0].reach, std::hypot(radius, 0.5 * length + std::abs(z)));
  }
}

/// A blade in the plane z = 0 of half length 1 m, `turns` a frame, its shell `gap` from a wall at rest.
struct Blade {
  Watched pair;
  PieceOutcome outcome;

  Blade(double gap, double turns)
      : pair({moving::placed(geometry::Box{{2.0, 0.1, 0.02}})},
             {moving::placed(geometry::Box{{0.5, 20, 20}})}) {
    const double radius = std::hypot(1.0, 0.05);
    outcome = pair.advance(0, kFrame, flight(0, kFrame, Vec3::Zero(), Vec3::Zero(), {0, 0, turns * kTurns}),
                           resting({radius + gap + 0.25, 0, 0}));
  }
};

TEST(RevolutionShell, ABladeAMicrometreFromAWallForManyTurnsIsClearInAFewTests) {
  for (const double turns : {5.0, 530.0, 33000.0}) {
    const Blade blade(1e-6, turns);
    EXPECT_TRUE(blade.pair.events.empty()) << blade.pair.list();
    EXPECT_EQ(blade.outcome.answer, Answer::kClear);
    EXPECT_LE(blade.outcome.node_tests, 200u) << turns << " turns";
  }
}

TEST(RevolutionShell, ABladeThatReachesTheWallHitsIt) {
  for (const double turns : {5.0, 530.0}) {
    const Blade blade(-1e-6, turns);
    ASSERT_FALSE(blade.pair.events.empty());
    EXPECT_EQ(blade.pair.events[0].kind, Kind::kImpact);
    EXPECT_EQ(blade.pair.events[0].certificate, Certificate::kConfirmed) << blade.pair.list();
  }
}

TEST(RevolutionShell, APassCostsTheTurnsWithinReachOnly) {
  // 100 m in a frame past a spinning blade, 0.3 m of it within reach, at a height that just clears the blade.
  const moving::Shapes blade = {moving::placed(geometry::Box{{2.0, 0.1, 0.02}})};
  const moving::Shapes ball = {moving::placed(geometry::Sphere{0.05})};
  Watched pair(blade, ball);
  const auto spinning = flight(0, kFrame, Vec3::Zero(), Vec3::Zero(), {0, 0, 530 * kTurns});
  const auto outcome =
      pair.advance(0, kFrame, spinning, flight(0, kFrame, {0, 0.9, -50}, {0, 0, 100 / 0.033333333}));
  std::printf("node tests %lu\n", static_cast<unsigned long>(outcome.node_tests));
  EXPECT_LE(outcome.node_tests, 4000u);
}

TEST(RevolutionShell, ANearMissInReachForFiveHundredTurnsIsClearOrUndecidedInBoundedWork) {
  // Two blades whose shells overlap and whose turns interlock: nothing but the turns themselves keeps them
  // apart.
  const moving::Shapes blade = {moving::placed(geometry::Box{{2.0, 0.02, 0.02}})};
  const double rate = 500 * kTurns;
  PairOptions options;
  options.node_budget = 200000;
  Watched pair(blade, blade, options);
  const auto a = flight(0, kFrame, Vec3::Zero(), Vec3::Zero(), {0, 0, rate});
  const auto b = flight(0, kFrame, {1.5, 0, 0}, Vec3::Zero(), {0, 0, -rate},
                        geometry::Quat(Eigen::AngleAxisd(M_PI / 2, Vec3::UnitZ())));
  const auto outcome = pair.advance(0, kFrame, a, b);
  std::printf("answer %d, node tests %lu\n", static_cast<int>(outcome.answer),
              static_cast<unsigned long>(outcome.node_tests));
  EXPECT_LE(outcome.node_tests, options.node_budget + 5000);
  for (const PairEvent& e : pair.events) EXPECT_NE(e.certificate, Certificate::kConfirmed) << pair.list();
  EXPECT_TRUE(outcome.answer == Answer::kClear || outcome.budget_met);
}

TEST(RevolutionShell, MillionsOfHalvedTimesAreABudgetToo) {
  // The same with meshes, whose turns are walked in halves of time that are kept.
  const moving::Shapes blade = {moving::boxMesh({1.0, 0.01, 0.01})};
  for (const double turns : {100.0, 5e3}) {
    Watched pair(blade, blade);
    const auto a = flight(0, kFrame, Vec3::Zero(), Vec3::Zero(), {0, 0, turns * kTurns});
    const auto b = flight(0, kFrame, {1.5, 0, 0}, Vec3::Zero(), {0, 0, -turns * kTurns},
                          geometry::Quat(Eigen::AngleAxisd(M_PI / 2, Vec3::UnitZ())));
    const auto outcome = pair.advance(0, kFrame, a, b);
    EXPECT_LE(outcome.subdivisions, 1u << 19);
    EXPECT_EQ(outcome.answer, turns > 1e3 ? Answer::kUndecided : Answer::kClear) << pair.list();
    EXPECT_EQ(outcome.budget_met, turns > 1e3) << outcome.subdivisions;
  }
}

TEST(RevolutionShell, AShellSpendsNoMoreThanTheQuerysBudget) {
  // A rod turns a millimetre from the inside of a ring that turns slowly: a shell of much work.
  PairOptions options;
  options.node_budget = 1000;
  Watched pair({moving::placed(geometry::Box{{1.595, 1e-5, 1e-5}})}, {moving::torus(1.0, 0.2, 100, 60)},
               options);
  const auto outcome =
      pair.advance(0, kFrame, flight(0, kFrame, Vec3::Zero(), Vec3::Zero(), {0, 0, 1000 * kTurns}),
                   flight(0, kFrame, Vec3::Zero(), Vec3::Zero(), {0, 0, 90}));
  EXPECT_LE(outcome.node_tests, 3 * options.node_budget);
  EXPECT_TRUE(outcome.budget_met);
  EXPECT_EQ(outcome.answer, Answer::kUndecided);
}

}  // namespace
}  // namespace collision_node::impact

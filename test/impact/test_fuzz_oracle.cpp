/// The oracle against closed forms and against itself by a second method: a wrong oracle would prove nothing.
#include <gtest/gtest.h>

#include "test/impact/fuzz_case.h"
#include "test/impact/fuzz_shapes.h"

namespace {

namespace g = collision_node::geometry;
using collision_node::motion::RigidMotion;
using g::Vec3;
using oracle::FirstTouch;
using oracle::Gap;
using oracle::Pair;
using oracle::Real;
using oracle::V3;

constexpr std::uint64_t kSeed = 20240711;

std::vector<g::PlacedShape> one(g::Shape shape) { return {{std::move(shape), {}, "test"}}; }

RigidMotion moving(const Vec3& from, const Vec3& velocity, const Vec3& omega = Vec3::Zero()) {
  RigidMotion m;
  m.start_ns = 0, m.end_ns = 1000000000;
  m.c[0] = from, m.c[1] = velocity, m.omega = omega;
  return m;
}

Pair pairOf(g::Shape a, g::Shape b, const RigidMotion& ma, const RigidMotion& mb) {
  return oracle::makePair(one(std::move(a)), one(std::move(b)), ma, mb, 0, 1000000000);
}

void expectTouchAt(const Pair& pair, Real expected, Real tolerance) {
  const FirstTouch touch = pair.firstTouch(0, 1);
  ASSERT_TRUE(touch.found);
  EXPECT_TRUE(touch.verified);
  EXPECT_LE(touch.lo, expected + 1e-18L);
  EXPECT_GE(touch.hi, expected - tolerance);
  EXPECT_LE(touch.hi - touch.lo, tolerance);
}

TEST(FuzzOracle, TwoSpheresMeetAtTheRootOfTheQuadratic) {
  const Real along = 10 - std::sqrt(1.5L * 1.5L - 0.25L);
  expectTouchAt(
      pairOf(g::Sphere{1.0}, g::Sphere{0.5}, moving({0, 0, 0}, {0, 0, 0}), moving({-10, 0.5, 0}, {20, 0, 0})),
      along / 20, 1e-16L);
}

TEST(FuzzOracle, AWorldOffsetCostsNothing) {
  const Real along = 10 - std::sqrt(1.5L * 1.5L - 0.25L);
  const Vec3 far(1e8, -3e7, 5e7);
  expectTouchAt(pairOf(g::Sphere{1.0}, g::Sphere{0.5}, moving(far, {2000, 0, 0}),
                       moving(far + Vec3(-10, 0.5, 0), {2020, 0, 0})),
                along / 20, 1e-16L);
}

TEST(FuzzOracle, ARodsTipMeetsAPlateWhereTheSineSays) {
  // The rod's tip, 2 m from its centre, swings up through z = h: 2 sin(theta) = h.
  const Real h = 1.0;
  auto plate = std::make_shared<g::TriangleMesh>();
  plate->vertices = {{-50, -50, 1}, {50, -50, 1}, {0, 80, 1}};
  plate->triangles = {{0, 1, 2}};
  RigidMotion rod = moving({0, 0, 0}, {0, 0, 0}, {0, 3, 0});
  rod.q0 = g::Quat(Eigen::AngleAxisd(M_PI / 2, Vec3::UnitY()));  // its axis along x to double precision
  const Pair pair = pairOf(g::Mesh{plate}, g::Capsule{0.25, 4.0}, moving({0, 0, 0}, {0, 0, 0}), rod);
  // The cap adds its radius: the tip's height has to reach h - 0.25. The double q0 is off a right angle by
  // `tilt`.
  const Real x = rod.q0.y(), w = rod.q0.w();
  const Real start = 2 * std::atan2(x, w) - std::acos(-1.0L) / 2;
  expectTouchAt(pair, (std::asin((h - 0.25L) / 2) - std::abs(start)) / 3, 2e-15L);
}

TEST(FuzzOracle, ABoxDropsFlatOnABox) {
  expectTouchAt(pairOf(g::Box{{2, 2, 2}}, g::Box{{1, 1, 0.5}}, moving({0, 0, 0}, {0, 0, 0}),
                       moving({0.3, 0.2, 3}, {0, 0, -8})),
                (3 - 1.25L) / 8, 1e-15L);
}

TEST(FuzzOracle, ACylinderFallsOnItsRimOnItsSideAndOnItsFace) {
  const g::Box floor{{100, 100, 2}};
  const RigidMotion rest = moving({0, 0, 0}, {0, 0, 0});
  RigidMotion falling = moving({0.1, 0.3, 6}, {0, 0, -6});
  expectTouchAt(pairOf(floor, g::Cylinder{0.5, 2.0}, rest, falling), (5 - 1.0L) / 6, 1e-15L);
  falling.q0 = g::Quat(std::sqrt(0.5), 0, std::sqrt(0.5), 0);
  expectTouchAt(pairOf(floor, g::Cylinder{0.5, 2.0}, rest, falling), (5 - 0.5L) / 6, 1e-15L);
  falling.q0 = g::Quat(0.8, 0.6, 0,
                       0);  // turned by asin(0.96) about x: the rim's lowest point is sin R + cos L/2 under
  expectTouchAt(pairOf(floor, g::Cylinder{0.5, 2.0}, rest, falling), (5 - (0.96L * 0.5L + 0.28L * 1.0L)) / 6,
                1e-15L);
}

TEST(FuzzOracle, TwoCylindersMeetSideOnSideAndRimOnSide) {
  RigidMotion lying = moving({0.2, 5, 0.1}, {0, -5, 0});
  lying.q0 = g::Quat(0.8, 0, 0.6, 0);  // both axes perpendicular to y: crossed sides
  expectTouchAt(pairOf(g::Cylinder{0.5, 3.0}, g::Cylinder{0.25, 2.0}, moving({0, 0, 0}, {0, 0, 0}), lying),
                (5 - 0.75L) / 5, 1e-11L);
  RigidMotion rim = moving({0, 5, 0}, {0, -5, 0});
  rim.q0 = g::Quat(0.8, 0.6, 0, 0);  // axis in the plane y, z
  expectTouchAt(pairOf(g::Cylinder{0.5, 30.0}, g::Cylinder{0.25, 2.0}, moving({0, 0, 0}, {0, 0, 0}), rim),
                (5 - 0.5L - (0.96L * 1.0L + 0.28L * 0.25L)) / 5, 1e-11L);
}

TEST(FuzzOracle, APointCrossesASheetAtOneInstant) {
  auto sheet = std::make_shared<g::TriangleMesh>();
  sheet->vertices = {{-1, -1, 0}, {1, -1, 0.1}, {0, 1, 0.2}};
  sheet->triangles = {{0, 1, 2}};
  const Pair pair =
      pairOf(g::Mesh{sheet}, g::Point{}, moving({0, 0, 0}, {0, 0, 0}), moving({0, 0, 3}, {0, 0, -7}));
  const Real height =
      (0.0L + static_cast<Real>(0.1)) / 4 + static_cast<Real>(0.2) / 2;  // barycentrics 1/4, 1/4, 1/2
  expectTouchAt(pair, (3 - height) / 7, 1e-15L);
  EXPECT_GT(pair.distance(0.5), 0.1);
}

TEST(FuzzOracle, InsideASolidIsTouchingAndInsideASurfaceIsNot) {
  fuzz::Random random(kSeed, 0);
  const RigidMotion rest = moving({0, 0, 0}, {0, 0, 0});
  EXPECT_EQ(pairOf(g::Box{{2, 2, 2}}, g::Point{}, rest, moving({0.3, 0.2, 0.1}, {0, 0, 0})).distance(0), 0);
  EXPECT_GT(pairOf(g::Box{{2, 2, 2}}, g::Point{}, rest, moving({0.3, 0.2, 1.1}, {0, 0, 0})).distance(0), 0);
  for (int i = 0; i < 20; ++i) {
    const g::Shape closed = fuzz::makeShape(random, fuzz::ShapeKind::kClosedMesh, 1.0, 0.0);
    EXPECT_TRUE(std::get<g::Mesh>(closed).mesh->solid) << "seed " << kSeed << " mesh " << i;
    auto shell = std::make_shared<g::TriangleMesh>(*std::get<g::Mesh>(closed).mesh);
    shell->solid = false;
    // A point halfway between a face and the centre of the bounding torus tube is hard to know: step in from
    // a face.
    const auto& f = shell->triangles[0];
    const Vec3 p = shell->vertices[f[0]], q = shell->vertices[f[1]], r = shell->vertices[f[2]];
    const Vec3 n = (q - p).cross(r - p).normalized();
    int inside = 0;
    for (double side : {-1e-4, 1e-4}) {
      const RigidMotion at = moving((p + q + r) / 3 + side * n, {0, 0, 0});
      inside += pairOf(closed, g::Point{}, rest, at).distance(0) == 0;
      EXPECT_GT(pairOf(g::Mesh{shell}, g::Point{}, rest, at).distance(0), 0);
    }
    EXPECT_EQ(inside, 1) << "seed " << kSeed << " mesh " << i;
  }
}

/// Two methods that share no step: features against a descent on support functions with a duality gap.
TEST(FuzzOracle, FeatureDistancesLieInsideTheDualityGap) {
  fuzz::Random random(kSeed, 1);
  const auto randomPoint = [&](Real s) {
    return s * V3{random.in(-1, 1), random.in(-1, 1), random.in(-1, 1)};
  };
  const auto extreme = [](const V3* v, int n) {
    return [v, n](const V3& d) {
      return *std::max_element(v, v + n, [&](const V3& x, const V3& y) { return dot(x, d) < dot(y, d); });
    };
  };
  int apart = 0;
  for (int i = 0; i < 3000; ++i) {
    const int ns = 1 + random.below(3), nt = 1 + random.below(3);
    const V3 shift = randomPoint(2);
    V3 s[3], t[3];
    for (V3& p : s) p = randomPoint(1);
    for (V3& p : t) p = shift + randomPoint(1);
    const oracle::Cylinder c{shift, (1 / norm(t[0] - shift)) * (t[0] - shift), random.in(0.1, 1),
                             random.in(0.1, 1)};
    const Gap flat = oracle::flatGap(s, ns, t, nt);
    const Gap flat2 = oracle::convexGap(extreme(s, ns), extreme(t, nt), s[0] - t[0], 6);
    const Gap round = oracle::flatCylinder(s, ns, c);
    const Gap round2 = oracle::convexGap(
        extreme(s, ns), [&](const V3& d) { return supportOfCylinder(c, d); }, s[0] - shift, 6);
    for (const auto& [feature, descent] : {std::pair{flat, flat2}, std::pair{round, round2}}) {
      EXPECT_LE(feature.upper, descent.upper + 1e-17L) << "seed " << kSeed << " pair " << i;
      EXPECT_GE(feature.upper, descent.lower - 1e-17L) << "seed " << kSeed << " pair " << i;
      EXPECT_LE(descent.upper - descent.lower, 1e-9L) << "seed " << kSeed << " pair " << i;
      apart += feature.upper > 0;
    }
  }
  EXPECT_GT(apart, 3000);
}

TEST(FuzzOracle, CylindersAgreeWithTheirFineTessellation) {
  fuzz::Random random(kSeed, 2);
  for (int i = 0; i < 40; ++i) {
    const auto cylinder = [&](Real away) {
      const auto d = random.direction(), e = random.direction();
      return oracle::Cylinder{away * oracle::exact(d), oracle::exact(e), random.in(0.2, 1),
                              random.in(0.2, 1)};
    };
    oracle::Cylinder a = cylinder(0), b = cylinder(random.in(0.5, 4));
    a.axis = (1 / norm(a.axis)) * a.axis, b.axis = (1 / norm(b.axis)) * b.axis;
    const Gap gap = oracle::cylinderCylinder(a, b);
    EXPECT_LE(gap.upper - gap.lower, 1e-12L) << "seed " << kSeed << " pair " << i;
    // The side lines of b, each a segment against the exact cylinder a: never nearer, and nearly as near.
    V3 u = cross(b.axis, V3{1, 0, 0});
    if (norm(u) < 0.1L) u = cross(b.axis, V3{0, 1, 0});
    u = (1 / norm(u)) * u;
    const V3 v = cross(b.axis, u);
    Real nearest = 1e9;
    for (int k = 0; k < 1000; ++k) {
      const Real angle = 2 * std::acos(-1.0L) * k / 1000;
      const V3 rim = b.centre + b.radius * (std::cos(angle) * u + std::sin(angle) * v);
      nearest =
          std::min(nearest, oracle::segmentCylinder(rim - b.half * b.axis, rim + b.half * b.axis, a).upper);
      const V3 cap0 = b.centre - b.half * b.axis, cap1 = b.centre + b.half * b.axis;
      nearest = std::min(nearest, oracle::segmentCylinder(rim - b.half * b.axis, cap0, a).upper);
      nearest = std::min(nearest, oracle::segmentCylinder(rim + b.half * b.axis, cap1, a).upper);
    }
    EXPECT_LE(gap.lower, nearest + 1e-15L) << "seed " << kSeed << " pair " << i;
    EXPECT_GE(gap.upper, nearest - 4e-3L) << "seed " << kSeed << " pair " << i;
  }
}

TEST(FuzzOracle, TheMarchIsNeverLate) {
  // Whatever the march says, dense sampling finds nothing earlier.
  for (int i = 0; i < 60; ++i) {
    const fuzz::Case c = fuzz::makeCase(kSeed, i);
    const Pair pair = c.pair();
    const FirstTouch touch = pair.firstTouch(0, pair.duration());
    ASSERT_FALSE(touch.gave_up) << c.describe();
    if (touch.found && touch.lo == 0) continue;  // overlap at the start
    const Real end = touch.found ? touch.lo : pair.duration();
    for (int k = 0; k < 60; ++k) EXPECT_GT(pair.distance(end * (k + 0.5L) / 60), 0) << c.describe();
  }
}

}  // namespace

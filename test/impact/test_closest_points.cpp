/// closest_points.h: "a point or a segment against a point, a segment, a cylinder or a box", against the
/// oracle's closest points in extended precision; and the axis "with the rate at which they slide over both
/// cores".
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <limits>

#include "collision_node/impact/convex/closest_points.h"
#include "collision_node/impact/convex/gjk.h"
#include "test/impact/moving_pair.h"

namespace collision_node::impact {
namespace {

using moving::Random;
using oracle::Real;

constexpr std::uint64_t kSeed = 78001;

geometry::PlacedShape shapeOf(int kind, Random& random) {
  const auto length = [&] { return random.decade(-2, 0.3); };
  geometry::PlacedShape out;
  out.source = "random";
  out.origin = {moving::randomVec(random, random.chance(0.5) ? 0.0 : 0.5), random.orientation()};
  switch (kind) {
    case 0:
      out.shape = geometry::Sphere{length()};
      break;
    case 1:
    case 2:
      out.shape = geometry::Capsule{length(), length()};
      break;
    case 3:
      out.shape = geometry::Cylinder{length(), length()};
      break;
    default:
      out.shape = geometry::Box{{length(), length(), length()}};
  }
  return out;
}

geometry::PlacedShape randomShape(Random& random, int kinds) {
  return shapeOf(static_cast<int>(random.below(kinds)), random);
}

/// The distance of two cores. A box is its twelve triangles here: the distance from its surface.
Real exactDistance(const Element& a, const oracle::Frame& fa, const Element& b, const oracle::Frame& fb) {
  constexpr int kFaces[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                 {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  const auto partsOf = [&](const Element& e, const oracle::Frame& frame) {
    std::vector<oracle::Part> parts;
    if (e.count != 8) {
      Element core = e;
      core.radius = 0.0;
      parts.push_back(oracle::placed(moving::exactPart(core), frame));
      return parts;
    }
    for (const auto& face : kFaces) {
      const Vec3 corners[3] = {e.vertices[face[0]], e.vertices[face[1]], e.vertices[face[2]]};
      Element triangle;
      triangle.vertices = corners;
      triangle.count = 3;
      parts.push_back(oracle::placed(moving::exactPart(triangle), frame));
    }
    return parts;
  };
  Real least = std::numeric_limits<Real>::infinity();
  for (const oracle::Part& x : partsOf(a, fa)) {
    for (const oracle::Part& y : partsOf(b, fb)) least = std::min(least, oracle::partGap(x, y).upper);
  }
  return least;
}

/// On a random piece of a second, in either order.
moving::Pair randomPair(Random& random, const geometry::PlacedShape& first,
                        const geometry::PlacedShape& second) {
  constexpr motion::Nanoseconds kSecond = 1000000000;
  Piece piece;
  piece.end_ns = kSecond;
  const auto fly = [&] {
    return moving::flight(0, kSecond, moving::randomVec(random, 2.0), moving::randomVec(random, 2.0),
                          3.0 * random.direction(), random.orientation());
  };
  piece.a = fly();
  piece.b = fly();
  return random.chance(0.5) ? moving::Pair({first}, {second}, piece) : moving::Pair({second}, {first}, piece);
}

/// One of the pairs of the table.
moving::Pair randomPair(Random& random) {
  return randomPair(random, randomShape(random, 3), randomShape(random, 5));
}

TEST(ClosestPoints, AreAsCloseAsTheOracleSays) {
  Random random(kSeed, 0);
  Real worst = 0;
  int apart = 0;
  for (int i = 0; i < 3000; ++i) {
    const moving::Pair pair = randomPair(random);
    Vec3 buffer[3];
    const Element a = pair.body_a.element(0, buffer), b = pair.body_b.element(0, buffer);
    ASSERT_TRUE(SlidingPoints::fit(a, b));
    SlidingPoints points(a, b);  // asked again and again: each begins where the last one ended
    for (const double t : {0.1, 0.4, 0.45, 0.9}) {
      SCOPED_TRACE(std::to_string(i) + " at " + std::to_string(t));
      const Instant now = pair.solver.at(t);
      const Cores cores(now, a, b);
      points.find(cores);
      const Closest found = points.closest(cores);
      EXPECT_EQ(found.overlap, points.distance() == 0.0);
      Vec3 blend = Vec3::Zero();
      for (int k = 0; k < found.count; ++k) {
        const SupportPair& p = found.point[k];
        EXPECT_NEAR((cores.b.place(p.local_b) - cores.a.place(p.local_a) - p.w).norm(), 0.0, 1e-13);
        blend += found.weight[k] * p.w;
      }
      EXPECT_NEAR((blend - found.v).norm(), 0.0, 1e-13);
      EXPECT_NEAR(found.v.norm(), points.distance(), 1e-13);
      if (found.overlap)
        continue;  // inside a box or a cylinder the oracle's distance is one from the surface
      ++apart;
      const oracle::Frame fa = pair.exact.pathA().at(t), fb = pair.exact.pathB().at(t);
      const Real error = std::abs(points.distance() - exactDistance(a, fa, b, fb));
      worst = std::max(worst, error);
      EXPECT_LT(error, 1e-13L);
    }
  }
  EXPECT_GT(apart, 8000);
  std::printf("%d distances, the worst off by %.3Lg\n", apart, worst);
}

TEST(ClosestPoints, WithoutAClosedFormTheyAreAsClose) {
  Random random(kSeed, 2);
  Real worst = 0;
  int apart = 0, early = 0, early_far = 0;
  for (int i = 0; i < 500; ++i) {
    SCOPED_TRACE(i);
    const int other = random.chance(0.5) ? 4 : 3;
    const moving::Pair pair =
        randomPair(random, shapeOf(4, random), shapeOf(other, random));  // no two cylinders
    Vec3 buffer[3];
    const Element a = pair.body_a.element(0, buffer), b = pair.body_b.element(0, buffer);
    ASSERT_FALSE(SlidingPoints::fit(a, b));
    Closest found;
    for (const double t : {0.3, 0.31, 0.7}) {
      const Instant now = pair.solver.at(t);
      found = closestPoints(Cores(now, a, b), found);
      if (found.overlap) continue;
      ++apart;
      const oracle::Frame fa = pair.exact.pathA().at(t), fb = pair.exact.pathB().at(t);
      const Real exact = exactDistance(a, fa, b, fb), error = std::abs(found.v.norm() - exact);
      worst = std::max(worst, error);
      EXPECT_LT(error, 1e-10L) << "at " << t;
      // Which points will do, and that the search for others ends there.
      const double at = static_cast<double>(exact);
      const auto distance = [&](const GoodEnough& enough) {
        return closestPoints(Cores(now, a, b), Vec3::Zero(), enough).v.norm();
      };
      const double near = distance({1.5 * at}), lossy = distance({0.0, 0.1}),
                   far = distance({0.0, 0.0, 0.5 * at}), far_in_vain = distance({0.0, 0.0, 1.001 * at});
      EXPECT_LE(near, 1.5 * at);
      EXPECT_LE(lossy * (1.0 - 0.1), at + 1e-10);
      EXPECT_LE(far_in_vain, at + 1e-10);
      early += near > at + 1e-6 || lossy > at + 1e-6;
      early_far += far > at + 1e-6;
    }
  }
  EXPECT_GT(apart, 900);
  EXPECT_GT(early, 100);
  EXPECT_GT(early_far, 100);
  std::printf("%d distances, the worst off by %.3Lg\n", apart, worst);
}

TEST(ClosestPoints, TheAxisSlidesWithThem) {
  Random random(kSeed, 1);
  int checked = 0, off = 0;
  for (int i = 0; i < 3000; ++i) {
    const moving::Pair pair = randomPair(random);
    Vec3 buffer[3];
    const Element a = pair.body_a.element(0, buffer), b = pair.body_b.element(0, buffer);
    SlidingPoints points(a, b);
    const auto axisAt = [&](double t) {
      const Instant now = pair.solver.at(t);
      points.find(Cores(now, a, b));
      return points.axis(pair.solver.motion, now);
    };
    const Axis axis = axisAt(0.5);
    if (!axis.valid || points.distance() < 0.1) continue;
    EXPECT_NEAR(axis.direction.norm(), 1.0, 1e-14);
    constexpr double kStep = 1e-6;
    const Axis later = axisAt(0.5 + kStep);
    ++checked;
    // To second order, but for the few that come to another feature just then.
    if ((later.direction - axis.direction - kStep * axis.rate).norm() >
        1e-4 * kStep * (1.0 + axis.rate.norm()))
      ++off;
  }
  EXPECT_GT(checked, 1500);
  EXPECT_LE(off, checked / 100);
  std::printf("%d rates, %d at a change of features\n", checked, off);
}

TEST(ClosestPoints, OnARimTheyAreAsCloseAndSlide) {
  Random random(kSeed, 3);
  int found = 0, off = 0;
  for (int i = 0; i < 1500; ++i) {
    SCOPED_TRACE(i);
    const moving::Pair pair = randomPair(random, shapeOf(3, random), shapeOf(4, random));
    Vec3 buffer[3];
    const Element a = pair.body_a.element(0, buffer), b = pair.body_b.element(0, buffer);
    SlidingPoints points = SlidingPoints::ofCurve(a, b, a.vertices == nullptr);
    constexpr double kTime = 0.5, kStep = 1e-6;
    const Instant now = pair.solver.at(kTime), later = pair.solver.at(kTime + kStep);
    const Cores cores(now, a, b);
    const Vec3 guess = closestPoints(cores, Vec3::Zero()).v;
    if (!(guess.norm() > 0.1) || !points.findOnRim(cores, guess)) continue;
    const Axis axis = points.axis(pair.solver.motion, now);
    ASSERT_TRUE(axis.valid);
    if (cores.gapAlong(axis.direction) < (1.0 - 1e-9) * points.distance()) continue;  // others are closer
    ++found;
    const oracle::Frame fa = pair.exact.pathA().at(kTime), fb = pair.exact.pathB().at(kTime);
    EXPECT_LT(std::abs(points.distance() - exactDistance(a, fa, b, fb)), 1e-12L);
    const Closest closest = points.closest(cores);
    EXPECT_EQ(closest.count, 1);
    EXPECT_NEAR(closest.v.norm(), points.distance(), 1e-13);
    EXPECT_NEAR((closest.point[0].w - closest.v).norm(), 0.0, 1e-13);
    if (!points.findOnRim(Cores(later, a, b), guess)) continue;
    const Axis next = points.axis(pair.solver.motion, later);
    if ((next.direction - axis.direction - kStep * axis.rate).norm() >
        1e-4 * kStep * (1.0 + axis.rate.norm()))
      ++off;
  }
  EXPECT_GT(found, 500);
  EXPECT_LE(off, found / 100);
  std::printf("%d pairs closest on a rim, %d at a change of features\n", found, off);
}

/// The closest vector's length tells its direction only to the root of rounding: a corner a hair beside
/// another one was seen apart by 1e-8 m less than it was.
TEST(ClosestPoints, WhereACornerIsOverACornerTheDirectionIsTold) {
  Random random(kSeed, 4);
  const Body body({moving::placed(geometry::Box{{1.0, 1.0, 1.0}})});
  const Element e = body.primitive(0);
  int apart = 0;
  for (int i = 0; i < 3000; ++i) {
    SCOPED_TRACE(i);
    const geometry::Quat turn = random.orientation();
    const Vec3 low = turn * supportOf(e, turn.conjugate() * Vec3(0.0, 0.0, -1.0));
    const double beside = random.decade(-13, -6), height = random.decade(-5, -0.3);
    const Vec3 at =
        Vec3(0.5, 0.5, 0.5) - low + Vec3(beside * random.in(-1, 1), beside * random.in(-1, 1), height);
    const moving::Pair pair({moving::placed(geometry::Box{{1.0, 1.0, 1.0}})},
                            {moving::placed(geometry::Box{{1.0, 1.0, 1.0}})},
                            {0, 1000, moving::resting(), moving::resting(at, turn)});
    const Instant now = pair.solver.at(0.0);
    const Cores cores(now, e, e);
    const Closest found = closestPoints(cores, Vec3::Zero());
    if (found.overlap) continue;  // tilted across the corner
    ++apart;
    EXPECT_LE(found.v.norm() - cores.gapAlong(found.v.normalized()), 1e-13);
  }
  EXPECT_GT(apart, 2000);
}

/// Proofs of contact take it for a point of the core, however nearly along the axis the direction is.
TEST(ClosestPoints, ACylindersSupportIsAPointOfTheCylinder) {
  Random random(kSeed, 0);
  for (int i = 0; i < 100000; ++i) {
    geometry::PlacedShape shape;
    shape.shape = geometry::Cylinder{1.0, 1.0};
    shape.origin.orientation = random.orientation();
    const Body body({shape});
    const Element& e = body.primitive(0);
    const Vec3 direction = (e.axis + random.decade(-13.0, -1.0) * e.axis.unitOrthogonal()).normalized();
    const Vec3 p = supportOf(e, direction);
    EXPECT_LE(p.dot(e.axis), 0.5 + 4e-15) << i;
    EXPECT_LE((p - p.dot(e.axis) * e.axis).norm(), 1.0 + 4e-15) << i;
  }
}

}  // namespace
}  // namespace collision_node::impact

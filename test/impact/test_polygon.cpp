/// polygon.h: hulls, grown hulls and intersections hold what they say they hold.
#include <gtest/gtest.h>

#include <cmath>

#include "collision_node/impact/polygon.h"
#include "test/impact/fuzz_shapes.h"

namespace collision_node::impact {
namespace {

using fuzz::Random;

constexpr std::uint64_t kSeed = 77004;
constexpr double kTurn = 6.283185307179586;

Vec2 randomPoint(Random& random, double size) { return {random.in(-size, size), random.in(-size, size)}; }

Polygon randomPoints(Random& random, double size) {
  Polygon points(1 + random.below(12));
  for (Vec2& p : points) p = randomPoint(random, size);
  if (random.chance(0.2)) {  // on a grid: equal points, points on a line
    for (Vec2& p : points) p = (p / size * 2).array().round() * size;
  }
  return points;
}

long double side(const Vec2& from, const Vec2& to, const Vec2& p) {
  const long double ex = static_cast<long double>(to.x()) - from.x(),
                    ey = static_cast<long double>(to.y()) - from.y();
  return ex * (static_cast<long double>(p.y()) - from.y()) -
         ey * (static_cast<long double>(p.x()) - from.x());
}

/// How far p lies outside the counter-clockwise polygon (a point or a segment too); <= 0 inside.
double outside(const Polygon& hull, const Vec2& p) {
  if (hull.empty()) return 1e300;
  if (hull.size() == 1) return (p - hull[0]).norm();
  if (hull.size() == 2) {
    const Vec2 e = hull[1] - hull[0];
    const double u = std::min(1.0, std::max(0.0, e.dot(p - hull[0]) / e.squaredNorm()));
    return (p - hull[0] - u * e).norm();
  }
  double worst = -1e300;
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const Vec2 &from = hull[i], &to = hull[(i + 1) % hull.size()];
    worst = std::max(worst, static_cast<double>(-side(from, to, p)) / (to - from).norm());
  }
  return worst;
}

TEST(Polygon, HullHoldsItsPointsAndTurnsLeft) {
  Random random(kSeed, 0);
  for (int i = 0; i < 2000; ++i) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + " case " + std::to_string(i));
    const double size = random.decade(-6, 3);
    const Polygon points = randomPoints(random, size), hull = convexHull(points);
    for (const Vec2& p : points) ASSERT_LE(outside(hull, p), 1e-15 * size);
    for (const Vec2& v : hull) ASSERT_NE(std::find(points.begin(), points.end(), v), points.end());
    for (std::size_t k = 0; hull.size() > 2 && k < hull.size(); ++k) {
      ASSERT_GT(side(hull[k], hull[(k + 1) % hull.size()], hull[(k + 2) % hull.size()]), 0);
    }
  }
  EXPECT_EQ(convexHull({{0, 0}, {2, 2}, {1, 1}}).size(), 2u);
  EXPECT_EQ(convexHull({{3, 4}, {3, 4}}).size(), 1u);
  EXPECT_EQ(convexHull({{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0.5, 0.5}, {0.5, 0}}).size(), 4u);
}

TEST(Polygon, GrownHullHoldsEveryPointWithinTheRadius) {
  Random random(kSeed, 1);
  for (int i = 0; i < 1000; ++i) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + " case " + std::to_string(i));
    const double size = random.decade(-6, 3), radius = size * random.decade(-6, 1);
    const Polygon points = randomPoints(random, size), hull = convexHull(points),
                  grown = grownHull(points, radius);
    for (int k = 0; k < 40; ++k) {
      const double angle = kTurn * (k + random.unit()) / 40;
      const Vec2 q =
          hull[random.below(static_cast<int>(hull.size()))] + radius * Vec2(std::cos(angle), std::sin(angle));
      ASSERT_LE(outside(grown, q), 1e-15 * (size + radius));
    }
    for (const Vec2& v : grown)
      ASSERT_LE(outside(hull, v), 1.09 * radius + 1e-12 * size) << "needlessly wide";
  }
}

TEST(Polygon, IntersectionHoldsExactlyTheCommonPoints) {
  Random random(kSeed, 2);
  int common = 0;
  for (int i = 0; i < 2000; ++i) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + " case " + std::to_string(i));
    const Polygon p = convexHull(randomPoints(random, 1)), q = convexHull(randomPoints(random, 1));
    if (p.size() < 3 || q.size() < 3) continue;
    const Polygon both = intersection(p, q);
    for (int k = 0; k < 50; ++k) {
      const Vec2 x = randomPoint(random, 1);
      const bool in_both = outside(p, x) < -1e-12 && outside(q, x) < -1e-12;
      common += in_both;
      if (in_both) {
        ASSERT_LE(outside(convexHull(both), x), 1e-12);
      }
    }
    for (const Vec2& v : both) {
      ASSERT_LE(outside(p, v), 1e-12);
      ASSERT_LE(outside(q, v), 1e-12);
    }
  }
  EXPECT_GT(common, 2000);
  EXPECT_TRUE(intersection({{0, 0}, {1, 0}, {0, 1}}, {{5, 5}, {6, 5}, {5, 6}}).empty());
}

TEST(Polygon, EnclosingDiscHoldsThePolygon) {
  Random random(kSeed, 3);
  for (int i = 0; i < 1000; ++i) {
    const Polygon points = randomPoints(random, 2);
    Vec2 centre;
    double radius = -1;
    enclosingDisc(points, &centre, &radius);
    double needed = 0;
    for (const Vec2& p : points) needed = std::max(needed, (p - centre).norm());
    ASSERT_GE(radius, needed) << "seed " << kSeed << " case " << i;
    ASSERT_LE(radius, needed * (1 + 1e-12));
  }
}

TEST(Polygon, DiscInHullStaysInsideAndTouches) {
  Random random(kSeed, 4);
  int positive = 0;
  for (int i = 0; i < 2000; ++i) {
    const Polygon points = randomPoints(random, 1), hull = convexHull(points);
    const double radius = discInHull(points), origin = outside(hull, Vec2::Zero());
    if (hull.size() < 3 || origin >= 0) {
      ASSERT_LE(radius, 1e-15) << "seed " << kSeed << " case " << i;
      continue;
    }
    ++positive;
    ASSERT_NEAR(radius, -origin, 1e-12) << "seed " << kSeed << " case " << i;
  }
  EXPECT_GT(positive, 300);
  EXPECT_EQ(discInHull({{1, 1}, {2, 2}}), 0.0);
}

}  // namespace
}  // namespace collision_node::impact

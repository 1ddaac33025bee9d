/// polygon.h: hulls, intersections of grown hulls and discs hold what they say they hold.
#include <gtest/gtest.h>

#include <cmath>

#include "collision_node/impact/convex/polygon.h"
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

Polygon hullOf(Polygon points) {
  Polygon hull;
  convexHull(points, hull);
  return hull;
}

Polygon grownTogether(const Polygon& p, double grow_p, const Polygon& q, double grow_q) {
  Polygon both, scratch;
  grownIntersection(p, grow_p, q, grow_q, both, scratch);
  return both;
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
    const Polygon points = randomPoints(random, size), hull = hullOf(points);
    for (const Vec2& p : points) ASSERT_LE(outside(hull, p), 1e-15 * size);
    for (const Vec2& v : hull) ASSERT_NE(std::find(points.begin(), points.end(), v), points.end());
    for (std::size_t k = 0; hull.size() > 2 && k < hull.size(); ++k) {
      ASSERT_GT(side(hull[k], hull[(k + 1) % hull.size()], hull[(k + 2) % hull.size()]), 0);
    }
  }
  EXPECT_EQ(hullOf({{0, 0}, {2, 2}, {1, 1}}).size(), 2u);
  EXPECT_EQ(hullOf({{3, 4}, {3, 4}}).size(), 1u);
  EXPECT_EQ(hullOf({{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0.5, 0.5}, {0.5, 0}}).size(), 4u);
}

TEST(Polygon, GrownIntersectionHoldsEveryPointNearBoth) {
  Random random(kSeed, 1);
  int common = 0, empty = 0;
  for (int i = 0; i < 2000; ++i) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + " case " + std::to_string(i));
    const double size = random.decade(-6, 3), grow_p = size * random.decade(-9, 0),
                 grow_q = size * random.decade(-9, 0);
    Polygon shifted = randomPoints(random, size);
    const Vec2 shift = randomPoint(random, 1.5 * size);
    for (Vec2& v : shifted) v += shift;
    const Polygon p = hullOf(randomPoints(random, size)), q = hullOf(shifted);
    const Polygon both = grownTogether(p, grow_p, q, grow_q), hull = hullOf(both);
    empty += both.empty();
    for (int k = 0; k < 60; ++k) {
      // Near p's border, where something may be lost.
      const auto corner = [&](const Polygon& of) { return of[random.below(static_cast<int>(of.size()))]; };
      const double share = random.unit(), angle = kTurn * random.unit();
      const Vec2 x =
          (1 - share) * corner(p) + share * corner(p) +
          grow_p * (random.chance(0.5) ? 1.0 : random.unit()) * Vec2(std::cos(angle), std::sin(angle));
      // `outside` is not the distance beyond a corner: ask q from its own corners and borders too.
      bool in_q = q.size() > 2 && outside(q, x) <= 0.0;
      for (std::size_t j = 0; j < q.size(); ++j) {
        const Vec2 e = q[(j + 1) % q.size()] - q[j];
        const double u =
            e.squaredNorm() > 0 ? std::min(1.0, std::max(0.0, e.dot(x - q[j]) / e.squaredNorm())) : 0.0;
        in_q |= (x - q[j] - u * e).norm() <= grow_q;
      }
      if (!in_q) continue;
      ++common;
      ASSERT_FALSE(both.empty());
      ASSERT_LE(outside(hull, x), 1e-14 * size + 1e-12 * (grow_p + grow_q));
    }
    for (const Vec2& v : both) {
      ASSERT_LE(outside(p, v), 3.0 * grow_p + 1e-12 * size) << "needlessly wide";
      ASSERT_LE(outside(q, v), 3.0 * grow_q + 1e-12 * size) << "needlessly wide";
    }
  }
  EXPECT_GT(common, 10000);
  EXPECT_GT(empty, 200);
  EXPECT_TRUE(grownTogether({{0, 0}, {1, 0}, {0, 1}}, 0.1, {{5, 5}, {6, 5}, {5, 6}}, 0.1).empty());
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
    Polygon points = randomPoints(random, 1), hull;
    const double radius = discInHull(points, hull), origin = outside(hull, Vec2::Zero());
    if (hull.size() < 3 || origin >= 0) {
      ASSERT_LE(radius, 1e-15) << "seed " << kSeed << " case " << i;
      continue;
    }
    ++positive;
    ASSERT_NEAR(radius, -origin, 1e-12) << "seed " << kSeed << " case " << i;
  }
  EXPECT_GT(positive, 300);
  Polygon segment = {{1, 1}, {2, 2}}, hull;
  EXPECT_EQ(discInHull(segment, hull), 0.0);
}

TEST(Polygon, BehindTheEdgeInItsWayNoLargerDiscFits) {
  Random random(kSeed, 5);
  int blocked = 0, grown = 0;
  for (int i = 0; i < 2000; ++i) {
    Polygon points = randomPoints(random, 1), more = randomPoints(random, 1), hull;
    Vec2 out(9, 9);
    const double radius = discInHull(points, hull, &out);
    if (hull.size() < 3) {
      ASSERT_TRUE(out.isZero(0.0));
      continue;
    }
    ++blocked;
    ASSERT_NEAR(out.norm(), 1.0, 1e-12);
    double most = radius;
    for (const Vec2& p : more) most = std::max(most, out.dot(p));
    more.insert(more.end(), points.begin(), points.end());
    const double larger = discInHull(more, hull);
    grown += larger > radius;
    ASSERT_LE(larger, most + 1e-12) << "seed " << kSeed << " case " << i;
  }
  EXPECT_GT(blocked, 300);
  EXPECT_GT(grown, 300);
}

}  // namespace
}  // namespace collision_node::impact

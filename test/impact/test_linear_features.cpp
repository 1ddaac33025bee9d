/// linear_features.h: "kClear means no common point at any t of the closed interval; kImpact means a common
/// point at some t in [t_lo, t_hi] and none in [0, t_lo)"; kUndecided: "every t with a common point lies in
/// [t_lo, t_hi]". The truth comes from exact rational arithmetic (test/oracle/linear_contact.h).
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>

#include "test/impact/fuzz_shapes.h"
#include "test/impact/linear_query.h"

namespace linear {
namespace {

using fuzz::Random;

constexpr std::uint64_t kSeed = 412006;

LinearVertex resting(const Vec3& x) { return {x, x}; }

/// A vertex that goes from `from` to `to` past the triangle (0,0,0) (1,0,0) (0,1,0).
Query pastTriangle(const Vec3& from, const Vec3& to) {
  return {false, {{{from, to}, resting({0, 0, 0}), resting({1, 0, 0}), resting({0, 1, 0})}}};
}

/// The edge from (-1,0,0) to (1,0,0) at rest, the other from b0 to b1 moved by `way`.
Query pastEdge(const Vec3& b0, const Vec3& b1, const Vec3& way) {
  return {true, {{resting({-1, 0, 0}), resting({1, 0, 0}), {b0, b0 + way}, {b1, b1 + way}}}};
}

void expectImpactAt(const Query& q, double time) {
  const LinearContact contact = ask(q);
  EXPECT_EQ(contact.verdict, LinearVerdict::kImpact) << contact.t_lo << ' ' << contact.t_hi;
  EXPECT_LE(contact.t_lo, time);
  EXPECT_GE(contact.t_hi, time);
  EXPECT_LE(contact.t_hi - contact.t_lo, 1e-14);
}

void expectClear(const Query& q) { EXPECT_EQ(ask(q).verdict, LinearVerdict::kClear); }

TEST(LinearFeatures, AVertexThroughATriangleIsAnImpactAtItsPlane) {
  expectImpactAt(pastTriangle({0.25, 0.25, 3}, {0.25, 0.25, -1}), 0.75);
}

TEST(LinearFeatures, AVertexThroughASideOrACornerTouches) {
  expectImpactAt(pastTriangle({0.5, 0.5, 1}, {0.5, 0.5, -1}), 0.5);
  expectImpactAt(pastTriangle({1, 0, 1}, {1, 0, -1}), 0.5);
  expectImpactAt(pastTriangle({1, -2, 1}, {1, 2, -1}), 0.5);
}

TEST(LinearFeatures, AVertexJustBesideATriangleIsClear) {
  expectClear(pastTriangle({0.5, 0.5 + 0x1p-53, 1}, {0.5, 0.5 + 0x1p-53, -1}));
  expectClear(pastTriangle({-0x1p-90, 0.5, 1}, {-0x1p-90, 0.5, -1}));
}

TEST(LinearFeatures, BothEndsOfTheIntervalBelongToIt) {
  expectImpactAt(pastTriangle({0.25, 0.25, 1}, {0.25, 0.25, 0}), 1.0);
  expectImpactAt(pastTriangle({0.25, 0.25, 0}, {0.25, 0.25, 1}), 0.0);
  expectClear(pastTriangle({0.25, 0.25, 1}, {0.25, 0.25, 0x1p-80}));
}

TEST(LinearFeatures, AVertexThatSlidesInATrianglesPlaneTouchesItsSideFirst) {
  expectImpactAt(pastTriangle({-1, 0.25, 0}, {3, 0.25, 0}), 0.25);
  expectClear(pastTriangle({-1, -0x1p-60, 0}, {3, -0x1p-60, 0}));
}

TEST(LinearFeatures, AllAtRestIsDecidedExactly) {
  expectImpactAt(pastTriangle({0.25, 0.25, 0}, {0.25, 0.25, 0}), 0.0);
  expectClear(pastTriangle({0.25, 0.25, 0x1p-90}, {0.25, 0.25, 0x1p-90}));
  Query nothing;
  expectImpactAt(nothing, 0.0);
}

TEST(LinearFeatures, CrossingEdgesTouchAndSkewOnesPass) {
  expectImpactAt(pastEdge({0, -1, 1}, {0, 1, 1}, {0, 0, -4}), 0.25);
  expectImpactAt(pastEdge({1, 0, 1}, {1, 5, 1}, {0, 0, -2}), 0.5);  // corner on corner
  expectClear(pastEdge({1 + 0x1p-52, 0, 1}, {1 + 0x1p-52, 5, 1}, {0, 0, -2}));
}

TEST(LinearFeatures, ParallelEdgesTouchWhereTheyOverlap) {
  expectImpactAt(pastEdge({0.5, 0, 1}, {3, 0, 1}, {0, 0, -2}), 0.5);
  expectImpactAt(pastEdge({1, 0, 1}, {3, 0, 1}, {0, 0, -2}), 0.5);
  expectClear(pastEdge({1 + 0x1p-52, 0, 1}, {3, 0, 1}, {0, 0, -2}));
  expectImpactAt(pastEdge({2, 0, 0}, {3, 0, 0}, {-2, 0, 0}), 0.5);  // along one line
}

TEST(LinearFeatures, FeaturesThatShrinkToPointsStillTouch) {
  const LinearVertex p = resting({0, 0, 0});
  expectImpactAt({false, {{{{0, 0, 1}, {0, 0, -1}}, p, p, p}}}, 0.5);
  expectImpactAt({true, {{{{-1, 0, 1}, {1, 0, -1}}, {{-1, 0, 1}, {1, 0, -1}}, p, p}}}, 0.5);
  // The triangle collapses into the moment it is met.
  expectImpactAt(
      {false, {{p, {{1, 0, 1}, {-1, 0, -1}}, {{0, 1, 1}, {0, -1, -1}}, {{-1, -1, 1}, {1, 1, -1}}}}}, 0.5);
}

TEST(LinearFeatures, WhatIsNotFiniteIsUndecided) {
  const double infinite = std::numeric_limits<double>::infinity();
  EXPECT_EQ(ask(pastTriangle({0.2, 0.2, infinite}, {0.2, 0.2, -1})).verdict, LinearVerdict::kUndecided);
  EXPECT_EQ(ask(pastTriangle({0.2, 0.2, std::nan("")}, {0.2, 0.2, 1})).verdict, LinearVerdict::kUndecided);
  Query huge = pastTriangle({0.2, 0.2, 1.5e308}, {0.2, 0.2, -1});
  huge.vertices[1] = resting({0, 0, -1.5e308});
  EXPECT_NE(ask(huge).verdict, LinearVerdict::kImpact);
}

TEST(LinearFeatures, limit_ATouchWithoutCrossingAtAnOddTimeStaysUndecidedInATightBracket) {
  // Vertex on vertex at t = z / (z + 1), whose fraction needs more digits than are tried.
  const double z = 1.2345678901234567;
  const Query q = pastTriangle({1, 0, z}, {1, 0, -1});
  const LinearContact contact = ask(q);
  EXPECT_NE(contact.verdict, LinearVerdict::kClear);
  EXPECT_LE(contact.t_hi - contact.t_lo, 1e-15);
  EXPECT_LE(contact.t_lo, z / (z + 1) + 1e-16);
  EXPECT_GE(contact.t_hi, z / (z + 1) - 1e-16);
}

/// How vertices are drawn: from so few positions that nearly everything touches or is degenerate; the same,
/// nudged by the last bits; anywhere; all nearly in one plane.
Query randomQuery(Random& random) {
  Query q;
  q.edges = random.chance(0.5);
  const int kind = random.below(4);
  const bool translating = random.chance(0.25);
  const auto position = [&]() -> Vec3 {
    const auto coordinate = [&]() -> double {
      if (kind == 2) return random.in(-1, 1);
      const double base = random.below(5) - 2.0;
      return kind == 1 && random.chance(0.3) ? base + random.in(-1, 1) * random.decade(-30, -14) : base;
    };
    Vec3 x(coordinate(), coordinate(), coordinate());
    if (kind == 3) x.z() *= random.chance(0.5) ? 0.0 : 1e-17;
    return x;
  };
  const Vec3 ways[2] = {position(), position()};
  for (int k = 0; k < 4; ++k) {
    LinearVertex& v = q.vertices[k];
    v.start = position();
    v.end = translating ? Vec3(v.start + ways[q.edges ? k / 2 : k > 0]) : position();
  }
  return q;
}

TEST(LinearFeatures, RandomQueriesNeverMissNeverInventAndTheirBracketsHoldTheFirstTouch) {
  std::printf("seed %llu\n", static_cast<unsigned long long>(kSeed));
  const int count = std::getenv("COLLISION_NODE_LONG") != nullptr ? 15000 : 1500;
  int touching = 0, confirmed = 0, clear = 0, open = 0;
  for (int index = 0; index < count; ++index) {
    Random random(kSeed, index);
    const Query q = randomQuery(random);
    const LinearContact contact = ask(q);
    const auto touch = truth(q);
    if (touch) {
      ++touching;
      confirmed += contact.verdict == LinearVerdict::kImpact;
      ASSERT_NE(contact.verdict, LinearVerdict::kClear) << "missed, index " << index;
      ASSERT_LE(oracle::Rational(contact.t_lo), touch->high) << "late, index " << index;
      ASSERT_GE(oracle::Rational(contact.t_hi), touch->low) << "early, index " << index;
    } else {
      ++clear;
      open += contact.verdict == LinearVerdict::kUndecided;
      ASSERT_NE(contact.verdict, LinearVerdict::kImpact) << "invented, index " << index;
    }
  }
  std::printf("%d touch, %d of them confirmed; %d apart, %d of them undecided\n", touching, confirmed, clear,
              open);
  EXPECT_GT(touching, count / 10);
  EXPECT_GT(clear, count / 2);
  EXPECT_LE(open, clear * 3 / 100);
}

TEST(LinearFeatures, ScaleAndSwappedSidesDoNotChangeTheAnswer) {
  for (int index = 0; index < 2000; ++index) {
    Random random(kSeed + 1, index);
    const Query q = randomQuery(random);
    const LinearContact contact = ask(q);
    for (const int power : {-300, -20, 20, 40, 300}) {
      const Query scaled =
          changed(q, [&](const Vec3& x, double) -> Vec3 { return x * std::ldexp(1.0, power); });
      ASSERT_TRUE(same(contact, ask(scaled))) << "seed " << kSeed + 1 << " index " << index;
    }
    if (!q.edges) continue;
    const auto& v = q.vertices;
    const LinearContact swapped = edgeEdgeContact({v[2], v[3]}, {v[0], v[1]});
    ASSERT_FALSE(contact.verdict == LinearVerdict::kClear && swapped.verdict == LinearVerdict::kImpact);
    ASSERT_FALSE(contact.verdict == LinearVerdict::kImpact && swapped.verdict == LinearVerdict::kClear);
  }
}

}  // namespace
}  // namespace linear

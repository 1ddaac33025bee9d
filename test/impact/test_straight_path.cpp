// Straight paths against brute force over all triangles in extended precision, which shares no code with
// them.
#include <gtest/gtest.h>

#include "collision_node/impact/straight/straight_path.h"
#include "test/impact/star_shot.h"

namespace moving {
namespace {

using collision_node::impact::Lanes;
using collision_node::impact::PathContact;
using collision_node::impact::StraightPath;

constexpr double kWidth = 1e-9;

/// Answers of the solver, for tests that only look at those.
PathContact answer(const Shot& shot, Lanes lanes = collision_node::impact::fastestLanes(),
                   double from = 0.0) {
  const Body body({mesh(shot.vertices, shot.triangles, SolidChoice::kNo)});
  const Body single({shot.radius > 0.0 ? placed(collision_node::geometry::Sphere{shot.radius})
                                       : placed(collision_node::geometry::Point{})});
  const Piece piece = shot.piece();
  const PairPiece pair(body, single, piece, 0.0);
  const auto path = StraightPath::of(pair.a, pair.b, piece, 0.0);
  PathContact contact;
  EXPECT_TRUE(path.has_value());
  if (path) path->first(from, pair.motion.duration(), kWidth, contact, lanes);
  return contact;
}

void expectHolds(const PathContact& contact, Real time) {
  EXPECT_EQ(contact.kind, PathContact::Kind::kContact);
  EXPECT_LE(contact.lower, time);
  EXPECT_GE(contact.upper, time);
}

TEST(StraightPath, PointMeetsWhatBruteForceMeetsAndItsBracketHoldsTheTruth) {
  int hits = 0, told = 0;
  double widest = 0.0;
  for (int i = 0; i < 1500; ++i) {
    Random random(31, i);
    SCOPED_TRACE("seed 31 index " + std::to_string(i));
    const Shot shot = starShot(random);
    const Truth truth = firstCrossing(shot);
    const PathContact contact = answer(shot);
    if (!truth.sure) continue;
    if (contact.kind == PathContact::Kind::kCannotTell) continue;
    ++told;
    ASSERT_EQ(contact.kind == PathContact::Kind::kContact, truth.hit);
    if (!truth.hit) continue;
    expectHolds(contact, truth.time);
    widest = std::max(widest, contact.upper - contact.lower);
    ++hits;
  }
  EXPECT_GT(told, 1490);
  EXPECT_GT(hits, 500);
  EXPECT_LT(widest, 1e-9);
}

TEST(StraightPath, NoPathLeaksThroughASharedEdgeOrVertex) {
  int undecided = 0, shots = 0;
  for (int i = 0; i < 20; ++i) {
    Random random(32, i);
    Shot shot;
    addStar(random, shot, 12, 16, 3.0);
    const Body body({mesh(shot.vertices, shot.triangles, SolidChoice::kNo)});
    const Body single({placed(collision_node::geometry::Point{})});
    for (int k = 0; k < 5000; ++k, ++shots) {
      SCOPED_TRACE("seed 32 index " + std::to_string(i) + " shot " + std::to_string(k));
      const Corners& t = shot.triangles[random.below(static_cast<int>(shot.triangles.size()))];
      const double share = random.chance(0.5) ? 0.0 : random.unit();
      const Vec3 aim = (1.0 - share) * shot.vertices[t[0]] + share * shot.vertices[t[1]];
      const Vec3 inner = randomVec(random, 0.3);  // inside: the star's hull of the least radius is 2.3 m
      Piece piece;
      piece.end_ns = kSpan;
      piece.a = resting();
      const Vec3 start = aim + 10.0 * (aim - inner);
      piece.b = flight(0, kSpan, start, (inner - start) / (static_cast<double>(kSpan) * 1e-9));
      const PairPiece pair(body, single, piece, 0.0);
      PathContact contact;
      StraightPath::of(pair.a, pair.b, piece, 0.0)->first(0.0, pair.motion.duration(), kWidth, contact);
      ASSERT_NE(contact.kind, PathContact::Kind::kClear);
      undecided += contact.kind == PathContact::Kind::kCannotTell;
      if (contact.kind == PathContact::Kind::kContact) {
        ASSERT_LE(contact.lower, pair.motion.duration() * (10.0 / 11.0) * (1.0 + 1e-12));
      }
    }
  }
  EXPECT_EQ(shots, 100000);
  EXPECT_LT(undecided, shots / 100);
}

TEST(StraightPath, APathThroughAVertexIsOneContactWithAllTheTrianglesAroundIt) {
  Shot shot;
  shot.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}};
  shot.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 1}};
  shot.velocity = Vec3(30, 60, -2000);
  shot.from = -0.5 * shot.duration() * shot.velocity;
  const PathContact contact = answer(shot);
  expectHolds(contact, 0.5L * shot.duration());
  EXPECT_EQ(contact.count, 4);
  EXPECT_EQ(answer(shot, Lanes::kBaseline, contact.upper).kind, PathContact::Kind::kClear);
}

TEST(StraightPath, FarFromTheWorldsOriginAndFromItsOwnNothingIsMissed) {
  for (int i = 0; i < 300; ++i) {
    Random random(33, i);
    SCOPED_TRACE("seed 33 index " + std::to_string(i));
    Shot shot = starShot(random, 0.0, 8, 12);
    const bool own = random.chance(0.5);
    const Vec3 away(1e7, -3e6, 2e6);
    if (own) {  // the triangles far from their object's origin
      for (Vec3& v : shot.vertices) v += away;
      const V3 r = oracle::rotationOf(shot.pose.orientation) * oracle::exact(away);
      shot.from += Vec3(static_cast<double>(r.x), static_cast<double>(r.y), static_cast<double>(r.z));
    } else {
      shot.pose.position += away;
      shot.from += away;
    }
    const Truth truth = firstCrossing(shot);
    const PathContact contact = answer(shot);
    if (contact.kind == PathContact::Kind::kCannotTell || !truth.sure) continue;
    ASSERT_EQ(contact.kind == PathContact::Kind::kContact, truth.hit);
    if (truth.hit) expectHolds(contact, truth.time);
  }
}

TEST(StraightPath, NeedlesAndTrianglesWithoutAreaTellNoLies) {
  int decided = 0;
  for (int i = 0; i < 3000; ++i) {
    Random random(34, i);
    SCOPED_TRACE("seed 34 index " + std::to_string(i));
    Shot shot;
    for (int k = 0; k < 6; ++k) {
      const Vec3 a = randomVec(random, 2.0), along = random.direction();
      const auto base = static_cast<std::int32_t>(shot.vertices.size());
      const double thin = k == 0 ? 0.0 : random.decade(-16, -1);
      shot.vertices.insert(shot.vertices.end(),
                           {a, a + along, a + random.unit() * along + thin * random.direction()});
      shot.triangles.push_back({base, base + 1, base + 2});
    }
    const std::int32_t* c = shot.triangles[static_cast<std::size_t>(random.below(6))].data();
    const Vec3 aim = (shot.vertices[c[0]] + shot.vertices[c[1]] + shot.vertices[c[2]]) / 3.0;
    shot.velocity = 500.0 * random.direction();
    shot.from = aim - 0.5 * shot.duration() * shot.velocity;
    const Truth truth = firstCrossing(shot);
    const PathContact contact = answer(shot);
    if (contact.kind == PathContact::Kind::kCannotTell) continue;
    if (contact.kind == PathContact::Kind::kClear) {
      ASSERT_FALSE(truth.hit);
      continue;
    }
    ++decided;
    if (truth.sure) {
      ASSERT_TRUE(truth.hit);
      expectHolds(contact, truth.time);
    }
  }
  EXPECT_GT(decided, 500);
}

TEST(StraightPath, ScaledByAPowerOfTwoTheTimesAreTheSameBits) {
  for (int i = 0; i < 200; ++i) {
    Random random(35, i);
    SCOPED_TRACE("seed 35 index " + std::to_string(i));
    const Shot shot = starShot(random, i % 2 == 0 ? 0.0 : 0.05, 8, 12);
    const PathContact one = answer(shot);
    for (const int power : {-60, -7, 1, 33}) {
      Shot scaled = shot;
      const double s = std::ldexp(1.0, power);
      for (Vec3& v : scaled.vertices) v *= s;
      scaled.pose.position *= s;
      scaled.from *= s;
      scaled.velocity *= s;
      scaled.radius *= s;
      const PathContact other = answer(scaled);
      ASSERT_EQ(other.kind, one.kind) << power;
      ASSERT_EQ(other.lower, one.lower) << power;
      ASSERT_EQ(other.upper, one.upper) << power;
      ASSERT_EQ(other.tests, one.tests) << power;
    }
  }
}

TEST(StraightPath, TheNumberOfLanesChangesNothing) {
  for (int i = 0; i < 1000; ++i) {
    Random random(36, i);
    SCOPED_TRACE("seed 36 index " + std::to_string(i));
    const Shot shot = starShot(random, i % 2 == 0 ? 0.0 : random.decade(-4, 0), 8, 12);
    const PathContact narrow = answer(shot, Lanes::kBaseline), wide = answer(shot);
    ASSERT_EQ(narrow.kind, wide.kind);
    ASSERT_EQ(narrow.lower, wide.lower);
    ASSERT_EQ(narrow.upper, wide.upper);
    ASSERT_EQ(narrow.tests, wide.tests);
    ASSERT_EQ(narrow.count, wide.count);
    for (int k = 0; k < narrow.count; ++k) ASSERT_EQ(narrow.met[k].element, wide.met[k].element);
  }
}

/// The least distance to a triangle in [from, to]: convex in time, so thirds find it.
Real leastDistance(const Shot& shot, const std::array<V3, 3>& c, Real from, Real to) {
  const auto distance = [&](Real t) { return oracle::pointTriangle(shot.at(t), c.data()).upper; };
  for (int i = 0; i < 120; ++i) {
    const Real a = from + (to - from) / 3, b = to - (to - from) / 3;
    (distance(a) < distance(b) ? to : from) = distance(a) < distance(b) ? b : a;
  }
  return distance((from + to) / 2);
}

TEST(StraightPath, SphereIsFreeBeforeItsBracketAndTouchesWithinIt) {
  int hits = 0, cannot = 0;
  double widest = 0.0;
  for (int i = 0; i < 400; ++i) {
    Random random(37, i);
    SCOPED_TRACE("seed 37 index " + std::to_string(i));
    const Shot shot = starShot(random, random.decade(-3, 0), 5, 7);
    const PathContact contact = answer(shot);
    if (contact.kind == PathContact::Kind::kCannotTell) {
      ++cannot;
      continue;
    }
    const bool hit = contact.kind == PathContact::Kind::kContact;
    const Real until = hit ? contact.lower : shot.duration();
    Real at_upper = 1e9L;
    for (const Corners& t : shot.triangles) {
      const auto c = shot.corners(t);
      ASSERT_GT(leastDistance(shot, c, 0, until), shot.radius * (1 - 1e-18L));
      if (hit) at_upper = std::min(at_upper, oracle::pointTriangle(shot.at(contact.upper), c.data()).upper);
    }
    if (!hit) continue;
    ASSERT_LE(at_upper, shot.radius);
    widest = std::max(widest, contact.upper - contact.lower);
    ++hits;
  }
  EXPECT_GT(hits, 150);
  EXPECT_LT(cannot, 4);
  EXPECT_LT(widest, 1e-9);
}

TEST(StraightPath, LimitAGrazeIsNotDecided) {
  Shot shot;
  shot.vertices = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}};
  shot.triangles = {{0, 1, 2}};
  shot.velocity = Vec3(100, 0, 0);
  shot.from = Vec3(-2, 0, 0);  // in the triangle's own plane
  EXPECT_EQ(answer(shot).kind, PathContact::Kind::kCannotTell);
  shot.radius = 0.5;
  shot.from = Vec3(-2, 0, 0.5);
  EXPECT_EQ(answer(shot).kind, PathContact::Kind::kCannotTell);
}

TEST(StraightPath, ATubeWiderThanTheMeshHidesNothing) {
  for (const double scale : {1e-3, 1e-6, 1e-9, 1e-12}) {
    SCOPED_TRACE(scale);
    Shot shot;
    shot.vertices = {{-scale, -scale, 0}, {scale, -scale, 0}, {0, scale, 0}};
    shot.triangles = {{0, 1, 2}};
    for (const double distance : {1.0, 1e3, 1e6, 1e9, 1e12}) {  // of a point: its rounding is the tube
      shot.from = Vec3(0.0, 0.0, distance);
      shot.velocity = Vec3(0.0, 0.0, -60.0 * distance);
      EXPECT_NE(answer(shot).kind, PathContact::Kind::kClear) << distance;
      shot.from.x() = 1e-16 * distance;  // beside it, and nobody can prove it
      if (shot.from.x() > 4.0 * scale) {
        EXPECT_EQ(answer(shot).kind, PathContact::Kind::kCannotTell) << distance;
      }
    }
    for (const double radius : {1.0, 1e3, 1e6}) {
      shot.radius = radius;
      shot.velocity = Vec3(0.0, 0.0, -90.0 * radius);
      shot.from = Vec3(0.9 * radius, 0.0, 1.5 * radius);
      EXPECT_NE(answer(shot).kind, PathContact::Kind::kClear) << radius;
      shot.from = Vec3(1.1 * radius, 0.0, 1.5 * radius);
      EXPECT_NE(answer(shot).kind, PathContact::Kind::kContact) << radius;
    }
    shot.radius = 0.0;
  }
}

TEST(StraightPath, WhatTurnsOrBendsIsNoStraightPath) {
  const Body body({sheet(1.0)}), point({placed(collision_node::geometry::Point{})});
  const Body off({placed(collision_node::geometry::Sphere{0.1}, Vec3(1, 0, 0))});
  Piece piece;
  piece.end_ns = kSpan;
  piece.a = resting();
  piece.b = flight(0, kSpan, {0, 0, 1}, {0, 0, -100}, {0, 0, 3});
  EXPECT_TRUE(StraightPath::of(body, point, piece, 0.0).has_value());
  EXPECT_TRUE(StraightPath::of(point, body, {0, kSpan, piece.b, piece.a}, 0.0).has_value());
  EXPECT_FALSE(StraightPath::of(body, off, piece, 0.0).has_value());
  EXPECT_FALSE(StraightPath::of(point, body, piece, 0.0).has_value());
  EXPECT_FALSE(StraightPath::of(body, body, piece, 0.0).has_value());
  piece.tube = 1e-3;
  EXPECT_FALSE(StraightPath::of(body, point, piece, 0.0).has_value());
  piece.tube = 0.0;
  piece.b.c[2] = {0, 0, -5};
  EXPECT_FALSE(StraightPath::of(body, point, piece, 0.0).has_value());
}

}  // namespace
}  // namespace moving

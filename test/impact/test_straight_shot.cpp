// Shots that need no search: what solve() says of them, against brute force in extended precision.
#include <gtest/gtest.h>

#include "collision_node/impact/solve.h"
#include "collision_node/impact/straight/straight_shot.h"
#include "test/impact/star_shot.h"

namespace moving {
namespace {

using collision_node::impact::Answer;
using collision_node::impact::Certificate;
using collision_node::impact::Feature;
using collision_node::impact::Kind;
using collision_node::impact::PairEvent;
using collision_node::impact::PairOptions;
using collision_node::impact::Scope;
using collision_node::impact::Side;
using collision_node::impact::Solution;
using collision_node::impact::Workspace;

PairOptions firstContact() {
  PairOptions options;
  options.scope = Scope::kFirstContact;
  return options;
}

Body bodyOf(const Shot& shot, SolidChoice solid) {
  return Body({mesh(shot.vertices, shot.triangles, solid)});
}

/// `b` is the shot's point; the facts of its first contact against the truth.
void expectFacts(const Shot& shot, const Truth& truth, const PairEvent& event, bool swapped) {
  EXPECT_EQ(event.kind, Kind::kImpact);
  EXPECT_EQ(event.certificate, Certificate::kConfirmed);
  EXPECT_LE(event.toi_lower, truth.time);
  EXPECT_GE(event.toi_upper, truth.time);
  EXPECT_LT(event.toi_upper - event.toi_lower, 1e-9);
  const V3 place = oracle::exact(shot.from) + truth.time * oracle::exact(shot.velocity);
  EXPECT_LE(oracle::norm(place - oracle::exact(event.position)), event.position_error);
  EXPECT_LT(event.position_error, 1e-6);
  const auto c = shot.corners(shot.triangles[static_cast<std::size_t>(truth.triangle)]);
  V3 n = oracle::rotationOf(shot.pose.orientation) * oracle::cross(c[1] - c[0], c[2] - c[0]);
  n = (1 / oracle::norm(n)) * n;
  const bool along = oracle::dot(n, oracle::exact(shot.velocity)) > 0;  // the normal points from A to B
  if (along != swapped) n = Real(-1) * n;
  EXPECT_LE(oracle::norm(n - oracle::exact(event.normal)), event.normal_error + 1e-15L);
  EXPECT_LT(event.normal_error, 1e-6);
  EXPECT_NEAR(event.closing_speed,
              std::abs(static_cast<double>(oracle::dot(n, oracle::exact(shot.velocity)))),
              1e-9 * shot.velocity.norm());
  const Side &met = swapped ? event.b : event.a, &point = swapped ? event.a : event.b;
  EXPECT_EQ(met.triangle, truth.triangle);
  EXPECT_EQ(met.feature, Feature::kFace);
  EXPECT_EQ(point.feature, Feature::kVertex);
  const V3 own = shot.at(truth.time);
  EXPECT_LE(oracle::norm(own - oracle::exact(met.point)), event.position_error);
  EXPECT_LE(point.point.norm(), event.position_error);
}

TEST(StraightShot, TheFirstContactIsWhatBruteForceFindsAndItsFactsHold) {
  Workspace workspace;
  Solution solution;
  int hits = 0, clear = 0;
  for (int i = 0; i < 1000; ++i) {
    Random random(71, i);
    SCOPED_TRACE("seed 71 index " + std::to_string(i));
    const Shot shot = starShot(random);
    const bool solid = random.chance(0.5), swapped = random.chance(0.5), spins = random.chance(0.3);
    const Body body = bodyOf(shot, solid ? SolidChoice::kYes : SolidChoice::kNo);
    const Body point({placed(collision_node::geometry::Point{})});
    Piece piece = shot.piece();
    if (spins) piece.b.omega = 1e5 * random.direction();  // a point at its own origin turns on the spot
    if (swapped) std::swap(piece.a, piece.b);
    const Truth truth = firstCrossing(shot);
    if (!truth.sure || (shot.from - shot.pose.position).norm() < 4.0) continue;  // starts outside
    collision_node::impact::solve(swapped ? point : body, swapped ? body : point, piece, firstContact(),
                                  workspace, solution);
    if (!truth.hit) {
      ASSERT_TRUE(solution.verdict == Answer::kClear || solution.verdict == Answer::kCulled);
      ASSERT_TRUE(solution.events.empty());
      ++clear;
      continue;
    }
    ASSERT_EQ(solution.verdict, Answer::kImpact);
    ASSERT_EQ(solution.events.size(), solid ? 1U : 2U);
    expectFacts(shot, truth, solution.events[0], swapped);
    if (!solid) {
      EXPECT_EQ(solution.events[1].kind, Kind::kSeparation);
      EXPECT_EQ(solution.events[1].toi_lower, solution.events[0].toi_lower);
      EXPECT_EQ(solution.events[1].toi_upper, solution.events[0].toi_upper);
    }
    ++hits;
  }
  EXPECT_GT(hits, 300);
  EXPECT_GT(clear, 100);
}

TEST(StraightShot, WhatStartsInsideOrBesideTheBoxIsNotSettledWithoutALook) {
  Random random(72, 0);
  Shot shot = starShot(random);
  shot.from = shot.pose.position;  // inside the closed star
  const Body solid = bodyOf(shot, SolidChoice::kYes), point({placed(collision_node::geometry::Point{})});
  const Piece piece = shot.piece();
  std::vector<PairEvent> events;
  EXPECT_FALSE(
      collision_node::impact::shoot(solid, point, piece, firstContact(), false, &events).has_value());
  EXPECT_TRUE(events.empty());
  Workspace workspace;
  Solution solution;
  collision_node::impact::solve(solid, point, piece, firstContact(), workspace, solution);
  ASSERT_FALSE(solution.events.empty());
  EXPECT_EQ(solution.events[0].kind, Kind::kInitialOverlap);

  // A sphere that touches the box of all triangles from outside, on one axis, by less than rounding tells.
  const Body flat({sheet(1.0)}), ball({placed(collision_node::geometry::Sphere{0.5})});
  Piece beside;
  beside.end_ns = kSpan;
  beside.a = resting();
  for (const double away : {0.0, 1e-16, 1e-6}) {
    beside.b = flight(0, kSpan, {0, 0, 0.5 * (1.0 + away)}, {0, 0, 10});
    const auto outcome = collision_node::impact::shoot(flat, ball, beside, firstContact(), false, &events);
    EXPECT_EQ(outcome.has_value(), away == 1e-6) << away;
  }
}

TEST(StraightShot, ABudgetTooSmallForTheWalkIsNoAnswer) {
  Random random(73, 1);
  Shot shot = starShot(random);
  const Body body = bodyOf(shot, SolidChoice::kNo), point({placed(collision_node::geometry::Point{})});
  shot.from = shot.pose.position - 0.5 * shot.duration() * shot.velocity;  // through the middle
  PairOptions options = firstContact();
  std::vector<PairEvent> events;
  EXPECT_TRUE(collision_node::impact::shoot(body, point, shot.piece(), options, false, &events).has_value());
  options.node_budget = 1;
  events.clear();
  EXPECT_FALSE(collision_node::impact::shoot(body, point, shot.piece(), options, false, &events).has_value());
  EXPECT_TRUE(events.empty());
}

}  // namespace
}  // namespace moving

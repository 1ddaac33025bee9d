/// search.h: "a time that firstPossible() passes over, and an instant that classify() calls apart, is proved
/// free of contact ... Everything else is reported, never dropped."
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "collision_node/impact/out_of_reach.h"
#include "collision_node/impact/walk/search.h"
#include "test/impact/fuzz_case.h"
#include "test/impact/moving_pair.h"

namespace collision_node::impact {
namespace {

using moving::Random;
using oracle::Real;

constexpr std::uint64_t kSeed = 77005;
constexpr std::uint64_t kPlenty = 4'000'000;

moving::Pair pairOf(const fuzz::Case& c) { return {c.a, c.b, c.piece, c.options.contact_distance}; }

TEST(Search, FirstPossibleIsNeverLaterThanContact) {
  int found = 0, hits = 0, close = 0;
  for (int i = 0; i < 150; ++i) {
    const fuzz::Case c = fuzz::makeCase(kSeed, i);
    SCOPED_TRACE(c.describe());
    const moving::Pair pair = pairOf(c);
    const double duration = c.duration(), stop = 1e-10 * duration;
    Workspace workspace;
    Search search(pair.solver, kPlenty, workspace);
    const Search::First first = search.firstPossible(0.0, duration, stop);
    ASSERT_FALSE(search.exhausted());
    found += first.found;
    const double free_until = first.found ? first.time : duration;
    // Dense samples of what was passed over: surfaces apart. (Solids that hold each other are another
    // question.)
    for (int k = 0; k < 30 && free_until > 0.0; ++k) {
      const Real t = static_cast<Real>(free_until) * k / 30;
      const oracle::NearestParts nearest = pair.exact.nearest(t);
      ASSERT_TRUE(nearest.inside || nearest.gap.upper > 0) << "contact at " << static_cast<double>(t);
    }
    if (pair.exact.nearest(0).inside) continue;
    const oracle::FirstTouch truth = pair.exact.firstTouch(0, duration, 0, 200000);
    if (!truth.found || !truth.verified) continue;
    ++hits;
    ASSERT_TRUE(first.found);
    ASSERT_LE(first.time, truth.hi);
    close += truth.lo - first.time < 1e-6L * duration;
  }
  std::printf("%d of 150 reported, %d true contacts, %d of them met within 1e-6 of the piece\n", found, hits,
              close);
  EXPECT_GT(hits, 40);
  EXPECT_GT(close, 0.95 * hits) << "not a guarantee, but early answers cost work";
}

TEST(Search, ClassifyIsRightOrSaysNothing) {
  int apart = 0, contact = 0, nothing = 0;
  for (int i = 0; i < 150; ++i) {
    const fuzz::Case c = fuzz::makeCase(kSeed + 1, i);
    SCOPED_TRACE(c.describe());
    const moving::Pair pair = pairOf(c);
    Random random(kSeed + 1, 100000 + i);
    for (int k = 0; k < 4; ++k) {
      const double t = random.unit() * c.duration();
      Workspace workspace;
      Search search(pair.solver, kPlenty, workspace);
      ContactWitness witness;
      const Proved proved = search.classify(t, &witness);
      const Real distance = pair.exact.distance(t);
      (proved == Proved::kApart ? apart : proved == Proved::kContact ? contact : nothing) += 1;
      if (proved == Proved::kApart) {
        ASSERT_GT(distance, c.options.contact_distance) << "at " << t;
      }
      if (proved == Proved::kContact) {
        const Real unsure =
            pair.exact.hasTwoCylinders() ? 1e-12L * pair.exact.scale() : pair.exact.touchDistance();
        ASSERT_LE(distance, c.options.contact_distance + unsure) << "at " << t;
      }
    }
  }
  std::printf("%d apart, %d in contact, %d not proved\n", apart, contact, nothing);
  EXPECT_GT(apart, 250);
  EXPECT_GT(contact, 8);
  EXPECT_LT(nothing, 0.02 * (apart + contact + nothing));
}

TEST(Search, WhatTouchesExactlyIsNotApart) {
  const auto box = moving::placed(geometry::Box{{1, 1, 1}}), sphere = moving::placed(geometry::Sphere{0.5});
  const auto point = moving::placed(geometry::Point{});
  const struct {
    geometry::PlacedShape a, b;
    Vec3 d;
  } rows[] = {{box, box, {0.25, 0.5, 1.0}},
              {sphere, sphere, {0, 1.0, 0}},
              {box, point, {0.5, 0.25, 0.125}},
              {moving::sheet(1), point, {0.5, 0.25, 0}},
              {moving::sheet(1), moving::sheet(1), {2.0, 0.25, 0}},
              {moving::boxMesh({0.5, 0.5, 0.5}), sphere, {0.25, 0.25, -1.0}}};
  for (const auto& row : rows) {
    const moving::Pair pair({row.a}, {row.b}, {0, 1'000'000, moving::resting(), moving::resting(row.d)});
    Workspace workspace;
    Search search(pair.solver, kPlenty, workspace);
    ContactWitness witness;
    EXPECT_NE(search.classify(0.0, &witness), Proved::kApart)
        << row.a.shape.index() << ' ' << row.b.shape.index();
    EXPECT_TRUE(search.firstPossible(0.0, 1e-3, 1e-12).found);
    EXPECT_FALSE(search.nearPairs(0.0, 1e-3, 5).empty());
  }
}

TEST(Search, NearPairsHoldEveryPairThatTouches) {
  for (int i = 0; i < 80; ++i) {
    const fuzz::Case c = fuzz::makeCase(kSeed + 2, i);
    SCOPED_TRACE(c.describe());
    const moving::Pair pair = pairOf(c);
    const oracle::FirstTouch truth = pair.exact.firstTouch(0, c.duration(), 0, 100000);
    if (!truth.found || !truth.verified) continue;
    const double from = static_cast<double>(truth.hi) * (1 - 1e-9);
    const double to = std::min(c.duration(), static_cast<double>(truth.hi) * (1 + 1e-9));
    Workspace workspace;
    Search search(pair.solver, kPlenty, workspace);
    if (pair.exact.nearest(truth.hi).inside) continue;
    EXPECT_FALSE(search.nearPairs(from, to, 10).empty());
    EXPECT_LE(search.nearPairs(from, to, 1).size(), 1u);
  }
}

TEST(Search, OutOfReachIsAProof) {
  int out = 0, out_before_all = 0, begin_later = 0, end_sooner = 0;
  for (int i = 0; i < 120; ++i) {
    const fuzz::Case c = fuzz::makeCase(kSeed + 3, i);
    SCOPED_TRACE(c.describe());
    const moving::Pair pair = pairOf(c);
    Workspace workspace;
    const Span reach = Search(pair.solver, kPlenty, workspace).withinReach();
    const double end = c.duration();
    out += reach.empty();
    begin_later += !reach.empty() && reach.low > 0.0;
    end_sooner += !reach.empty() && reach.high < end;
    const auto apart = [&](Real t) { return pair.exact.distance(t) > c.options.contact_distance; };
    const bool before_all = outOfReach(pair.body_a, pair.body_b, pair.piece, c.options.contact_distance);
    out_before_all += before_all;
    for (int k = 0; k <= 2; ++k) {
      if (reach.empty() || before_all) {
        ASSERT_TRUE(apart(pair.exact.duration() * k / 2));
        continue;
      }
      if (reach.low > 0.0) {
        ASSERT_TRUE(apart(static_cast<Real>(reach.low) * k / 2));
      }
      if (reach.high < end) {
        ASSERT_TRUE(apart(reach.high + (pair.exact.duration() - reach.high) * k / 2));
      }
    }
  }
  EXPECT_GT(out, 6) << "seed " << kSeed + 3;
  EXPECT_GT(out_before_all, 6);
  EXPECT_GT(begin_later, 20);
  EXPECT_GT(end_sooner, 20);
}

TEST(Search, ReachBeginsAndEndsWhereReachesTouch) {
  // Two balls of 1 m and 0.5 m on parallel lines 0.9 m apart touch while |x| <= 1.2 m.
  const Piece piece{0, 1'000'000'000, moving::flight(0, 1'000'000'000, Vec3::Zero(), Vec3::Zero()),
                    moving::flight(0, 1'000'000'000, {-3.0, 0.9, 0.0}, {6.0, 0.0, 0.0})};
  const moving::Pair pair{
      {moving::placed(geometry::Sphere{1.0})}, {moving::placed(geometry::Sphere{0.5})}, piece};
  Workspace workspace;
  const Span reach = Search(pair.solver, kPlenty, workspace).withinReach();
  const double half = 1.2 / 6.0;
  EXPECT_LE(reach.low, 0.3);
  EXPECT_NEAR(reach.low, 0.5 - half, 1e-6);
  EXPECT_GE(reach.high, 0.7);
  EXPECT_NEAR(reach.high, 0.5 + half, 1e-6);
}

TEST(Search, OutOfReachBeforeAllIsSharp) {
  // Two balls of 1 m and 0.5 m on parallel lines, the one at 40 km in a world that moves by 7 km/s.
  const Vec3 home(4e4, 0.0, 0.0), wind(7e3, 0.0, 0.0);
  const geometry::Body a({moving::placed(geometry::Sphere{1.0})}), b({moving::placed(geometry::Sphere{0.5})});
  for (const double share : {-1.0, 0.0, 0.5, 1.0, 2.0}) {
    for (const double beside : {1.4, 1.5 - 1e-9, 1.5, 1.5 + 1e-9, 1.6}) {
      // Nearest to each other at that share of the piece.
      const Vec3 from = home + Vec3(-6.0 * share, beside, 0.0);
      Piece piece{0, 1'000'000'000, moving::flight(0, 1'000'000'000, home, wind),
                  moving::flight(0, 1'000'000'000, from, wind + Vec3(6.0, 0.0, 0.0))};
      SCOPED_TRACE("nearest at " + std::to_string(share) + ", beside " + std::to_string(beside));
      const bool within = share >= 0.0 && share <= 1.0;
      EXPECT_EQ(outOfReach(a, b, piece, 0.0), beside > 1.5 || !within);
      EXPECT_EQ(outOfReach(a, b, piece, 0.05), beside > 1.55 || !within);
      piece.tube = 0.05;
      EXPECT_EQ(outOfReach(a, b, piece, 0.0), beside > 1.55 || !within);
      piece.b.c[2] = Vec3(0.0, 1e-3, 0.0);
      EXPECT_FALSE(outOfReach(a, b, piece, 0.0)) << "no straight path";
    }
  }
}

/// A sphere of 5 mm flies past a torus, `offset` beside its axis.
moving::Pair pastTorus(double offset, const Vec3& omega_a, int around = 120) {
  const Piece piece{0, 33'333'333, moving::flight(0, 33'333'333, Vec3::Zero(), Vec3::Zero(), omega_a),
                    moving::flight(0, 33'333'333, {offset, 0.0, -33}, {0, 0, 2000})};
  return {{moving::torus(1.0, 0.3, around, around / 2)}, {moving::placed(geometry::Sphere{0.005})}, piece};
}

TEST(Search, PureTranslationNeedsNoTimeSubdivision) {
  for (const double offset : {0.0, 0.5, 1.0, 1.31}) {
    const moving::Pair pair = pastTorus(offset, Vec3::Zero());
    Workspace workspace;
    Search search(pair.solver, kPlenty, workspace);
    EXPECT_EQ(search.firstPossible(0.0, pair.solver.motion.duration(), 1e-12).found, offset == 1.0);
    EXPECT_EQ(search.subdivisions(), 0u) << "offset " << offset;
    EXPECT_LT(search.nodeTests(), 3000u) << "offset " << offset;
  }
}

TEST(Search, WorkStaysBoundedForANearMiss) {
  for (const double gap : {1e-3, 1e-6, 1e-9}) {
    const moving::Pair pair = pastTorus(1.0 + 0.3 + 0.005 + gap, Vec3::Zero());
    Workspace workspace;
    Search search(pair.solver, kPlenty, workspace);
    EXPECT_FALSE(search.firstPossible(0.0, pair.solver.motion.duration(), 1e-12).found) << "gap " << gap;
    EXPECT_LT(search.nodeTests(), 5000u) << "gap " << gap;
  }
  // The torus spins about its own axis, half a turn in the frame, a micrometre clear.
  const moving::Pair spinning = pastTorus(1.0 + 0.3 + 0.005 + 1e-6, Vec3(0, 0, 94.0));
  Workspace workspace;
  Search search(spinning.solver, kPlenty, workspace);
  EXPECT_FALSE(search.firstPossible(0.0, spinning.solver.motion.duration(), 1e-12).found);
  EXPECT_LT(search.nodeTests(), 50000u);
  std::printf("spinning near miss: %lu node tests, %lu subdivisions\n",
              static_cast<unsigned long>(search.nodeTests()),
              static_cast<unsigned long>(search.subdivisions()));
}

TEST(Search, ASpentBudgetIsReported) {
  const moving::Pair pair = pastTorus(1.0, Vec3(0, 0, 3));
  Workspace other;
  Search plenty(pair.solver, kPlenty, other);
  const Search::First truth = plenty.firstPossible(0.0, pair.solver.motion.duration(), 1e-12);
  ASSERT_TRUE(truth.found);
  for (const std::uint64_t budget : {0u, 1u, 3u, 10u}) {
    Workspace workspace;
    Search search(pair.solver, budget, workspace);
    const Search::First first = search.firstPossible(0.0, pair.solver.motion.duration(), 1e-12);
    EXPECT_TRUE(search.exhausted()) << "budget " << budget;
    EXPECT_TRUE(first.found) << "budget " << budget;
    EXPECT_LE(first.time, truth.time) << "budget " << budget;
    EXPECT_EQ(first.pair.a, -1) << "budget " << budget;
    EXPECT_LE(search.nodeTests(), budget + 100) << "budget " << budget;
  }
  EXPECT_FALSE(plenty.exhausted());
}

}  // namespace
}  // namespace collision_node::impact

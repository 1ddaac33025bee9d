/// The certified solver against the oracle on random pairs. COLLISION_NODE_LONG=1 runs 20 000 of the everyday
/// and of the wide mix and 100 degenerate ones (some 5 minutes, an hour and half a minute of one core),
/// COLLISION_NODE_FUZZ_INDEX=n one, COLLISION_NODE_FUZZ_SEED=n another series, COLLISION_NODE_FUZZ_FIRST=n
/// and COLLISION_NODE_FUZZ_COUNT=n a part of it. The oracle's 80 bits sometimes take needles of 1e-12 for
/// touching.
#include <gtest/gtest.h>

#include <cstdlib>
#include <iostream>

#include "collision_node/geometry/body.h"
#include "test/impact/fuzz_check.h"

namespace {

std::uint64_t numberFrom(const char* variable, std::uint64_t otherwise) {
  const char* value = std::getenv(variable);
  return value ? std::strtoull(value, nullptr, 10) : otherwise;
}

using MakeCase = fuzz::Case (*)(std::uint64_t seed, int index);

/// `count` cases from `first` on, each held against the oracle.
fuzz::Tally run(MakeCase make, std::uint64_t seed, int first, int count, bool describe) {
  fuzz::Tally tally;
  int failed = 0;
  for (int i = first; i < first + count; ++i) {
    const fuzz::Case c = make(seed, i);
    if (describe) std::cout << c.describe();
    const collision_node::geometry::Body a(c.a), b(c.b);
    const auto method = makeCertified(a, b, c.options);
    const std::vector<std::string> complaints = check(c, *method, &tally);
    failed += !complaints.empty();
    for (const std::string& line : complaints) {
      ADD_FAILURE() << line << "\nseed " << seed << " index " << i << " (" << c.kind << ")\n"
                    << (failed <= 10 ? c.describe() : std::string());
    }
  }
  std::cout << "seed " << seed << ", " << tally.cases << " pairs: " << tally.touching << " touch ("
            << tally.initial_overlaps << " from the start), " << tally.transversal << " transversal, "
            << tally.well_apart << " well apart\n"
            << "events " << tally.events << ", transversal first contacts confirmed " << tally.confirmed_first
            << ", cases with an undecided bracket " << tally.with_possible << ", undecided "
            << tally.undecided.size() << " (of them unprovable " << tally.unprovable
            << "), pairs with a march given up " << tally.gave_up << "\nwidest first bracket "
            << tally.worst_width << " W, earliest " << tally.worst_early << " W, sharp instants "
            << tally.sharp << " to " << tally.worst_sharp << " of the step, points checked "
            << tally.points_checked << " (largest ball " << tally.worst_ball << " m), normals checked "
            << tally.normals_checked << "\nmost node tests " << tally.most_node_tests << "; oracle "
            << tally.oracle_seconds << " s, method " << tally.method_seconds << " s\n";
  for (const auto& open : tally.undecided) {
    std::cout << "undecided: index " << open.index << " (" << open.kind << ")"
              << (open.budget_met ? ", budget spent" : "") << '\n';
  }
  EXPECT_EQ(failed, 0) << "of " << tally.cases << " pairs, seed " << seed;
  return tally;
}

/// What a mix of cases is made for; the march gives up where many turns pass near each other.
struct Mix {
  MakeCase make;
  int usual;  ///< pairs of a short run; a long one has `all`
  int all = 20000;
  double most_touching = 0.6;  ///< shares of the pairs
  double least_apart = 1.0 / 3;
  double most_given_up = 0.005;
  double most_undecided = 0.01;  ///< of those that could be decided
};

void runSeries(const Mix& mix) {
  const std::uint64_t seed = numberFrom("COLLISION_NODE_FUZZ_SEED", 1);
  const bool replay = std::getenv("COLLISION_NODE_FUZZ_INDEX") != nullptr;
  const std::uint64_t all =
      static_cast<std::uint64_t>(numberFrom("COLLISION_NODE_LONG", 0) != 0 ? mix.all : mix.usual);
  const int first =
      static_cast<int>(numberFrom("COLLISION_NODE_FUZZ_INDEX", numberFrom("COLLISION_NODE_FUZZ_FIRST", 0)));
  const int count = replay ? 1 : static_cast<int>(numberFrom("COLLISION_NODE_FUZZ_COUNT", all));
  const fuzz::Tally tally = run(mix.make, seed, first, count, replay);
  if (replay) return;
  EXPECT_GE(tally.touching, 2 * tally.cases / 5);
  EXPECT_LE(tally.touching, mix.most_touching * tally.cases);
  EXPECT_EQ(tally.confirmed_first, tally.transversal);
  EXPECT_GE(tally.transversal, tally.cases / 5) << "too few decisive hits to mean anything";
  EXPECT_GE(tally.well_apart, mix.least_apart * tally.cases);
  EXPECT_LE(static_cast<int>(tally.undecided.size()) - tally.unprovable,
            mix.most_undecided * tally.cases + 1);
  EXPECT_LE(tally.gave_up, mix.most_given_up * tally.cases + 1) << "the oracle itself could not tell";
}

TEST(Fuzz, EveryContactIsFoundAndEveryBoundHolds) { runSeries({fuzz::makeCase, 2000}); }

TEST(Fuzz, EveryContactIsFoundAtAllSizesSpeedsAndSpins) {
  runSeries({fuzz::makeWideCase, 300, 20000, 0.6, 1.0 / 3, 0.02});
}

TEST(Fuzz, EveryContactIsFoundBetweenDegenerateBodiesInExtremePieces) {
  runSeries({fuzz::makeEdgeCase, 30, 100, 0.8, 0.15, 0.02, 0.05});  // discs and needles within rounding
}

void expectNoComplaint(MakeCase make, std::uint64_t seed, int index) {
  const fuzz::Case c = make(seed, index);
  const collision_node::geometry::Body a(c.a), b(c.b);
  const auto method = makeCertified(a, b, c.options);
  for (const std::string& line : check(c, *method)) ADD_FAILURE() << line << "\n" << c.describe();
}

/// Seed 7, 916: a neighbouring triangle touched first, under another normal than the one reported. Seed 7,
/// 1117: a point through the surface of a body that has a solid part too.
TEST(Fuzz, FoundFailuresStayFixed) {
  for (const int index : {916, 1117}) expectNoComplaint(fuzz::makeCase, 7, index);
}

/// Inside a solid was only told some four budgets deep, more behind slivers: points entered and left within
/// up to 60 W.
TEST(Fuzz, FoundPointsThatEnterSolidsWithinW) {
  const std::pair<int, int> found[] = {{3, 122},  {4, 17},   {5, 473},  {5, 717},  {5, 864},
                                       {5, 1293}, {5, 1320}, {5, 1454}, {5, 1557}, {5, 2370}};
  for (const auto& [seed, index] : found) expectNoComplaint(fuzz::makeWideCase, seed, index);
}

/// Near a rim closest points told no normal, and a rim that was shrunk and grown back was no longer there.
TEST(Fuzz, FoundRimsOfCylindersWithinW) {
  const std::pair<int, int> found[] = {{4, 211}, {5, 122},  {5, 1679}, {6, 340},
                                       {6, 521}, {6, 1068}, {6, 1250}};
  for (const auto& [seed, index] : found) expectNoComplaint(fuzz::makeWideCase, seed, index);
}

/// Weights that volumes leave inexact took the proof at a contact distance from a triangle so large.
TEST(Fuzz, FoundMillimetresInATriangleOfAThousandKilometresStayInContact) {
  for (const int index : {1993, 2435, 11519, 11723, 13358})
    expectNoComplaint(fuzz::makeWideCase, 1127, index);
}

/// The closest points of a rim and a vertex had been searched too shortly to show the gap.
TEST(Fuzz, FoundRimBesideAVertexApart) { expectNoComplaint(fuzz::makeWideCase, 1130, 3633); }

/// The closest vector to a needle's edge, off by rounding along the edge, showed no gap.
TEST(Fuzz, FoundPointBesideANeedleApart) { expectNoComplaint(fuzz::makeWideCase, 5, 2878); }

/// What the oracle got wrong: a graze with a deep contact soon after it is none itself; a cylinder's and a
/// capsule's common point, and that of a rim on a cap, which 40 digits and more place where the event says;
/// the closing speed of a ball that comes at 0.1 m/s and whose surface turns at 2e8 m/s; an instant that it
/// knows less well than the event; the normal of two rims that meet only 0.1 ns after a rim was nearest to a
/// side (60 digits: the event's is right to 5e-8 rad).
TEST(Fuzz, FoundMistakesOfTheOracle) {
  for (const int index : {8696, 9010}) expectNoComplaint(fuzz::makeWideCase, 1, index);
  expectNoComplaint(fuzz::makeCase, 20261, 134);
  expectNoComplaint(fuzz::makeCase, 1139, 7356);
  expectNoComplaint(fuzz::makeWideCase, 7, 11381);
  expectNoComplaint(fuzz::makeWideCase, 11, 4918);
}

/// Common speeds summed by components made a straight path's budget too large; of a capsule that leaves a
/// cylinder too short a time was asked for to be proved apart.
TEST(Fuzz, FoundBracketsOfCommonSpeedsAndOfPartingsWithinW) {
  for (const int index : {6036, 6522, 7616, 16094, 16467}) expectNoComplaint(fuzz::makeWideCase, 7, index);
}

/// A point rides along a face, too shallow to say whether inside, and leaves a box through another face.
TEST(Fuzz, FoundPartingBehindARideAlongAFace) { expectNoComplaint(fuzz::makeWideCase, 11, 909); }

/// The ball held what a spinning point's own turn would do to the normal of a capsule.
TEST(Fuzz, FoundBallOfASpinningPoint) { expectNoComplaint(fuzz::makeWideCase, 7, 15163); }

/// A point through the hub of a fan with a triangle twice: no patch was proved to be passed.
TEST(Fuzz, FoundPassageThroughDuplicatedTriangles) { expectNoComplaint(fuzz::makeEdgeCase, 3, 323); }

}  // namespace

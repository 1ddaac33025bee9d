// Two contestants' answers, judged by each other: nothing is hidden.
#include <gtest/gtest.h>

#include "collision_node/report/comparison.h"

namespace {

using namespace collision_node::report;

Answer hit(double lower, double upper, double closing_speed = 1.0) {
  return {Verdict::kHit, lower, upper, closing_speed};
}
const Answer kApart{Verdict::kClear, 0.0, 0.0, 0.0}, kUnknown{Verdict::kUndecided, 0.0, 0.0, 0.0};

TEST(Comparison, a_hit_on_one_side_alone_is_missed_on_the_other) {
  const Comparison c =
      compare({kApart, hit(0.5, 0.5), hit(0.5, 0.5)}, {hit(0.5, 0.5), kApart, kApart}, 0, 0, 0);
  EXPECT_EQ(c.hits, 2u);
  EXPECT_EQ(c.ours.missed, 1u);
  EXPECT_EQ(c.ours.false_hits, 2u);
  EXPECT_EQ(c.reference.missed, 2u);
  EXPECT_EQ(c.reference.false_hits, 1u);
}

TEST(Comparison, no_answer_is_counted_and_judged_no_further) {
  const Comparison c =
      compare({kUnknown, kApart, hit(0.5, 0.5)}, {hit(0.1, 0.1), kUnknown, kUnknown}, 0, 0, 0);
  EXPECT_EQ(c.ours.undecided, 1u);
  EXPECT_EQ(c.reference.undecided, 2u);
  EXPECT_EQ(c.ours.missed + c.reference.missed + c.ours.late + c.reference.late, 0u);
}

TEST(Comparison, late_is_a_time_after_contact_on_the_other_side) {
  const Comparison c = compare({hit(0.5, 0.5), hit(0.5, 0.6)}, {hit(0.75, 0.75), hit(0.6, 0.6)}, 0, 0, 0);
  EXPECT_EQ(c.reference.late, 1u);
  EXPECT_EQ(c.reference.worst_late, 0.25);
  EXPECT_EQ(c.ours.late, 0u);
  EXPECT_EQ(c.worst_error, 0.25);
}

TEST(Comparison, ours_is_late_against_a_peer_that_stops_before_contact_only_by_more_than_it_stops) {
  const std::vector<Answer> ours = {hit(0.5, 0.5, 2.0)}, peer = {hit(0.25, 0.25)};
  EXPECT_EQ(compare(ours, peer, 0, 0, 0).ours.late, 1u);
  EXPECT_EQ(compare(ours, peer, 0, 0.24, 0).ours.late, 1u);
  EXPECT_EQ(compare(ours, peer, 0, 0.25, 0).ours.late, 0u);
  EXPECT_EQ(compare(ours, peer, 0, 0, 0.25).ours.late, 0u);
}

}  // namespace

// What a score counts: nothing is hidden, and a bound that does not hold is seen.
#include <gtest/gtest.h>

#include <cmath>

#include "collision_node/report/score.h"

namespace {

using namespace collision_node::report;
using collision_node::geometry::Vec3;

Truth hitTruth() {
  Truth truth;
  truth.verdict = Verdict::kHit;
  truth.toi = 0.5, truth.toi_error = 1e-12;
  truth.point = Vec3(1.0, 0.0, 0.0), truth.point_error = 1e-12;
  return truth;
}

Answer certified(double lower, double upper, double ball, const Vec3& point = Vec3(1.0, 0.0, 0.0)) {
  Answer answer;
  answer.verdict = Verdict::kHit;
  answer.toi_lower = lower, answer.toi_upper = upper;
  answer.point = point, answer.position_error = ball;
  answer.certified = true;
  return answer;
}

Score scoreOfOne(const Truth& truth, const Answer& answer) {
  Trials trials;
  trials.truths = {truth};
  return scoreOf(trials, {answer}, {1e-6});
}

TEST(Score, a_bracket_and_a_ball_that_hold_the_truth_break_nothing) {
  const Score score = scoreOfOne(hitTruth(), certified(0.5 - 1e-9, 0.5 + 2e-9, 1e-6));
  EXPECT_EQ(score.found, 1u);
  EXPECT_EQ(score.broken_bounds, 0u);
  EXPECT_NEAR(score.toi_error.max, 2e-9, 1e-15);
  EXPECT_NEAR(score.claimed_time.max, 3e-9, 1e-15);
}

TEST(Score, a_bound_that_does_not_hold_is_counted) {
  EXPECT_EQ(scoreOfOne(hitTruth(), certified(0.5 + 1e-9, 0.6, 1.0)).broken_bounds, 1u);
  EXPECT_EQ(scoreOfOne(hitTruth(), certified(0.4, 0.5 - 1e-9, 1.0)).broken_bounds, 1u);
  EXPECT_EQ(scoreOfOne(hitTruth(), certified(0.4, 0.6, 1e-6, Vec3(1.0, 1e-5, 0.0))).broken_bounds, 1u);
  Answer possible = certified(0.5 + 1e-9, 1.0, 1.0);
  possible.verdict = Verdict::kUndecided;  // even POSSIBLE claims that nothing touches before it
  EXPECT_EQ(scoreOfOne(hitTruth(), possible).broken_bounds, 1u);
}

TEST(Score, the_truths_own_error_is_nobodys_fault) {
  Truth truth = hitTruth();
  truth.toi_error = 1e-8;
  EXPECT_EQ(scoreOfOne(truth, certified(0.5 + 1e-9, 0.6, 1.0)).broken_bounds, 0u);
}

TEST(Score, counts_misses_false_hits_late_answers_and_no_answers) {
  Truth clear;
  clear.verdict = Verdict::kClear;
  Answer none, hit = certified(0.6, 0.6, 0.0);
  hit.certified = false;
  Answer nothing;
  nothing.verdict = Verdict::kClear;
  EXPECT_EQ(scoreOfOne(hitTruth(), nothing).missed, 1u);
  EXPECT_EQ(scoreOfOne(clear, hit).false_hits, 1u);
  EXPECT_EQ(scoreOfOne(hitTruth(), none).undecided, 1u);
  const Score late = scoreOfOne(hitTruth(), hit);
  EXPECT_EQ(late.late, 1u);
  EXPECT_NEAR(late.worst_late, 0.1, 1e-9);
  EXPECT_EQ(scoreOfOne(Truth(), hit).unjudged, 1u);
}

TEST(Spread, is_that_of_the_sorted_values) {
  const Spread spread = spreadOf({3.0, 1.0, 2.0});
  EXPECT_EQ(spread.p50, 2.0);
  EXPECT_EQ(spread.p99, 3.0);
  EXPECT_EQ(spread.max, 3.0);
  EXPECT_TRUE(std::isnan(spreadOf({}).max));
}

}  // namespace

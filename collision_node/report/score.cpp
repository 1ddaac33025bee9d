#include "collision_node/report/score.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace collision_node::report {
namespace {

/// Whether the claimed bracket and ball hold the truth, given how well the truth itself is known.
bool holds(const Answer& answer, const Truth& truth) {
  if (answer.toi_lower > truth.toi + truth.toi_error || answer.toi_upper < truth.toi - truth.toi_error)
    return false;
  const double off = (answer.point - truth.point).norm() - truth.point_error;
  return !(off > answer.position_error);  // an unknown point or ball claims nothing
}

/// A POSSIBLE answer claims that nothing touches before its bracket.
bool certifiedTooLate(const Answer& answer, const Truth& truth) {
  return answer.certified && answer.toi_lower > truth.toi + truth.toi_error;
}

}  // namespace

Spread spreadOf(std::vector<double> values) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  if (values.empty()) return {kNone, kNone, kNone};
  std::sort(values.begin(), values.end());
  const auto at = [&values](double share) {
    return values[static_cast<std::size_t>(std::ceil(share * static_cast<double>(values.size()))) - 1];
  };
  return {at(0.5), at(0.99), values.back()};
}

Score scoreOf(const Trials& trials, const std::vector<Answer>& answers, const std::vector<double>& seconds) {
  Score score;
  score.asked = answers.size();
  std::vector<double> toi_error, point_error, claimed_time, claimed_ball;
  for (std::size_t i = 0; i < answers.size(); ++i) {
    const Answer& answer = answers[i];
    const Truth& truth = trials.truths[i];
    if (answer.verdict == Verdict::kUndecided) ++score.undecided;
    if (truth.verdict == Verdict::kUndecided) {
      ++score.unjudged;
      continue;
    }
    const bool hit = truth.verdict == Verdict::kHit;
    if (hit) ++score.hits;
    if (answer.verdict == Verdict::kUndecided) {
      if (hit && certifiedTooLate(answer, truth)) ++score.broken_bounds;
      continue;
    }
    if (hit && answer.verdict == Verdict::kClear) ++score.missed;
    if (!hit && answer.verdict == Verdict::kHit) ++score.false_hits;
    if (!hit || answer.verdict == Verdict::kClear) continue;

    ++score.found;
    const double late = answer.toi_lower - truth.toi - truth.toi_error;
    if (late > kPrecision) ++score.late, score.worst_late = std::max(score.worst_late, late);
    toi_error.push_back(
        std::max(std::abs(answer.toi_lower - truth.toi), std::abs(answer.toi_upper - truth.toi)));
    const double off = (answer.point - truth.point).norm();
    if (std::isfinite(off)) point_error.push_back(off);
    if (!answer.certified) continue;
    if (!holds(answer, truth)) ++score.broken_bounds;
    claimed_time.push_back(answer.toi_upper - answer.toi_lower);
    if (std::isfinite(answer.position_error)) claimed_ball.push_back(answer.position_error);
  }
  score.toi_error = spreadOf(toi_error);
  score.point_error = spreadOf(point_error);
  score.claimed_time = spreadOf(claimed_time);
  score.claimed_ball = spreadOf(claimed_ball);
  score.seconds = spreadOf(seconds);
  return score;
}

}  // namespace collision_node::report

/// How good a method's answers to one scene are, and what they cost.
#pragma once

#include <cstddef>
#include <vector>

#include "collision_node/report/trial.h"

namespace collision_node::report {

/// NaN where there is nothing to sort.
struct Spread {
  double p50, p99, max;
};
Spread spreadOf(std::vector<double> values);

struct Score {
  std::size_t asked = 0;     ///< answers given; the scene may hold more queries
  std::size_t hits = 0;      ///< true contacts among those asked
  std::size_t unjudged = 0;  ///< whose truth is not known
  std::size_t found = 0;     ///< true contacts that were answered as hits
  std::size_t missed = 0, false_hits = 0, undecided = 0;
  std::size_t late = 0;     ///< hits whose toi_lower lies after the truth by more than kPrecision
  double worst_late = 0.0;  ///< [s]
  std::size_t broken_bounds =
      0;                ///< certified answers (POSSIBLE too) whose bracket or ball does not hold the truth
  Spread toi_error;     ///< [s] over `found`: of the end of the bracket that is farther from the truth
  Spread point_error;   ///< [m] over `found` where both points are known
  Spread claimed_time;  ///< [s] over `found`, certified ones: the bracket's width
  Spread claimed_ball;  ///< [m] over `found`, certified ones: position_error
  Spread seconds;       ///< thread CPU time of one query
};

/// `answers` and `seconds` belong to the first queries of `trials`, in order.
Score scoreOf(const Trials& trials, const std::vector<Answer>& answers, const std::vector<double>& seconds);

}  // namespace collision_node::report

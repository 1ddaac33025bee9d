/// Runs rows and keeps what was seen.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "collision_node/report/benchmarks/rows.h"

namespace collision_node::report {

/// One contestant on one row.
struct Outcome {
  std::string name;
  double seconds = 0.0;  ///< thread CPU time of one query, mean over the set, smallest of the repeats
  std::vector<Answer> answers;
  double stops_at_gap = 0.0, time_rounding = 0.0;  ///< as Contestant states them
};

struct RowOutcome {
  Outcome ours;
  std::optional<Outcome> reference;
};

/// Thread CPU time [s] of one call of each, by turns: the smallest of three repeats, each of 50 ms or one
/// call.
std::vector<double> timeByTurns(const std::vector<std::function<void()>>& calls);

/// Ours and the reference on `count` queries, one thread.
RowOutcome run(const Row& row, std::size_t count, bool only_ours);

}  // namespace collision_node::report

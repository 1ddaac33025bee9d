/// Bags in, impacts out; no master, no clock.
#pragma once

#include <ostream>

#include "collision_node/replay/options.h"

namespace collision_node::replay {

/// Exit codes: 0 done, 2 bad input (one line each on `err`), 3 some query met its budget, 130 interrupted.
constexpr int kDone = 0, kBadInput = 2, kBudgetMet = 3, kInterrupted = 130;

/// Runs one replay. The same bags and scene give the same bytes on `out` and in every file, unless
/// options.timing. `progress`: draw a bar on `err`. Bad input writes no file, except damage in the middle of
/// a bag: then the results of what came before are kept, and the code is kBadInput. An interrupt
/// (interrupts.h) ends the run as if the recording had been cut there with --to; a second one ends it at
/// once, without files.
int run(const Options& options, std::ostream& out, std::ostream& err, bool progress);

}  // namespace collision_node::replay

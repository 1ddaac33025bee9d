/// What `report` can do: one function for each mode, each the exit code of the program. Bad input throws
/// std::exception with lines for people.
#pragma once

#include <iosfwd>

#include "collision_node/report/options.h"

namespace collision_node::report {

constexpr int kDone = 0, kClaimBroken = 1, kBadInput = 2;

/// Methods x scenes with truth. kClaimBroken when ours missed, or a bound of ours does not hold.
int runErrorAgainstTime(const Options& options, std::ostream& out);

/// Each hard direction until every method breaks.
int runStability(const Options& options, std::ostream& out);

/// Methods on a user's own scene and bags; our tightest answer is the reference.
int runOwnScene(const Options& options, std::ostream& out);

/// Error against run time of a recorded run.
int runFromBag(const Options& options, std::ostream& out);

}  // namespace collision_node::report

/// Holds a method's answer on one case against the oracle.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "test/impact/fuzz_truth.h"

namespace fuzz {

/// Sums over a run, for the printed summary.
struct Tally {
  int cases = 0, touching = 0, transversal = 0, well_apart = 0, initial_overlaps = 0;
  int confirmed_first = 0, with_possible = 0, events = 0, gave_up = 0;
  int points_checked = 0, normals_checked = 0;
  int sharp = 0;  ///< hits so fast that the instant is owed to 1e-12 of the step
  /// The first contact is neither proved nor excluded, or the budget was spent.
  struct Undecided {
    int index;
    std::string kind;
    bool budget_met;
  };
  std::vector<Undecided> undecided;
  int unprovable =
      0;  ///< of them: two bare points, or within 1e3 budget of touching at the start and never far from it
  std::uint64_t most_node_tests = 0;
  double worst_sharp = 0;  ///< error of such an instant, in steps
  double worst_width = 0;  ///< of a transversal first impact, in W
  double worst_early = 0;  ///< true contact minus toi_lower of a transversal first impact, in W
  double worst_ball = 0;   ///< position_error of a transversal first impact with a unique point [m]
  double oracle_seconds = 0, method_seconds = 0;
};

/// Runs the method on the case; one line per broken promise, none when all hold.
std::vector<std::string> check(const Case& c, const collision_node::impact::PairMethod& method,
                               Tally* tally = nullptr);

}  // namespace fuzz

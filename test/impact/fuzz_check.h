/// Holds a method's answer on one case against the oracle.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "test/impact/fuzz_case.h"

namespace fuzz {

/// What the oracle knows about a case.
struct Truth {
  oracle::Real budget = 0;  ///< [m] "near rounding" in this test: 1e-12 of (size + path)
  bool overlaps_at_start = false;
  bool apart_at_start = false;  ///< by more than the budget; neither: too near to say
  bool well_apart = false;      ///< always farther than 1e-6 of the smaller body
  oracle::FirstTouch first;     ///< when apart at the start
  bool transversal =
      false;  ///< the first contact is neither grazing nor near rounding nor at the piece's ends
  oracle::Real closing_speed = 0;  ///< [m/s] along the normal, at the first contact
  oracle::Real width = 0;          ///< [s] W of the first contact
  bool point_known = false;        ///< one point only
  oracle::V3 point;                ///< relative to a's first position
  bool normal_known = false;
  oracle::V3 normal;               ///< from a to b
  oracle::Real normal_spread = 0;  ///< [rad] how far the oracle's own normal is to be trusted
};

Truth truthOf(const Case& c, const oracle::Pair& pair);

/// Sums over a run, for the printed summary.
struct Tally {
  int cases = 0, touching = 0, transversal = 0, well_apart = 0, initial_overlaps = 0;
  int confirmed_first = 0, with_possible = 0, events = 0, gave_up = 0;
  int points_checked = 0, normals_checked = 0;
  std::uint64_t most_node_tests = 0;
  double worst_width = 0;  ///< of a transversal first impact, in W
  double worst_early = 0;  ///< true contact minus toi_lower of a transversal first impact, in W
  double worst_ball = 0;   ///< position_error of a transversal first impact with a unique point [m]
  double oracle_seconds = 0, method_seconds = 0;
};

/// Runs the method on the case; one line per broken promise, none when all hold.
std::vector<std::string> check(const Case& c, const collision_node::impact::PairMethod& method,
                               Tally* tally = nullptr);

}  // namespace fuzz

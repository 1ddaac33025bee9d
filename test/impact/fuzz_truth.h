/// What the oracle knows about a random case, sorted by how sure it is.
#pragma once

#include "test/impact/fuzz_case.h"

namespace fuzz {

constexpr std::int64_t kMarchSteps = 300000;  ///< then the oracle gives up, which is counted

oracle::Real angleBetween(const oracle::V3& a, const oracle::V3& b);  ///< [rad]

/// What the oracle knows about a case.
struct Truth {
  oracle::Real budget = 0;  ///< [m] the solver's stated rounding budget; all else here is judged without it
  bool overlaps_at_start = false;
  bool overlaps_deeply = false;  ///< at the start, by more than 1e3 budget any way
  bool apart_at_start = false;   ///< by more than the budget; neither: too near to say
  bool well_apart = false;       ///< always farther than 1e3 budget
  oracle::FirstTouch first;      ///< when apart at the start
  /// The first contact closes at 1e6 budget per piece or more, gets 1e3 budget deep, and is not at the
  /// piece's ends.
  bool transversal = false;
  oracle::Real closing_speed = 0;  ///< [m/s] along the normal, at the first contact
  oracle::Real width = 0;          ///< [s] W of the first contact
  bool point_known = false;        ///< one point only
  oracle::V3 point;                ///< relative to a's first position
  oracle::Real point_spread = 0;   ///< [m] how far the oracle's own point is to be trusted
  bool point_sharp = false;        ///< and it moves little while the gap closes: a small ball is possible
  bool normal_known = false;
  oracle::V3 normal;               ///< from a to b
  oracle::Real normal_spread = 0;  ///< [rad] how far the oracle's own normal is to be trusted
};

Truth truthOf(const Case& c, const oracle::Pair& pair);

}  // namespace fuzz

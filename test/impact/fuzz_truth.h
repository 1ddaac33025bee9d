/// What the oracle knows about a random case, sorted by how sure it is.
#pragma once

#include "test/impact/fuzz_case.h"

namespace fuzz {

constexpr std::int64_t kMarchSteps = 300000;  ///< then the oracle gives up, which is counted

oracle::Real angleBetween(const oracle::V3& a, const oracle::V3& b);  ///< [rad]

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
  bool point_sharp = false;        ///< and it moves little while the gap closes: a small ball is possible
  bool normal_known = false;
  oracle::V3 normal;               ///< from a to b
  oracle::Real normal_spread = 0;  ///< [rad] how far the oracle's own normal is to be trusted
};

Truth truthOf(const Case& c, const oracle::Pair& pair);

}  // namespace fuzz

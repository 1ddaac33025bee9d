/// What two contestants' answers to the same queries say about each other.
#pragma once

#include <cstddef>
#include <vector>

#include "collision_node/report/contestant.h"

namespace collision_node::report {

/// One side, judged by the other.
struct Faults {
  std::size_t missed = 0;      ///< clear here, a hit there
  std::size_t false_hits = 0;  ///< a hit here, clear there
  std::size_t late = 0;        ///< both hit, here proved or stated contact there before this one's time
  std::size_t undecided = 0;   ///< no answer here: judged no further, neither side
  double worst_late = 0.0;     ///< [s]
};

struct Comparison {
  std::size_t hits = 0;  ///< found by ours, CONFIRMED
  Faults ours, reference;
  double worst_error = 0.0;  ///< [s] largest difference of the two times where both hit
};

/// The reference is late when its time lies more than `precision` [s] after toi_upper, where contact is
/// proved. Ours is late when toi_lower lies more than `precision` after the reference's time and what the
/// reference says its time may be too early: `gap` [m] over half the closing speed at the contact (paths
/// curve), and `rounding` [s].
Comparison compare(const std::vector<Answer>& ours, const std::vector<Answer>& reference, double precision,
                   double gap, double rounding);

}  // namespace collision_node::report

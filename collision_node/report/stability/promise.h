/// What a method gives its word for, and whether it kept it.
#pragma once

#include <vector>

#include "collision_node/report/methods.h"
#include "collision_node/report/stability/group.h"

namespace collision_node::report {

/// By its own documentation or construction (report/methods/). Shares are of the piece.
struct Promise {
  double gap = 0.0;       ///< [m] it may call a contact
  double path_gap = 0.0;  ///< the same, as a share of how far the bodies move
  double late = 0.0;      ///< share of the duration by which its time may be late
  double early = 0.0;     ///< and early, beside what the gap makes of it
};

struct Walker {
  Method method;
  Promise promise;
};

/// Ours as it is by default, then one of each other family that is installed.
std::vector<Walker> allWalkers();

/// One answer, held against the truth. Only the last five are wrong: a method that says it does not know is
/// honest.
enum class Mark { kKept, kUndecided, kMissed, kFalse, kLate, kEarly, kBound };
constexpr int kMarks = 7;

/// A certified answer owes a bracket and a ball that hold the truth; a POSSIBLE one owes that nothing comes
/// before its bracket. Any other owes a time within its promise and kPrecision, and no hit where the pair
/// keeps farther apart than its gap; nearer, such a hit counts as undecided.
Mark markOf(const Answer& answer, const Group& group, std::size_t trial, const Promise& promise);

}  // namespace collision_node::report

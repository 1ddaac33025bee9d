/// Holds what an event says of the first contact's place, normal and velocities against the oracle.
#pragma once

#include <string>
#include <vector>

#include "test/impact/fuzz_truth.h"

namespace fuzz {

/// As printf, into a string.
std::string text(const char* format, ...) __attribute__((format(printf, 1, 2)));

/// What could be checked: it needs one contact only.
struct Facts {
  bool point = false, normal = false;
};

/// Appends one line per broken promise. `e` is the event of a transversal first contact.
Facts checkFacts(const Case& c, const oracle::Pair& pair, const Truth& truth,
                 const collision_node::impact::PairEvent& e, std::vector<std::string>& complaints);

}  // namespace fuzz

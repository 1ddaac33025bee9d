/// `replay merge`: adjoining windows of a recording -> what one run over all of them says.
#pragma once

#include <ostream>
#include <string>
#include <vector>

namespace collision_node::replay {

struct MergeOptions {
  std::vector<std::string> files;  ///< JSON lines of windows, in any order
  std::string jsonl = "-";         ///< where the result goes
};

/// Throws InputError that names the argument. `arguments`: without "merge".
MergeOptions parseMergeOptions(const std::vector<std::string>& arguments);

/// Writes the events of all windows in order, numbered as one run numbers them: the same bytes as one run
/// over the time they cover, whose own cuts are left out where they cover the whole recording. Returns kDone.
/// Throws InputError: a file that is no window or not whole; windows of different scenes, methods or
/// recordings; a hole, an overlap, the same window twice; windows that do not agree on the state at their
/// cut. Nothing is written then.
int merge(const MergeOptions& options, std::ostream& out);

}  // namespace collision_node::replay

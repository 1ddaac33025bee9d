/// Runs one method on one scene.
#pragma once

#include <limits>
#include <string>

#include "collision_node/report/methods.h"
#include "collision_node/report/score.h"

namespace collision_node::report {

/// One line of the results.
struct Row {
  std::string scene, family, method;
  std::string reason;  ///< why the method was not run here; empty: it was
  std::size_t queries = 0;
  double step = 0.0;         ///< [s] length of the scene's first piece
  double truth_error = 0.0;  ///< [s] the truth is known at least this well
  Score score;
  double bytes = std::numeric_limits<double>::quiet_NaN();  ///< what the method added to the meshes as loaded
};

/// Asks the queries in order until they are done or `most_seconds` of CPU time are over; at least one. A
/// query's time is thread CPU time, the smallest of up to three runs of at least 20 us each; what belongs to
/// a query is made inside.
Row measure(const Method& method, const Trials& trials, double most_seconds);

}  // namespace collision_node::report

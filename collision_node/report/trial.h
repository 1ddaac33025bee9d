/// Queries whose answer is known from somewhere else than our solver.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "collision_node/report/contestant.h"

namespace collision_node::report {

/// NaN: not known. Where `verdict` is kUndecided nobody knows, and nobody is judged.
struct Truth {
  Verdict verdict = Verdict::kUndecided;
  double toi =
      std::numeric_limits<double>::quiet_NaN();  ///< [s] of the first contact, from the piece's start
  double toi_error = std::numeric_limits<double>::quiet_NaN();  ///< [s] the true time is within this of `toi`
  geometry::Vec3 point =  ///< [m] world; of the first contact, if it is one point
      geometry::Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
  double point_error = std::numeric_limits<double>::quiet_NaN();  ///< [m]
};

/// A scene of the report: bodies, queries, and the truth of each query.
struct Trials {
  std::string name;   ///< one word
  std::string about;  ///< one line, for tables
  QuerySet set;
  std::vector<Truth> truths;  ///< truths[i] belongs to set.queries[i]
};

}  // namespace collision_node::report

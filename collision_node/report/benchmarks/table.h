/// The table at the end, as Markdown.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "collision_node/report/benchmarks/run.h"
#include "collision_node/report/comparison.h"

namespace collision_node::report {

/// One line. Missing parts print as a dash.
struct Line {
  std::string row, ours, reference;
  std::string reference_name;
  std::optional<double> ratio;  ///< reference's cost over ours
  double reach = 0.0;           ///< the ratio wanted; 0: none is
  std::string quality;          ///< hits and faults of both sides
};

Line lineOf(const Row& row, const RowOutcome& outcome);
/// Of times that were taken elsewhere [s].
Line lineOf(const std::string& row, double here, double there, const std::string& name, double reach,
            const std::string& quality);

/// Seconds with a unit and three digits.
std::string readable(double seconds);

void print(const std::vector<Line>& lines);

}  // namespace collision_node::report

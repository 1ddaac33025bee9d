/// Results as a CSV file: report/present.py makes tables and diagrams of it.
#pragma once

#include <iosfwd>
#include <vector>

#include "collision_node/report/measure.h"

namespace collision_node::report {

/// SI units; an empty cell is a number that is not defined. Columns: docs/report.md.
void writeResults(std::ostream& out, const std::vector<Row>& rows);

/// A cell: shortest digits that say five of them, empty for NaN.
std::string cell(double value);

}  // namespace collision_node::report

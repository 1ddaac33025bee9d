/// A walk as files: every cell as CSV (present_stability.py draws it), the ranges as Markdown.
#pragma once

#include <iosfwd>
#include <vector>

#include "collision_node/report/stability/walk.h"

namespace collision_node::report {

/// Columns: docs/stability.md.
void writeCells(std::ostream& out, const std::vector<Walk>& walks);

/// In which range each method keeps its promise, and in which it decides every trial besides.
void writeRanges(std::ostream& out, const std::vector<Walk>& walks);

}  // namespace collision_node::report

/// What is measured: each row one set of queries, ours, and the reference it is held against.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "collision_node/report/contestant.h"

namespace collision_node::report {

struct Row {
  std::string name;
  std::size_t count = 0;
  std::function<QuerySet(std::size_t)> queries;
  std::function<ContestantPtr(const QuerySet&)> reference_of;  ///< null result: not installed here
  double reach = 0.0;       ///< reference's time over ours that the row should reach
  bool same_motion = true;  ///< the reference answers the same question: the answers can be compared
};

const std::vector<Row>& rows();

}  // namespace collision_node::report

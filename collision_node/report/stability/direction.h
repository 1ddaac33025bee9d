/// The hard directions, each a ladder of values with trials at every rung.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "collision_node/report/random.h"
#include "collision_node/report/stability/group.h"

namespace collision_node::report {

struct Direction {
  std::string name;  ///< one word
  std::string about, unit;
  std::vector<double> values;  ///< in the order of the walk; 0 stands for the end of a ladder towards 0
  std::size_t easy = 0;        ///< the rung from which a range is counted, up and down
  std::function<std::vector<Group>(double value, int count, Random& random)> groups;
};

/// `quick`: fewer and smaller rungs.
std::vector<Direction> allDirections(bool quick);

}  // namespace collision_node::report

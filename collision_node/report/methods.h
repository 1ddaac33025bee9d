/// All methods that the report compares.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "collision_node/report/contestant.h"

namespace collision_node::report {

struct Method {
  std::string family;   ///< one curve of a diagram: "ours", "subdivision", "fcl advancement" ...
  std::string name;     ///< unique: the family and its setting, "subdivision 100"
  std::string takes;    ///< the shapes and motions that it answers, for people
  std::string library;  ///< that it needs; empty: none
  bool installed = true;
  std::function<ContestantPtr(const QuerySet&)> make;  ///< null result: not for this set
};

std::vector<Method> allMethods();

}  // namespace collision_node::report

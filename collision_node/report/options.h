/// What the command line of `report` asks for.
#pragma once

#include <string>
#include <vector>

namespace collision_node::report {

struct Options {
  enum class Mode { kErrorAgainstTime, kStability, kOwnScene, kFromBag, kHelp };
  Mode mode = Mode::kErrorAgainstTime;
  bool quick = false;             ///< fewer queries: under a minute
  std::string out = "report";     ///< folder for what is written; made when missing
  std::string scene;              ///< kOwnScene
  std::vector<std::string> bags;  ///< kOwnScene; kFromBag: one, as replay's --out or a recorder wrote it
};

extern const char kUsage[];

/// Throws std::invalid_argument with one line that says what is wrong and what would be right.
Options parseOptions(const std::vector<std::string>& arguments);

}  // namespace collision_node::report

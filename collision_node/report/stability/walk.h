/// Every method at every rung of every direction, and how far each keeps its promise.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "collision_node/report/methods.h"
#include "collision_node/report/stability/direction.h"
#include "collision_node/report/stability/promise.h"

namespace collision_node::report {

/// One method at one rung. The marks, `not_asked` and `not_offered` add up to the rung's trials.
struct Cell {
  std::array<int, kMarks> marks{};
  int not_asked = 0;     ///< its time for this rung was over
  int not_offered = 0;   ///< its interface cannot state the trial
  double bracket = 0.0;  ///< [s] the widest, of certified answers that kept their promise on a contact
  double slowest = 0.0;  ///< [s] CPU time of one answer

  int count(Mark mark) const { return marks[static_cast<std::size_t>(mark)]; }
  int wrong() const;
  int asked() const;
};

struct Walk {
  Direction direction;
  std::vector<std::string> methods;
  std::vector<std::vector<Cell>> cells;  ///< [method][rung]
};

/// The rungs around the easy one over which a method was asked at every rung and is never wrong.
struct Range {
  bool offered = false;             ///< it could answer something somewhere
  bool empty = true;                ///< wrong (or not asked) at the easy rung
  double lower = 0.0, upper = 0.0;  ///< values of the first and last rung in the order of the walk
  bool whole = false;               ///< all rungs
};
Range rangeOf(const Walk& walk, std::size_t method, bool decided);

struct WalkOptions {
  bool quick = false;
  bool only_ours = false;
  int count = 12;        ///< trials of each kind at a rung
  double seconds = 3.0;  ///< CPU time a method other than ours may take for one kind at one rung
  std::function<void(const Direction&)> begins;  ///< told before each direction; may be empty
};

/// Methods that are not installed are left out; ours is first. The same seeds for every method.
std::vector<Walk> walkAll(const WalkOptions& options);

}  // namespace collision_node::report

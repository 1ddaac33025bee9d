#include <iostream>

#include "collision_node/report/modes.h"
#include "collision_node/report/stability/walk.h"

namespace collision_node::report {

int runStability(const Options& options, std::ostream& out) {
  WalkOptions walk_options;
  walk_options.quick = options.quick;
  if (options.quick) {
    walk_options.count = 6;
    walk_options.seconds = 0.1;
  }
  walk_options.begins = [&](const Direction& direction) { out << direction.name << std::endl; };
  for (const Walk& walk : walkAll(walk_options)) {
    for (std::size_t m = 0; m < walk.methods.size(); ++m) {
      for (std::size_t r = 0; r < walk.direction.values.size(); ++r) {
        const Cell& c = walk.cells[m][r];
        if (c.asked() == 0) continue;
        out << walk.direction.name << ' ' << walk.direction.values[r] << ' ' << walk.methods[m] << " kept "
            << c.marks[0] << " und " << c.marks[1] << " mis " << c.marks[2] << " fal " << c.marks[3] << " late "
            << c.marks[4] << " early " << c.marks[5] << " bound " << c.marks[6] << " na " << c.not_asked << " no "
            << c.not_offered << " br " << c.bracket << " slow " << c.slowest << '\n';
      }
    }
  }
  return kDone;
}

}  // namespace collision_node::report

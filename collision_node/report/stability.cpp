#include <iostream>

#include "collision_node/report/modes.h"
#include "collision_node/report/present.h"
#include "collision_node/report/stability/stability_file.h"

namespace collision_node::report {

int runStability(const Options& options, std::ostream& out) {
  WalkOptions walk_options;
  walk_options.quick = options.quick;
  if (options.quick) {
    walk_options.count = 6;
    walk_options.seconds = 0.02;
  }
  walk_options.begins = [&out](const Direction& direction) {
    out << direction.name << ": " << direction.about << std::endl;
  };
  const std::vector<Walk> walks = walkAll(walk_options);
  writeFile(options.out + "/stability.csv", [&](std::ostream& file) { writeCells(file, walks); });
  writeFile(options.out + "/stability.md", [&](std::ostream& file) { writeRanges(file, walks); });
  writeRanges(out, walks);
  present(options.out, out, "present_stability.py");
  int wrong = 0;
  for (const Walk& walk : walks) {
    for (std::size_t rung = 0; rung < walk.direction.values.size(); ++rung) {
      if (walk.cells[0][rung].wrong() == 0) continue;
      wrong += walk.cells[0][rung].wrong();
      out << "CLAIM BROKEN: " << walk.cells[0][rung].wrong() << " wrong answers of ours, "
          << walk.direction.name << " at " << walk.direction.values[rung] << " " << walk.direction.unit
          << '\n';
    }
  }
  if (wrong == 0) out << "Claims hold: no answer of ours is wrong.\n";
  return wrong == 0 ? kDone : kClaimBroken;
}

}  // namespace collision_node::report

#include <filesystem>
#include <fstream>
#include <iostream>
#include <stdexcept>

#include "collision_node/report/modes.h"
#include "collision_node/report/present.h"
#include "collision_node/report/results_file.h"
#include "collision_node/report/scenes/scenes.h"
#include "collision_node/report/sight_picture.h"

namespace collision_node::report {
namespace {

/// What the report claims of a certified method: nothing missed, nothing invented, every bound holds.
bool claimHolds(const Row& row) {
  const Score& s = row.score;
  return s.missed == 0 && s.false_hits == 0 && s.broken_bounds == 0 && s.late == 0;
}

bool isOurs(const Row& row) { return row.family.rfind("ours", 0) == 0; }

}  // namespace

int runErrorAgainstTime(const Options& options, std::ostream& out) {
  const double most_seconds = options.quick ? 0.1 : 2.0;
  const std::vector<Method> methods = allMethods();
  std::vector<Row> rows;
  bool claims_hold = true;
  for (const SceneMaker& maker : allScenes()) {
    const Trials trials = maker.make(options.quick ? maker.quick_count : maker.count);
    out << trials.name << ": " << trials.about << std::endl;
    for (const Method& method : methods) {
      rows.push_back(measure(method, trials, most_seconds));
      const Row& row = rows.back();
      if (!isOurs(row) || claimHolds(row)) continue;
      claims_hold = false;
      out << "CLAIM BROKEN: " << row.method << " on " << row.scene << ": " << row.score.missed << " missed, "
          << row.score.false_hits << " false, " << row.score.broken_bounds << " bounds broken, "
          << row.score.late << " late\n";
    }
  }
  writeFile(options.out + "/results.csv", [&rows](std::ostream& file) { writeResults(file, rows); });
  const Tank tank = loadTank();
  writeFile(options.out + "/shots.csv",
            [&tank](std::ostream& file) { writeShots(file, sightedShots(tank)); });
  writeFile(options.out + "/tank.csv", [&tank](std::ostream& file) { writeTriangles(file, tank); });
  present(options.out, out);
  out << (claims_hold ? "Claims hold: ours missed nothing, every bound holds.\n"
                      : "A claim is broken, see above.\n");
  return claims_hold ? kDone : kClaimBroken;
}

}  // namespace collision_node::report

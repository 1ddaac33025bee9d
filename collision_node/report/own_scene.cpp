#include <cmath>
#include <iostream>
#include <stdexcept>

#include "collision_node/messages/resources.h"
#include "collision_node/report/measure.h"
#include "collision_node/report/modes.h"
#include "collision_node/report/present.h"
#include "collision_node/report/recorded_pieces.h"
#include "collision_node/report/results_file.h"

namespace collision_node::report {
namespace {

/// The tightest answer of ours: where it is certified, its own bracket and ball say how well it knows.
Truth referenceOf(const Answer& answer) {
  Truth truth;
  truth.verdict = answer.verdict;
  if (answer.verdict != Verdict::kHit) return truth;
  truth.toi = answer.toi_lower + 0.5 * (answer.toi_upper - answer.toi_lower);
  truth.toi_error = 0.5 * (answer.toi_upper - answer.toi_lower) + std::abs(truth.toi) * 0x1p-52;
  truth.point = answer.point;
  truth.point_error = answer.position_error;
  return truth;
}

Trials trialsOf(RecordedPair pair) {
  Trials trials;
  trials.name = pair.name;
  trials.set = std::move(pair.set);
  impact::PairOptions tight;
  tight.time_precision = 1e-13;
  tight.distance_precision = 1e-12;
  const ContestantPtr reference = makeOurs(trials.set, tight);
  for (const Query& query : trials.set.queries)
    trials.truths.push_back(referenceOf(reference->answer(query)));
  return trials;
}

std::shared_ptr<const scene::Scene> load(const std::string& file, std::ostream& out) {
  auto scene = scene::loadScene(file, messages::makeResources(file));
  for (const std::string& warning : scene->warnings) out << "warning: " << warning << '\n';
  return scene;
}

}  // namespace

int runOwnScene(const Options& options, std::ostream& out) {
  const std::size_t most = options.quick ? 30 : 300;
  const double most_seconds = options.quick ? 0.05 : 2.0;
  std::vector<Row> rows;
  const auto scene = load(options.scene, out);
  for (RecordedPair& pair : recordPieces(scene, options.bags, most)) {
    out << pair.name << ": " << pair.pieces << " pieces, " << pair.costly
        << " of them nearer than their bounds tell, " << pair.set.queries.size() << " asked" << std::endl;
    if (pair.set.queries.empty()) continue;
    const Trials trials = trialsOf(std::move(pair));
    for (const Method& method : allMethods()) rows.push_back(measure(method, trials, most_seconds));
  }
  if (rows.empty())
    throw std::runtime_error("no two objects of the scene ever come near each other in these bags");
  writeFile(options.out + "/results.csv", [&rows](std::ostream& file) { writeResults(file, rows); });
  present(options.out, out, "present_scene.py");
  return kDone;
}

}  // namespace collision_node::report

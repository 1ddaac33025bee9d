#include "collision_node/scene/summary.h"

namespace collision_node::scene {

bool isCovered(const Track& track) {
  switch (track.status()) {
    case Track::Status::kFixed:
    case Track::Status::kLive:
      return true;
    case Track::Status::kTimedOut:
      return track.isFrozen();
    case Track::Status::kLeft:
      return track.lastReleased().has_value();
    case Track::Status::kWaiting:
    case Track::Status::kUncovered:
      break;
  }
  return false;
}

void countPairs(const std::vector<PairWatch>& watches, const TimeLine& time_line, Stats& stats) {
  for (const PairWatch& watch : watches) {
    const LinkPair& pair = watch.pair();
    if (!isCovered(time_line.tracks()[pair.object_a]) || !isCovered(time_line.tracks()[pair.object_b])) {
      ++stats.pairs_uncovered;
      continue;
    }
    switch (watch.worstAnswer()) {
      case impact::Answer::kCulled:
        ++stats.pairs_culled;
        break;
      case impact::Answer::kClear:
        ++stats.pairs_clear;
        break;
      case impact::Answer::kImpact:
        ++stats.pairs_impact;
        break;
      case impact::Answer::kUndecided:
        ++stats.pairs_undecided;
        break;
    }
  }
}

void countInputs(const Scene& scene, const TimeLine& time_line, Stats& stats) {
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const Track& track = time_line.tracks()[i];
    const bool is_waited_for = track.status() == Track::Status::kWaiting;
    if (!is_waited_for && !isCovered(track)) stats.uncovered_objects.push_back(scene.objects[i].name);
    const InputCounts& counts = track.counts();
    stats.accepted += counts.accepted;
    stats.reordered += counts.reordered;
    stats.late += counts.late;
    stats.duplicate += counts.duplicate;
    stats.rejected += counts.rejected;
  }
}

}  // namespace collision_node::scene

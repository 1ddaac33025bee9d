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

bool isMissed(const Track& track) { return !isCovered(track) && track.status() != Track::Status::kWaiting; }

void countPairs(const std::vector<PairWatch>& watches, const TimeLine& time_line, Stats& stats) {
  for (const PairWatch& watch : watches) {
    const LinkPair& pair = watch.pair();
    const auto answer = watch.worstAnswer();
    if (!answer || !isCovered(time_line.tracks()[pair.object_a]) ||
        !isCovered(time_line.tracks()[pair.object_b])) {
      ++stats.pairs_uncovered;
      continue;
    }
    switch (*answer) {
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

void countInputs(const Scene& scene, const TimeLine& time_line, const std::vector<char>& had_hole,
                 Stats& stats) {
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const Track& track = time_line.tracks()[i];
    if (had_hole[i] != 0 || isMissed(track)) stats.uncovered_objects.push_back(scene.objects[i].label());
    const InputCounts& counts = track.counts();
    stats.accepted += counts.accepted;
    stats.reordered += counts.reordered;
    stats.late += counts.late;
    stats.duplicate += counts.duplicate;
    stats.rejected += counts.rejected;
    stats.holes += counts.holes;
    const std::optional<Hole>& hole = track.firstHole();
    if (hole && (!stats.first_hole || *hole < *stats.first_hole)) {
      stats.first_hole = hole;
      stats.first_hole_object = scene.objects[i].label();
    }
  }
}

}  // namespace collision_node::scene

#include "collision_node/scene/heartbeat.h"

#include <algorithm>

namespace collision_node::scene {

namespace {

using Kind = Coverage::Kind;

std::uint64_t& binOf(Stats& stats, impact::Answer answer) {
  switch (answer) {
    case impact::Answer::kClear:
      return stats.pairs_clear;
    case impact::Answer::kImpact:
      return stats.pairs_impact;
    case impact::Answer::kUndecided:
      return stats.pairs_undecided;
    case impact::Answer::kCulled:
      break;
  }
  return stats.pairs_culled;
}

/// Of a pair that is apart.
std::uint64_t& binOf(Stats& stats, Kind kind) {
  if (kind == Kind::kUncovered) return stats.pairs_uncovered;
  return binOf(stats, kind == Kind::kDoubtful ? impact::Answer::kUndecided : impact::Answer::kCulled);
}

/// The pairs among objects that weigh so much together, by what the worse of the two is.
class Crowd {
 public:
  void add(Kind kind, std::uint64_t weight) {
    all_.add(weight);
    if (kind != Kind::kUncovered) covered_.add(weight);
    if (kind == Kind::kSure) sure_.add(weight);
  }
  std::uint64_t all() const { return all_.pairs(); }
  std::uint64_t uncovered() const { return all() - covered_.pairs(); }
  std::uint64_t doubtful() const { return covered_.pairs() - sure_.pairs(); }
  std::uint64_t sure() const { return sure_.pairs(); }

 private:
  struct Sum {
    std::uint64_t sum = 0, squares = 0;

    void add(std::uint64_t weight) {
      sum += weight;
      squares += weight * weight;
    }
    std::uint64_t pairs() const { return (sum * sum - squares) / 2; }
  };
  Sum all_, covered_, sure_;
};

}  // namespace

PairCounter::PairCounter(const Scene& scene) : scene_(scene), watches_rest_(scene.pairs.watchesRest()) {
  for (const Object& object : scene.objects) weights_.push_back(linksWithShapes(object).size());
  for (const auto& [key, verdicts] : scene.pairs.exceptions()) {
    const auto [a, b] = key;
    const std::uint64_t rule = watches_rest_ && a != b ? weights_[a] * weights_[b] : 0;
    const std::uint64_t watched = scene.pairs.countBetween(scene.objects, a, b);
    if (a != b && watched != rule)
      exceptions_.push_back({a, b, static_cast<std::int64_t>(watched) - static_cast<std::int64_t>(rule)});
  }
}

void PairCounter::count(const TimeLine& time_line, const Coverage& coverage,
                        const std::vector<std::unique_ptr<ObjectPair>>& pairs,
                        const std::vector<std::unique_ptr<ObjectPair>>& statics, bool are_tested,
                        Stats& stats) const {
  const std::vector<Track>& tracks = time_line.tracks();
  const auto kindOf = [&](int object) { return coverage.kindOf(object, tracks[object]); };
  const auto kindOfPair = [&](int a, int b) {
    if (tracks[a].isFixed() && tracks[b].isFixed()) return are_tested ? Kind::kSure : Kind::kUncovered;
    return std::max(kindOf(a), kindOf(b));
  };

  // All pairs that follow the rule.
  if (watches_rest_) {
    Crowd all, fixed;
    for (std::size_t i = 0; i < weights_.size(); ++i) {
      const Kind kind = kindOf(static_cast<int>(i));
      all.add(kind, weights_[i]);
      if (tracks[i].isFixed()) fixed.add(kind, weights_[i]);
    }
    // Two that are fixed stand as their test does, whatever was known of them before they were.
    stats.pairs_uncovered += all.uncovered() - fixed.uncovered() + (are_tested ? 0 : fixed.all());
    stats.pairs_undecided += all.doubtful() - fixed.doubtful();
    stats.pairs_culled += all.sure() - fixed.sure() + (are_tested ? fixed.all() : 0);
  }
  for (const Exception& exception : exceptions_)
    binOf(stats, kindOfPair(exception.a, exception.b)) += static_cast<std::uint64_t>(exception.more);

  // Those that are more than apart.
  for (const std::unique_ptr<ObjectPair>& pair : pairs) {
    const Kind kind = kindOfPair(pair->a(), pair->b());
    if (kind == Kind::kUncovered) continue;
    for (const PairWatch& watch : pair->watches()) {
      const impact::Answer answer = watch.worstAnswer();
      --binOf(stats, kind);
      ++binOf(stats, kind == Kind::kDoubtful ? impact::Answer::kUndecided : answer);
    }
  }
  for (const std::unique_ptr<ObjectPair>& pair : statics) {
    const std::uint64_t links = scene_.pairs.countBetween(scene_.objects, pair->a(), pair->b());
    if (pair->a() != pair->b()) binOf(stats, kindOfPair(pair->a(), pair->b())) -= links;
    if (!pair->isTested() || !isCovered(tracks[pair->a()])) {
      stats.pairs_uncovered += links;
      continue;
    }
    for (const PairWatch& watch : pair->watches()) ++binOf(stats, watch.worstAnswer());
  }
}

void countInputs(const Scene& scene, const TimeLine& time_line, const Coverage& coverage, Stats& stats) {
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const Track& track = time_line.tracks()[i];
    if (coverage.hadHole(static_cast<int>(i)) || isMissed(track))
      stats.uncovered_objects.push_back(scene.objects[i].label());
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

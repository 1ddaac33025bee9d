#include "collision_node/scene/engine.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <stdexcept>
#include <utility>

#include "collision_node/scene/event_queue.h"
#include "collision_node/scene/pair_watch.h"
#include "collision_node/scene/pieces.h"
#include "collision_node/scene/rest.h"
#include "collision_node/scene/scene_tracks.h"
#include "collision_node/scene/summary.h"
#include "collision_node/scene/time_line.h"

namespace collision_node::scene {

namespace {

constexpr Nanoseconds kNever = std::numeric_limits<Nanoseconds>::min();
constexpr Nanoseconds kForEver = std::numeric_limits<Nanoseconds>::max();
constexpr std::size_t kSamplesBeforePruning =
    64;  // per track; pruning looks at all its pairs, so not at every pose

}  // namespace

class Engine::Impl {
 public:
  Impl(std::shared_ptr<const Scene> scene, const MethodFactory& make_method, Sinks sinks);

  void addPose(int object, const motion::StampedPose& pose, bool guessed_stamp);
  void fix(int object, const Pose& pose);
  void clockWentBack();
  void flush();
  void reset();
  Stats stats() const;

 private:
  /// All watched link pairs of two objects: they share their pieces.
  struct ObjectPair {
    int a, b;
    bool is_static;  ///< both fixed, or one rigid object: one test per epoch
    PieceCursor cursor;
    std::vector<int> watches;
    Nanoseconds tested_ns = kNever;  ///< static: where the test ended
  };

  void addPair(const LinkPair& pair, int rank, std::unique_ptr<impact::PairMethod> method);
  void catchUp();
  void work();
  void walk(ObjectPair& pair, Nanoseconds rest_known_ns);
  void testStatic(ObjectPair& pair);
  void endStatic(ObjectPair& pair);
  void advance(const ObjectPair& pair, const Step& step);
  void noteBracket(int watch);
  void endEpoch();
  void startEpoch();
  void prune(const std::vector<int>& tracks);
  Instant decidedUpTo() const;
  void publishBefore(const Instant& limit);
  void publishAll();
  void heartbeatIfDue();
  void heartbeat(Nanoseconds stamp_ns);

  std::shared_ptr<const Scene> scene_;
  Sinks sinks_;
  TimeLine time_line_;
  EventQueue queue_;
  std::vector<PairWatch> watches_;
  std::vector<ObjectPair> object_pairs_;
  std::map<std::pair<int, int>, int> object_pair_at_;
  std::vector<std::vector<int>> pairs_of_track_;
  std::vector<int> freezing_tracks_;
  std::vector<std::size_t> prune_at_;
  std::vector<char> had_hole_;  ///< by object, since the last heartbeat
  // Brackets still open, by their lower end; and where each watch stands in that set.
  std::set<std::pair<Instant, int>> open_brackets_;
  std::vector<std::optional<Instant>> open_since_;
  Nanoseconds walked_to_ns_ = kNever;  ///< the watermark that frozen objects have been walked to
  Nanoseconds last_beat_ns_ = kNever;
  Costs costs_;
  double worst_bracket_ = 0.0, worst_position_error_ = 0.0;
};

Engine::Impl::Impl(std::shared_ptr<const Scene> scene, const MethodFactory& make_method, Sinks sinks)
    : scene_(std::move(scene)),
      sinks_(std::move(sinks)),
      time_line_(makeTracks(*scene_), toNanoseconds(scene_->time.timeout)),
      pairs_of_track_(scene_->objects.size()),
      prune_at_(scene_->objects.size(), kSamplesBeforePruning),
      had_hole_(scene_->objects.size(), 0) {
  for (std::size_t i = 0; i < scene_->objects.size(); ++i)
    if (scene_->objects[i].on_timeout == OnTimeout::kFreeze) freezing_tracks_.push_back(static_cast<int>(i));

  impact::PairOptions options;
  options.time_precision = scene_->time_precision;
  options.distance_precision = scene_->distance_precision;
  options.node_budget = scene_->node_budget;
  for (std::size_t rank = 0; rank < scene_->pairs.size(); ++rank) {
    const LinkPair& pair = scene_->pairs[rank];
    const Link& a = scene_->objects[pair.object_a].links[pair.link_a];
    const Link& b = scene_->objects[pair.object_b].links[pair.link_b];
    if (!a.body || !b.body) continue;
    options.contact_distance = pair.contact_distance;
    addPair(pair, static_cast<int>(rank), make_method(*a.body, *b.body, options));
  }
  startEpoch();
}

void Engine::Impl::addPair(const LinkPair& pair, int rank, std::unique_ptr<impact::PairMethod> method) {
  const std::pair<int, int> key{pair.object_a, pair.object_b};
  const auto [place, is_new] = object_pair_at_.emplace(key, static_cast<int>(object_pairs_.size()));
  if (is_new) {
    const std::vector<Track>& tracks = time_line_.tracks();
    const bool is_static = pair.object_a == pair.object_b ||
                           (tracks[pair.object_a].isFixed() && tracks[pair.object_b].isFixed());
    object_pairs_.push_back({pair.object_a, pair.object_b, is_static, {}, {}});
    if (!is_static) {
      pairs_of_track_[pair.object_a].push_back(place->second);
      pairs_of_track_[pair.object_b].push_back(place->second);
    }
  }
  object_pairs_[place->second].watches.push_back(static_cast<int>(watches_.size()));
  watches_.emplace_back(*scene_, pair, rank, std::move(method));
  open_since_.emplace_back();
}

// ---- in

void Engine::Impl::addPose(int object, const motion::StampedPose& pose, bool guessed_stamp) {
  if (object < 0 || object >= static_cast<int>(scene_->objects.size()))
    throw std::invalid_argument("pose for object number " + std::to_string(object) + "; the scene has " +
                                std::to_string(scene_->objects.size()));
  if (time_line_.tracks()[object].isFixed())
    throw std::invalid_argument("pose for object " + scene_->objects[object].name + ", whose pose is fixed");
  time_line_.add(object, pose, guessed_stamp);
  catchUp();
}

void Engine::Impl::fix(int object, const Pose& pose) {
  if (!time_line_.fix(object, pose)) return;
  const std::vector<Track>& tracks = time_line_.tracks();
  for (const int index : pairs_of_track_[object]) {
    ObjectPair& pair = object_pairs_[index];
    pair.is_static = tracks[pair.a].isFixed() && tracks[pair.b].isFixed();
  }
  catchUp();
}

void Engine::Impl::clockWentBack() {
  time_line_.clockWentBack();
  catchUp();
}

void Engine::Impl::catchUp() {
  work();
  while (time_line_.epochIsOver()) {
    endEpoch();
    time_line_.nextEpoch();
    startEpoch();
    work();
  }
}

void Engine::Impl::flush() {
  for (;;) {
    time_line_.releaseAll();
    work();
    if (!time_line_.hasLaterEpoch()) break;
    endEpoch();
    time_line_.nextEpoch();
    startEpoch();
  }
  for (ObjectPair& pair : object_pairs_)
    if (pair.is_static) testStatic(pair);
  for (std::size_t i = 0; i < watches_.size(); ++i) {
    watches_[i].finish(queue_);
    noteBracket(static_cast<int>(i));
  }
  publishAll();
  // Without any pose it is a heartbeat at 0: the pairs are accounted for all the same.
  const Nanoseconds newest = time_line_.newestReleased().value_or(0);
  if (newest > last_beat_ns_) heartbeat(newest);
}

void Engine::Impl::reset() {
  flush();
  endEpoch();
  time_line_.forget();
  startEpoch();
}

// ---- pieces

/// Solves and publishes all that has become known. The order matters: whatever may still bring an event older
/// than the new watermark is done before anything is published.
void Engine::Impl::work() {
  const std::vector<int> changed = time_line_.takeChanged();
  const Nanoseconds known_ns = time_line_.watermark().value_or(kNever);
  std::set<int> due;
  for (const int track : changed) due.insert(pairs_of_track_[track].begin(), pairs_of_track_[track].end());
  if (known_ns != walked_to_ns_) {
    for (const int track : freezing_tracks_)
      due.insert(pairs_of_track_[track].begin(), pairs_of_track_[track].end());
    walked_to_ns_ = known_ns;
  }
  for (const int index : due) walk(object_pairs_[index], known_ns);
  if (time_line_.watermark()) {
    for (ObjectPair& pair : object_pairs_)
      if (pair.is_static) testStatic(pair);
    publishBefore(decidedUpTo());
    prune(changed);  // before there is a watermark, first poses may still be asked for
  }
  heartbeatIfDue();
}

void Engine::Impl::walk(ObjectPair& pair, Nanoseconds rest_known_ns) {
  const Track& a = time_line_.tracks()[pair.a];
  const Track& b = time_line_.tracks()[pair.b];
  for (;;) {
    const Step step = pair.cursor.next(a, b, rest_known_ns);
    if (step.what == Step::What::kWait) return;
    if (step.what == Step::What::kPiece) {
      advance(pair, step);
      continue;
    }
    for (const int watch : pair.watches) {
      watches_[watch].interrupt(step.reason, queue_);
      noteBracket(watch);
    }
    if (step.reason == impact::Reason::kReset) continue;
    if (step.a_broke) had_hole_[pair.a] = 1;
    if (step.b_broke) had_hole_[pair.b] = 1;
  }
}

void Engine::Impl::advance(const ObjectPair& pair, const Step& step) {
  for (const int watch : pair.watches) {
    watches_[watch].advance(step, queue_, costs_);
    noteBracket(watch);
  }
}

/// Two fixed objects, or two links of a rigid one, touch or they do not: asked once per epoch, on the
/// shortest piece there is.
void Engine::Impl::testStatic(ObjectPair& pair) {
  if (pair.tested_ns != kNever) return;
  const std::optional<Step> step = firstRest(time_line_, pair.a, pair.b);
  if (!step) return;
  pair.tested_ns = step->piece.end_ns;
  for (const int watch : pair.watches) watches_[watch].startOver();  // the answer holds for the whole epoch
  advance(pair, *step);
  for (const int watch : pair.watches) {
    watches_[watch].finish(queue_);
    noteBracket(watch);
  }
}

/// A contact of such a pair lasts to the end of the epoch.
void Engine::Impl::endStatic(ObjectPair& pair) {
  testStatic(pair);
  if (pair.tested_ns == kNever) return;
  const Step step = lastRest(time_line_, pair.a, pair.b, pair.tested_ns);
  for (const int watch : pair.watches) {
    if (!watches_[watch].isTouching()) continue;
    if (step.piece.start_ns < step.piece.end_ns) watches_[watch].advance(step, queue_, costs_);
    watches_[watch].interrupt(impact::Reason::kReset, queue_);
    noteBracket(watch);
  }
}

void Engine::Impl::noteBracket(int watch) {
  const std::optional<Instant> now = watches_[watch].openSince();
  std::optional<Instant>& known = open_since_[watch];
  if (known) open_brackets_.erase({*known, watch});
  if (now) open_brackets_.insert({*now, watch});
  known = now;
}

// ---- epochs

void Engine::Impl::endEpoch() {
  time_line_.closeEpoch();
  for (ObjectPair& pair : object_pairs_) {
    if (pair.is_static) {
      endStatic(pair);
    } else {
      walk(pair, kForEver);
    }
  }
  publishAll();
  const auto newest = time_line_.newestReleased();
  if (newest && *newest > last_beat_ns_) heartbeat(*newest);
}

void Engine::Impl::startEpoch() {
  for (ObjectPair& pair : object_pairs_) {
    pair.cursor.restart(time_line_.tracks()[pair.a], time_line_.tracks()[pair.b]);
    pair.tested_ns = kNever;
  }
  for (std::size_t i = 0; i < watches_.size(); ++i) {
    watches_[i].startOver();
    noteBracket(static_cast<int>(i));
  }
  queue_.newEpoch();
  had_hole_.assign(had_hole_.size(), 0);
  walked_to_ns_ = kNever;
  last_beat_ns_ = kNever;
}

void Engine::Impl::prune(const std::vector<int>& tracks) {
  for (const int index : tracks) {
    const Track& track = time_line_.tracks()[index];
    if (track.keptSamples() < prune_at_[index] || track.status() == Track::Status::kLeft) continue;
    std::size_t needed = std::numeric_limits<std::size_t>::max();
    for (const int at : pairs_of_track_[index]) {
      ObjectPair& pair = object_pairs_[at];
      pair.cursor.skipTo(time_line_.tracks()[pair.a], time_line_.tracks()[pair.b], *time_line_.watermark());
      needed = std::min(needed, pair.a == index ? pair.cursor.indexA() : pair.cursor.indexB());
    }
    time_line_.dropBefore(index, needed);
    prune_at_[index] = 2 * track.keptSamples() + kSamplesBeforePruning;
  }
}

// ---- out

/// No event before this can still come.
Instant Engine::Impl::decidedUpTo() const {
  const Instant known = instantAt(*time_line_.watermark());
  return open_brackets_.empty() ? known : std::min(known, open_brackets_.begin()->first);
}

void Engine::Impl::publishBefore(const Instant& limit) {
  while (queue_.hasBefore(limit)) {
    Event event = queue_.pop();
    event.epoch = time_line_.epoch();
    worst_bracket_ = std::max(worst_bracket_, event.toi_upper - event.toi_lower);
    worst_position_error_ = std::max(worst_position_error_, event.position_error);
    if (sinks_.event) sinks_.event(event);
  }
}

void Engine::Impl::publishAll() { publishBefore(instantAt(kForEver)); }

void Engine::Impl::heartbeatIfDue() {
  const auto newest = time_line_.now();
  if (!newest) return;
  const Nanoseconds first = *time_line_.firstReleased();
  const Nanoseconds period = std::max<Nanoseconds>(1, toNanoseconds(scene_->stats_period));
  const Nanoseconds due = first + (*newest - first) / period * period;
  if (due > first && due > last_beat_ns_) heartbeat(due);
}

void Engine::Impl::heartbeat(Nanoseconds stamp_ns) {
  last_beat_ns_ = stamp_ns;
  Stats now = stats();
  now.stamp_ns = stamp_ns;
  for (PairWatch& watch : watches_) watch.clearAnswer();
  for (std::size_t i = 0; i < had_hole_.size(); ++i) had_hole_[i] = isMissed(time_line_.tracks()[i]) ? 1 : 0;
  if (sinks_.stats) sinks_.stats(now);
}

Stats Engine::Impl::stats() const {
  Stats stats;
  countPairs(watches_, time_line_, stats);
  countInputs(*scene_, time_line_, had_hole_, stats);
  stats.epoch = time_line_.epoch();
  stats.stamp_ns = time_line_.newestReleased().value_or(0);
  stats.has_watermark = time_line_.watermark().has_value();
  if (stats.has_watermark) {
    stats.watermark_ns = decidedUpTo().ns;
    stats.latency = motion::secondsBetween(stats.watermark_ns, time_line_.newestDelivered());
  }
  stats.node_tests = costs_.node_tests;
  stats.subdivisions = costs_.subdivisions;
  stats.budget_met = costs_.budget_met;
  stats.worst_bracket = worst_bracket_;
  stats.worst_position_error = worst_position_error_;
  stats.wall_time = std::numeric_limits<double>::quiet_NaN();
  return stats;
}

// ---- the public face

Engine::Engine(std::shared_ptr<const Scene> scene, const MethodFactory& make_method, Sinks sinks)
    : impl_(std::make_unique<Impl>(std::move(scene), make_method, std::move(sinks))) {}

Engine::Engine(std::shared_ptr<const Scene> scene, impact::MethodName method, Sinks sinks)
    : Engine(
          std::move(scene),
          [method](const geometry::Body& a, const geometry::Body& b, const impact::PairOptions& options) {
            return impact::makeMethod(method, a, b, options);
          },
          std::move(sinks)) {}

Engine::~Engine() = default;

void Engine::addPose(int object, motion::StampedPose pose, bool guessed_stamp) {
  impl_->addPose(object, pose, guessed_stamp);
}
void Engine::fix(int object, const Pose& pose) { impl_->fix(object, pose); }
void Engine::clockWentBack() { impl_->clockWentBack(); }
void Engine::flush() { impl_->flush(); }
void Engine::reset() { impl_->reset(); }
Stats Engine::stats() const { return impl_->stats(); }

}  // namespace collision_node::scene

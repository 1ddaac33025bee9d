#include "collision_node/scene/engine.h"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <utility>

#include "collision_node/scene/event_queue.h"
#include "collision_node/scene/fingerprint.h"
#include "collision_node/scene/needs.h"
#include "collision_node/scene/pair_table.h"
#include "collision_node/scene/tracks/scene_tracks.h"
#include "collision_node/scene/tracks/time_line.h"

namespace collision_node::scene {

namespace {

constexpr Nanoseconds kNever = std::numeric_limits<Nanoseconds>::min();
constexpr Nanoseconds kForEver = std::numeric_limits<Nanoseconds>::max();
constexpr std::size_t kSamplesBeforePruning =
    4;  // per track; pruning looks at all its pairs, so not at every pose

}  // namespace

class Engine::Impl {
 public:
  Impl(std::shared_ptr<const Scene> scene, const MethodFactory& make_method, Sinks sinks,
       const EngineOptions& options);

  void addPose(int object, const motion::StampedPose& pose, bool guessed_stamp);
  void fix(int object, const Pose& pose);
  void clockWentBack();
  void flush();
  void reset();
  Stats stats() const;
  Cut cut();
  bool hasPublished(std::uint32_t epoch, std::optional<Nanoseconds> stamp_ns) const;

 private:
  void catchUp();
  void takeChanges();
  void work(bool at_once = false);
  std::optional<Nanoseconds> beatDue() const;
  void endEpoch();
  void startEpoch();
  void prune();
  Instant decidedUpTo() const;
  Instant publishedUpTo() const { return std::min(published_, decidedUpTo()); }
  void publishBefore(const Instant& limit);
  void publishAll() { publishBefore(instantAt(kForEver)); }
  void heartbeat(Nanoseconds stamp_ns);

  std::shared_ptr<const Scene> scene_;
  std::vector<Need> needs_;  ///< by object
  Sinks sinks_;
  TimeLine time_line_;
  PairTable pairs_;
  EventQueue queue_;
  std::vector<int> freezing_;                ///< objects that may freeze
  std::vector<int> changed_;                 ///< tracks that pruning has not looked at
  std::vector<std::size_t> prune_at_;        ///< by track: samples kept
  std::optional<Nanoseconds> solved_to_ns_;  ///< the watermark that pairs have been solved at
  Instant published_;                        ///< every event before it that could be known has been published
  Nanoseconds last_beat_ns_ = kNever;
  double worst_bracket_ = 0.0, worst_position_error_ = 0.0;
};

Engine::Impl::Impl(std::shared_ptr<const Scene> scene, const MethodFactory& make_method, Sinks sinks,
                   const EngineOptions& options)
    : scene_(std::move(scene)),
      needs_(needsOf(*scene_)),
      sinks_(std::move(sinks)),
      time_line_(makeTracks(*scene_), toNanoseconds(scene_->time.timeout)),
      pairs_(*scene_, time_line_, make_method, options),
      prune_at_(scene_->objects.size(), kSamplesBeforePruning) {
  for (std::size_t i = 0; i < scene_->objects.size(); ++i)
    if (scene_->objects[i].on_timeout == OnTimeout::kFreeze) freezing_.push_back(static_cast<int>(i));
  startEpoch();
}

// ---- in

void Engine::Impl::addPose(int object, const motion::StampedPose& pose, bool guessed_stamp) {
  if (object < 0 || object >= static_cast<int>(scene_->objects.size()))
    throw std::invalid_argument("pose for object number " + std::to_string(object) + "; the scene has " +
                                std::to_string(scene_->objects.size()));
  if (needs_[object] != Need::kWatched && scene_->objects[object].source.type != PoseSource::Type::kFixed)
    return;
  if (time_line_.tracks()[object].isFixed())
    throw std::invalid_argument("pose for object " + scene_->objects[object].name + ", whose pose is fixed");
  time_line_.add(object, pose, guessed_stamp);
  catchUp();
}

void Engine::Impl::fix(int object, const Pose& pose) {
  if (!time_line_.fix(object, pose)) return;
  pairs_.fix(object);
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
    work(true);
    if (!time_line_.hasLaterEpoch()) break;
    endEpoch();
    time_line_.nextEpoch();
    startEpoch();
  }
  pairs_.finish(queue_);
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

// ---- work

void Engine::Impl::takeChanges() {
  for (const int track : time_line_.takeChanged()) {
    pairs_.note(track);
    changed_.push_back(track);
  }
}

/// Solves and publishes all that has become known, once there is something to publish: while the watermark
/// stands, nothing can be, and what waits is solved together. The order matters: whatever may still bring an
/// event older than the new watermark is done before anything is published.
void Engine::Impl::work(bool at_once) {
  takeChanges();
  const std::optional<Nanoseconds> watermark = time_line_.watermark();
  if (!at_once && watermark == solved_to_ns_ && !beatDue()) return;
  solved_to_ns_ = watermark;
  pairs_.solve(watermark.value_or(kNever), queue_);
  if (watermark) {
    pairs_.testStatics(queue_);
    publishBefore(decidedUpTo());
    prune();  // before there is a watermark, first poses may still be asked for
  }
  if (const auto due = beatDue()) heartbeat(*due);
}

// ---- epochs

void Engine::Impl::endEpoch() {
  time_line_.closeEpoch();
  takeChanges();
  pairs_.end(queue_);
  publishAll();
  const auto newest = time_line_.newestReleased();
  if (newest && *newest > last_beat_ns_) heartbeat(*newest);
}

void Engine::Impl::startEpoch() {
  pairs_.startEpoch();
  queue_.newEpoch();
  changed_.clear();
  solved_to_ns_.reset();
  published_ = instantAt(kNever);
  last_beat_ns_ = kNever;
}

void Engine::Impl::prune() {
  for (const int index : std::exchange(changed_, {})) {
    const Track& track = time_line_.tracks()[index];
    if (track.isFixed() || track.keptSamples() < prune_at_[index] || track.status() == Track::Status::kLeft)
      continue;
    time_line_.dropBefore(index, pairs_.neededSample(index, *time_line_.watermark()));
    prune_at_[index] = 2 * track.keptSamples() + kSamplesBeforePruning;
  }
}

// ---- out

/// No event before this can still come, once what is known is solved.
Instant Engine::Impl::decidedUpTo() const {
  const Nanoseconds watermark = *time_line_.watermark();
  Nanoseconds known = watermark, frozen = kForEver;
  const std::vector<Track>& tracks = time_line_.tracks();
  for (const int object : freezing_)
    if (tracks[object].isFrozen())
      frozen = std::min(frozen, tracks[object].stamp(tracks[object].endIndex() - 1));
  if (frozen < kForEver) {
    // What moves beside a frozen object is solved by whole pieces: up to its last stamp that is known.
    for (const Track& track : tracks)
      if (track.status() == Track::Status::kLive && track.lastReleased() && !track.isFrozen())
        known =
            std::min(known, std::max(frozen, track.stamp(track.indexAt(watermark, track.endIndex() - 1))));
  }
  const std::optional<Instant> open = pairs_.openSince();
  return open ? std::min(instantAt(known), *open) : instantAt(known);
}

void Engine::Impl::publishBefore(const Instant& limit) {
  while (queue_.hasBefore(limit)) {
    Event event = queue_.pop();
    event.epoch = time_line_.epoch();
    worst_bracket_ = std::max(worst_bracket_, event.toi_upper - event.toi_lower);
    worst_position_error_ = std::max(worst_position_error_, event.position_error);
    if (sinks_.event) sinks_.event(event);
  }
  published_ = std::max(published_, limit);
}

std::optional<Nanoseconds> Engine::Impl::beatDue() const {
  const auto newest = time_line_.now();
  if (!newest) return std::nullopt;
  const Nanoseconds first = *time_line_.firstReleased();
  const Nanoseconds period = std::max<Nanoseconds>(1, toNanoseconds(scene_->stats_period));
  const Nanoseconds due = first + (*newest - first) / period * period;
  if (due > first && due > last_beat_ns_) return due;
  return std::nullopt;
}

void Engine::Impl::heartbeat(Nanoseconds stamp_ns) {
  last_beat_ns_ = stamp_ns;
  Stats now = stats();
  now.stamp_ns = stamp_ns;
  pairs_.beat();
  if (sinks_.stats) sinks_.stats(now);
}

Stats Engine::Impl::stats() const {
  Stats stats;
  pairs_.count(stats);
  stats.epoch = time_line_.epoch();
  stats.stamp_ns = time_line_.newestReleased().value_or(0);
  stats.has_watermark = time_line_.watermark().has_value();
  if (stats.has_watermark) {
    stats.watermark_ns = publishedUpTo().ns;
    stats.latency = motion::secondsBetween(stats.watermark_ns, time_line_.newestDelivered());
  }
  stats.worst_bracket = worst_bracket_;
  stats.worst_position_error = worst_position_error_;
  stats.wall_time = std::numeric_limits<double>::quiet_NaN();
  return stats;
}

Cut Engine::Impl::cut() {
  work(true);  // what waits for the watermark to move is part of what is known
  Cut cut;
  cut.epoch = time_line_.epoch();
  cut.newest_ns = time_line_.newestInEpoch();
  if (time_line_.newestReleased()) cut.span_ns = *time_line_.newestReleased() - *time_line_.firstReleased();
  Fingerprint state;
  time_line_.describe(state);
  pairs_.describe(state);
  cut.is_settled = pairs_.areSettled();
  cut.state = state.value();
  return cut;
}

bool Engine::Impl::hasPublished(std::uint32_t epoch, std::optional<Nanoseconds> stamp_ns) const {
  if (time_line_.epoch() != epoch) return time_line_.epoch() > epoch;
  if (!stamp_ns) return true;
  return time_line_.watermark() && instantAt(*stamp_ns) < publishedUpTo();
}

// ---- the public face

Engine::Engine(std::shared_ptr<const Scene> scene, const MethodFactory& make_method, Sinks sinks,
               const EngineOptions& options)
    : impl_(std::make_unique<Impl>(std::move(scene), make_method, std::move(sinks), options)) {}

Engine::Engine(std::shared_ptr<const Scene> scene, impact::MethodName method, Sinks sinks,
               const EngineOptions& options)
    : Engine(
          std::move(scene),
          [method](const geometry::Body& a, const geometry::Body& b, const impact::PairOptions& options) {
            return impact::makeMethod(method, a, b, options);
          },
          std::move(sinks),
          method == impact::MethodName::kCertified ? options : EngineOptions{true, options.threads}) {}

Engine::~Engine() = default;

void Engine::addPose(int object, motion::StampedPose pose, bool guessed_stamp) {
  impl_->addPose(object, pose, guessed_stamp);
}
void Engine::fix(int object, const Pose& pose) { impl_->fix(object, pose); }
void Engine::clockWentBack() { impl_->clockWentBack(); }
void Engine::flush() { impl_->flush(); }
void Engine::reset() { impl_->reset(); }
Stats Engine::stats() const { return impl_->stats(); }
Cut Engine::cut() { return impl_->cut(); }
bool Engine::hasPublished(std::uint32_t epoch, std::optional<Nanoseconds> stamp_ns) const {
  return impl_->hasPublished(epoch, stamp_ns);
}

}  // namespace collision_node::scene

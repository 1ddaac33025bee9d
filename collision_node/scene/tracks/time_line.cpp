#include "collision_node/scene/tracks/time_line.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace collision_node::scene {

namespace {

constexpr Nanoseconds kNotYet = std::numeric_limits<Nanoseconds>::min();
constexpr Nanoseconds kAnyTime = std::numeric_limits<Nanoseconds>::max();

/// How far a track lets the watermark go.
Nanoseconds frontierOf(const Track& track) {
  switch (track.status()) {
    case Track::Status::kWaiting:
      return kNotYet;
    case Track::Status::kLive:
      return track.frontier().value_or(kNotYet);
    default:
      return kAnyTime;
  }
}

}  // namespace

TimeLine::TimeLine(std::vector<Track> tracks, Nanoseconds timeout_ns)
    : tracks_(std::move(tracks)),
      timeout_ns_(timeout_ns),
      paces_(tracks_.size(), 0),
      frontiers_(tracks_.size(), kAnyTime),
      is_changed_(tracks_.size(), 0) {
  startOver();
}

// ---- in

void TimeLine::add(int track, const motion::StampedPose& pose, bool guessed) {
  tracks_[track].add(pose, guessed, watermark_);
  note(track);
  checkTimeouts();
  updateWatermark();
}

bool TimeLine::fix(int track, const Pose& pose) {
  const Track::Status status = tracks_[track].status();
  if (status != Track::Status::kWaiting && status != Track::Status::kUncovered) return false;
  tracks_[track] = Track(pose);
  tracks_[track].beginEpoch(epoch_);
  if (watermark_) tracks_[track].joinAt(*watermark_);
  note(track);
  checkTimeouts();
  updateWatermark();
  return true;
}

void TimeLine::clockWentBack() {
  const bool has_poses = std::any_of(tracks_.begin(), tracks_.end(), [](const Track& track) {
    return track.status() == Track::Status::kLive || track.lastReleased();
  });
  if (!has_poses) return;  // nothing to go back from
  // Poses may have said so before the clock did: then this is the same jump, even if the scene has followed
  // it already.
  const bool known = hasLaterEpoch() || std::any_of(tracks_.begin(), tracks_.end(),
                                                    [](const Track& track) { return track.wentBack(); });
  const std::uint32_t target = known ? latest_epoch_ : epoch_ + 1;
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    tracks_[i].clockWentBack(target);
    note(static_cast<int>(i));
  }
  checkTimeouts();
  updateWatermark();
}

void TimeLine::releaseAll() {
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    tracks_[i].releaseAll(watermark_);
    if (tracks_[i].status() == Track::Status::kWaiting) tracks_[i].giveUpWaiting();
    note(static_cast<int>(i));
  }
  checkTimeouts();
  updateWatermark();
}

/// Takes over what one track has just learnt.
void TimeLine::note(int index) {
  const Track& track = tracks_[index];
  if (std::exchange(is_changed_[index], 1) == 0) changed_.push_back(index);
  latest_epoch_ = std::max(latest_epoch_, track.epoch());
  const auto earlier = [](auto a, auto b) { return !b || (a && *a < *b) ? a : b; };
  const auto later = [](auto a, auto b) { return !b || (a && *a > *b) ? a : b; };
  const std::optional<Nanoseconds> began_before = begin();
  const char paces = !track.isFixed() && !track.comesAhead() ? 1 : 0;
  pacers_ += paces - std::exchange(paces_[index], paces);
  first_ = earlier(track.firstReleased(), first_);
  newest_ = later(track.lastReleased(), newest_);
  if (paces != 0) {
    began_ = earlier(track.firstReleased(), began_);
    now_ = later(track.lastReleased(), now_);
  }
  // Who is waited for is given up sooner.
  if (begin() && begin() != began_before) next_check_ns_ = std::min(next_check_ns_, *begin() + timeout_ns_);
  if (track.status() == Track::Status::kLive)
    next_check_ns_ = std::min(next_check_ns_, track.newest() + timeout_ns_);
  frontiers_.set(static_cast<std::size_t>(index), frontierOf(track));
}

void TimeLine::checkTimeouts() {
  const std::optional<Nanoseconds> time = now();
  if (!time || *time <= next_check_ns_) return;
  const Nanoseconds now = *time;
  const int count = static_cast<int>(tracks_.size());
  for (int i = 0; i < count; ++i) {
    if (tracks_[i].status() != Track::Status::kLive || now - tracks_[i].newest() <= timeout_ns_) continue;
    tracks_[i].timeOut();
    note(i);
  }
  // Then only: what a silent track had not released yet may be the first of the epoch.
  for (int i = 0; i < count; ++i) {
    if (tracks_[i].status() != Track::Status::kWaiting || now - *begin() <= timeout_ns_) continue;
    tracks_[i].giveUpWaiting();
    note(i);
  }
  next_check_ns_ = std::numeric_limits<Nanoseconds>::max();
  for (const Track& track : tracks_) {
    if (track.status() == Track::Status::kLive)
      next_check_ns_ = std::min(next_check_ns_, track.newest() + timeout_ns_);
    if (track.status() == Track::Status::kWaiting)
      next_check_ns_ = std::min(next_check_ns_, *begin() + timeout_ns_);
  }
}

void TimeLine::updateWatermark() {
  const Nanoseconds smallest = frontiers_.get();
  if (smallest == kNotYet || smallest == kAnyTime) return;
  // Whoever joins late joins at the watermark or above it; it never goes back.
  watermark_ = watermark_ ? std::max(*watermark_, smallest) : smallest;
}

Nanoseconds TimeLine::newestDelivered() const {
  Nanoseconds newest = newest_.value_or(*watermark_);
  for (const Track& track : tracks_)
    if (track.status() == Track::Status::kLive) newest = std::max(newest, track.newest());
  return newest;
}

// ---- epochs

bool TimeLine::epochIsOver() const {
  if (!hasLaterEpoch()) return false;
  bool anyone_here = false;
  for (const Track& track : tracks_) {
    if (track.status() == Track::Status::kLive) anyone_here = true;
    if (track.lead() > timeout_ns_) return true;
  }
  return !anyone_here;
}

void TimeLine::closeEpoch() {
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    if (tracks_[i].epoch() == epoch_)
      tracks_[i].close(0);  // releases what is left: the end is known only then
    note(static_cast<int>(i));
  }
  for (Track& track : tracks_) track.close(newest_.value_or(0));
}

void TimeLine::nextEpoch() {
  // A track may have been through several since: none of them is left out.
  std::optional<std::uint32_t> next;
  for (const Track& track : tracks_)
    if (const auto epoch = track.firstEpochAfter(epoch_)) next = next ? std::min(*next, *epoch) : *epoch;
  epoch_ = next.value_or(epoch_ + 1);
  for (Track& track : tracks_) track.beginEpoch(epoch_);
  startOver();
}

void TimeLine::forget() {
  epoch_ = latest_epoch_ + 1;
  for (Track& track : tracks_) track.forget(epoch_);
  startOver();
}

void TimeLine::startOver() {
  latest_epoch_ = std::max(latest_epoch_, epoch_);
  watermark_.reset();
  first_.reset();
  newest_.reset();
  began_.reset();
  now_.reset();
  next_check_ns_ = std::numeric_limits<Nanoseconds>::min();  // look at once
  for (std::size_t i = 0; i < tracks_.size(); ++i) note(static_cast<int>(i));
  checkTimeouts();
  updateWatermark();
}

std::vector<int> TimeLine::takeChanged() {
  for (const int index : changed_) is_changed_[index] = 0;
  return std::exchange(changed_, {});
}

}  // namespace collision_node::scene

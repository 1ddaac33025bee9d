/// What later events depend on, at a cut between two poses (docs/decisions/windows.md says what may be left
/// out, and why). Whoever adds to the state of a track, a pair or a path adds it here.
#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "collision_node/scene/fingerprint.h"
#include "collision_node/scene/model_watch.h"
#include "collision_node/scene/pair_table.h"
#include "collision_node/scene/pair_watch.h"
#include "collision_node/scene/tracks/composed_path.h"
#include "collision_node/scene/tracks/time_line.h"

namespace collision_node::scene {

namespace {

using Phase = impact::PairState::Phase;

void addInstant(const Instant& instant, Fingerprint& to) {
  to.add(instant.ns);
  to.add(instant.part);
  to.add(instant.rest);
}

void addEvent(const impact::PairEvent& event, Fingerprint& to) {
  to.add(event.kind);
  to.add(event.certificate);
  to.add(event.interval_start_ns);
  to.add(event.interval_end_ns);
  to.add(event.toi_lower);
  to.add(event.toi_upper);
}

/// Pairs apart or new: nothing else is known of them.
void addState(const impact::PairState& state, Fingerprint& to) {
  if (state.phase != Phase::kTouching && state.phase != Phase::kUndecided) return;
  to.add(state.phase);
  to.add(state.last_piece.start_ns);
  to.add(state.last_piece.end_ns);
  to.add(state.last_piece.a);
  to.add(state.last_piece.b);
  if (state.phase == Phase::kTouching || state.was_touching) to.add(state.contact.certificate);
  if (state.phase == Phase::kTouching) return;
  to.add(state.was_touching);
  to.add(state.published);
  addEvent(state.pending, to);
  to.add(state.pending.position);
  to.add(state.pending_spin);
  to.add(state.pending_speed);
}

}  // namespace

void Track::describe(std::optional<Nanoseconds> watermark, Fingerprint& to) const {
  to.add(status());
  if (fixed_) return to.add(samples_.front().pose.pose);
  const auto add_arrival = [&](const Arrival& arrival) {
    to.add(arrival.pose);
    to.add(arrival.guessed);
  };
  to.add(comes_ahead_);
  to.add(epoch_ - scene_epoch_);
  to.add(isEmpty());
  if (!isEmpty()) to.add(newest_);
  to.add(pending_.size());
  for (const Arrival& arrival : pending_) add_arrival(arrival);
  to.add(last_released_);
  to.add(recent_.size());
  for (const Nanoseconds stamp : recent_) to.add(stamp);
  to.add(floor_);
  to.add(held_.has_value());
  if (held_) add_arrival(*held_);
  to.add(held_may_be_stale_);
  to.add(stale_from_);
  to.add(past_lead_);
  if (epoch_ > scene_epoch_) to.add(first_released_);
  // All pairs have been solved up to the watermark.
  std::size_t first = 0;
  while (watermark && first + 1 < samples_.size() && samples_[first + 1].epoch == scene_epoch_ &&
         samples_[first + 1].pose.stamp_ns <= *watermark)
    ++first;
  // Where the run ended before the next sample, its end is solved too; a frozen object rests on to there.
  if (watermark && first + 1 < samples_.size() && samples_[first + 1].epoch == scene_epoch_ &&
      samples_[first].pose.stamp_ns <= *watermark && samples_[first].after != After::kFrozen &&
      samples_[first + 1].join != Join::kJoined)
    ++first;
  to.add(samples_.size() - first);
  for (std::size_t i = first; i < samples_.size(); ++i) {
    const Sample& sample = samples_[i];
    to.add(sample.epoch - scene_epoch_);
    to.add(sample.pose);
    to.add(sample.guessed);
    to.add(sample.join);
    to.add(sample.after);
  }
}

void TimeLine::describe(Fingerprint& to) const {
  to.add(latest_epoch_ - epoch_);
  to.add(watermark_);
  to.add(newest_);
  to.add(now());
  for (const Track& track : tracks_) {
    if (track.status() == Track::Status::kWaiting) to.add(begin());  // it is waited for from there on
    track.describe(watermark_, to);
  }
}

std::optional<Nanoseconds> TimeLine::newestInEpoch() const {
  std::optional<Nanoseconds> newest;
  const auto take = [&](Nanoseconds stamp_ns) { newest = std::max(stamp_ns, newest.value_or(stamp_ns)); };
  for (const Track& track : tracks_) {
    if (track.isFixed()) continue;
    if (track.status() == Track::Status::kLive) take(track.newest());
    if (track.lastReleased()) take(*track.lastReleased());
  }
  return newest;
}

void ModelWatch::describe(Fingerprint& to) const {
  to.add(state_ != nullptr);
  if (state_) addState(*state_, to);
  to.add(approaches_.size());
  for (const Approach& approach : approaches_) {
    addEvent(approach.event, to);
    to.add(approach.event.position);
    addInstant(approach.lower, to);
    addInstant(approach.upper, to);
    to.add(approach.ball);
    for (const bool is : {approach.confirmed, approach.has_ended, approach.has_given_up, approach.is_told})
      to.add(is);
  }
  to.add(contacts_.size());
  for (const Contact& contact : contacts_) {
    addInstant(contact.from, to);
    to.add(contact.to.has_value());
    if (contact.to) addInstant(*contact.to, to);
  }
  if (!isUndecided()) return;
  for (const double value : {speed_a_, speed_b_, error_a_, error_b_, tube_}) to.add(value);
}

void PairWatch::describe(Fingerprint& to) const {
  to.add(rank_);
  addState(state_ ? *state_ : impact::PairState(), to);
  if (phase() == Phase::kUndecided || model_.isUndecided()) {
    to.add(bracket_.doubt);
    to.add(bracket_.speed_a);
    to.add(bracket_.speed_b);
  }
  if (contact_) to.add(std::string_view("in contact"));
  to.add(waiting_.size());
  for (const Waiting& waiting : waiting_) addEvent(waiting.from, to);
  model_.describe(to);
}

void PairTable::describe(Fingerprint& to) const {
  // Pairs that are plain may rest, or have no watches yet: they say nothing. Which pairs there are, and in
  // what order, is nobody's business.
  std::map<PairRank, const PairWatch*> open;
  for (const auto& pair : pairs_)
    for (const PairWatch& watch : pair->watches())
      if (!watch.isPlain()) open[watch.rank()] = &watch;
  for (const auto& entry : open) entry.second->describe(to);
  std::set<PairRank> touching;
  for (const auto& pair : statics_)
    for (const PairWatch& watch : pair->watches())
      if (watch.isTouching()) touching.insert(watch.rank());
  for (const PairRank rank : touching) to.add(rank);
}

bool PairTable::areSettled() const {
  return std::all_of(pairs_.begin(), pairs_.end(), [](const std::unique_ptr<ObjectPair>& pair) {
    const auto& watches = std::as_const(*pair).watches();
    return std::all_of(watches.begin(), watches.end(),
                       [](const PairWatch& watch) { return watch.isSettled(); });
  });
}

void ComposedPath::describe(Fingerprint& to) const {
  to.add(begun_);
  to.add(at_ns_);
  to.add(newest_ns_);
  to.add(is_anew_);
  time_line_.describe(to);
}

}  // namespace collision_node::scene

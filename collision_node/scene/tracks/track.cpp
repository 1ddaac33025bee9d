#include "collision_node/scene/tracks/track.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

namespace collision_node::scene {

namespace {

constexpr Nanoseconds kForEver = std::numeric_limits<Nanoseconds>::max();
/// Stamps beyond this are no times (146 years), and their differences might overflow.
constexpr Nanoseconds kLargestStamp = kForEver / 2;

bool isTeleport(const TrackOptions& options, const motion::StampedPose& from, const motion::StampedPose& to,
                const motion::RigidMotion& motion) {
  const double h = motion::secondsBetween(from.stamp_ns, to.stamp_ns);
  return (to.pose.position - from.pose.position).norm() > options.max_speed * h ||
         motion.omega.norm() > options.bounds.max_spin;
}

}  // namespace

Track::Track(const Pose& pose) : fixed_(true) {
  Sample sample;
  sample.pose.pose = pose;
  sample.segment.motion = motion::fixedAt(pose);
  samples_.push_back(sample);
}

// ---- in

void Track::add(motion::StampedPose pose, bool guessed, std::optional<Nanoseconds> floor) {
  const bool is_time = pose.stamp_ns >= -kLargestStamp && pose.stamp_ns <= kLargestStamp;
  if (!is_time || motion::checkAndNormalise(pose) != motion::PoseFault::kNone) {
    ++counts_.rejected;
    return;
  }
  comes_ahead_ = pose.comes_ahead;
  const Nanoseconds stamp = pose.stamp_ns;
  // What follows a pose that is very far back belongs to it, though an earlier round had the same stamps.
  const bool is_new_round = held_ && (held_may_be_stale_ || backBy(held_->pose.stamp_ns) > options_.jump_ns);
  if ((held_ && held_->pose.stamp_ns == stamp) || (!is_new_round && isKnown(stamp))) {
    ++counts_.duplicate;
    return;
  }
  if (held_) {
    resolveHeld(pose, floor);
    if (isKnown(stamp)) {
      ++counts_.duplicate;
      return;
    }
  }
  place({pose, guessed}, floor);
}

bool Track::isKnown(Nanoseconds stamp_ns) const {
  if (isEmpty() || stamp_ns > newest_) return false;
  return std::binary_search(pending_.begin(), pending_.end(), stamp_ns, Earlier()) ||
         std::binary_search(recent_.begin(), recent_.end(), stamp_ns);
}

/// How far a stamp lies before what the track has reached. While nothing is released that is the newest pose.
Nanoseconds Track::backBy(Nanoseconds stamp_ns) const {
  if (isEmpty()) return 0;
  return last_released_.value_or(newest_) - stamp_ns;
}

/// The pose after a held one tells what the held one was: the beginning of a new epoch, or a straggler.
void Track::resolveHeld(const motion::StampedPose& next, std::optional<Nanoseconds> floor) {
  const Arrival held = *std::exchange(held_, std::nullopt);
  const bool may_be_stale = std::exchange(held_may_be_stale_, false);
  if (next.stamp_ns < held.pose.stamp_ns) {
    ++counts_.late;
  } else if (may_be_stale) {
    insertFirst(held, floor);
  } else if (backBy(next.stamp_ns) >= 0) {
    enterEpoch(epoch_ + 1);
    went_back_ = true;
    insert(held);
  } else {
    ++counts_.late;
  }
}

void Track::place(const Arrival& arrival, std::optional<Nanoseconds> floor) {
  const Nanoseconds stamp = arrival.pose.stamp_ns;
  if (isEmpty() && stale_from_) {
    const bool may_be_stale = stamp >= *stale_from_;
    stale_from_.reset();
    if (may_be_stale) {
      held_ = arrival;
      held_may_be_stale_ = true;
      return;
    }
  }
  // Before the first release any pose within `jump` may still take its place in the window.
  if (backBy(stamp) > (last_released_ ? 0 : options_.jump_ns)) {
    held_ = arrival;
    return;
  }
  if (epoch_ == scene_epoch_) {
    // A track that joins late (first pose, or back from silence) must not speak of what is decided.
    if (pending_.empty() && (!last_released_ || isBroken())) floor_ = floor;
    if (floor_ && stamp < *floor_) {
      ++counts_.late;
      return;
    }
  }
  insert(arrival);
}

/// Of an epoch, after it was held: time has gone on since, perhaps without this track.
void Track::insertFirst(const Arrival& arrival, std::optional<Nanoseconds> floor) {
  if (epoch_ == scene_epoch_) {
    floor_ = floor;
    if (floor_ && arrival.pose.stamp_ns < *floor_) {
      ++counts_.late;
      return;
    }
  }
  insert(arrival);
}

void Track::insert(const Arrival& arrival) {
  const Nanoseconds stamp = arrival.pose.stamp_ns;
  const bool first = isEmpty();
  if (!first && stamp < newest_) ++counts_.reordered;
  ++counts_.accepted;
  pending_.push_back(arrival);
  if (!first && stamp < newest_) {
    const auto last = pending_.end() - 1;
    std::rotate(std::upper_bound(pending_.begin(), last, stamp, Earlier()), last, pending_.end());
  }
  newest_ = first ? stamp : std::max(newest_, stamp);
  releaseUpTo(newest_ - options_.reorder_ns);
}

void Track::releaseUpTo(Nanoseconds stamp_ns) {
  while (!pending_.empty() && pending_.front().pose.stamp_ns <= stamp_ns) {
    const Arrival next = pending_.front();
    pending_.pop_front();
    release(next);
  }
}

void Track::release(const Arrival& arrival) {
  Sample sample;
  sample.epoch = epoch_;
  sample.pose = arrival.pose;
  sample.guessed = arrival.guessed;
  if (last_released_) {
    const Sample& before = samples_.back();
    if (before.after != After::kOpen) {
      sample.join = Join::kTimeout;
      if (before.after == After::kFrozen) noteHole(impact::Reason::kTimeout);
    } else if (arrival.pose.stamp_ns - *last_released_ > options_.max_gap_ns) {
      sample.join = Join::kGap;
    } else {
      sample.segment = makeSegment(options_.motion, before.pose, arrival.pose, options_.bounds);
      if (options_.poses_are_composed && options_.bounds.areAsked())
        sample.segment.error = motion::unknownError();
      const bool unknown = arrival.pose.begins_anew;
      const bool teleport = isTeleport(options_, before.pose, arrival.pose, sample.segment.motion);
      sample.join = teleport || unknown ? Join::kGap : Join::kJoined;
      if (arrival.pose.may_alias) sample.segment.doubt = impact::Reason::kAlias;
      if (before.guessed || arrival.guessed) sample.segment.doubt = impact::Reason::kStampGuessed;
    }
    if (sample.join == Join::kGap) noteHole(impact::Reason::kGap);
  } else {
    first_released_ = arrival.pose.stamp_ns;
  }
  last_released_ = arrival.pose.stamp_ns;
  recent_.push_back(*last_released_);
  while (recent_.front() < *last_released_ - options_.jump_ns) recent_.pop_front();
  floor_.reset();
  if (epoch_ == scene_epoch_) {
    if (!scene_first_) scene_first_ = last_released_;
    scene_last_ = last_released_;
  }
  noteWay(sample);
  samples_.push_back(sample);
}

/// Every sum is rounded up, so that a difference of two of them holds the way between.
void Track::noteWay(Sample& sample) {
  constexpr double kUp = 1.0 + 0x1p-48;
  double way = 0.0;
  if (sample.join == Join::kJoined) {
    way = motion::pathLength(sample.segment.motion);
  } else if (!samples_.empty()) {
    way = (sample.pose.pose.position - samples_.back().pose.pose.position).norm();
  }
  if (way > 0.0) travelled_ = std::nextafter(travelled_ + way * kUp, std::numeric_limits<double>::infinity());
  sample.travelled = travelled_;
}

void Track::releaseAll(std::optional<Nanoseconds> floor) {
  if (held_) {
    const bool may_be_stale = std::exchange(held_may_be_stale_, false);
    const Arrival held = *std::exchange(held_, std::nullopt);
    if (may_be_stale) {
      insertFirst(held, floor);  // nothing came to say that it was a leftover
    } else {
      ++counts_.late;
    }
  }
  releaseUpTo(kForEver);
}

void Track::timeOut() {
  releaseUpTo(kForEver);
  if (!last_released_) return;
  // A frozen object is known to stand there; its hole is the step to where it comes back.
  const bool freezes = options_.on_timeout == OnTimeout::kFreeze;
  samples_.back().after = freezes ? After::kFrozen : After::kDropped;
  if (!freezes) noteHole(impact::Reason::kTimeout);
}

/// Behind the last released pose.
void Track::noteHole(impact::Reason reason) {
  ++counts_.holes;
  if (!first_hole_) first_hole_ = Hole{epoch_, *last_released_, reason};
}

void Track::clockWentBack(std::uint32_t epoch) {
  if (fixed_) return;
  const bool went_back = std::exchange(went_back_, false);
  if (went_back || epoch_ >= epoch) return;
  const bool had_poses = !isEmpty();
  const Nanoseconds newest = newest_;
  enterEpoch(epoch);
  if (held_) {
    held_may_be_stale_ = false;
    insert(*std::exchange(held_, std::nullopt));
  } else if (had_poses) {
    stale_from_ = newest;
  }
}

void Track::enterEpoch(std::uint32_t epoch) {
  releaseUpTo(kForEver);
  if (epoch_ > scene_epoch_ && last_released_) past_lead_ += *last_released_ - *first_released_;
  epoch_ = epoch;
  last_released_.reset();
  first_released_.reset();
  recent_.clear();
  floor_.reset();
  stale_from_.reset();
}

void Track::close(Nanoseconds end_ns) {
  if (epoch_ == scene_epoch_) releaseUpTo(kForEver);
  closed_ns_ = end_ns;
}

void Track::beginEpoch(std::uint32_t epoch) {
  if (!fixed_ && epoch_ < epoch) {
    enterEpoch(epoch);
    if (held_ && !held_may_be_stale_) insert(*std::exchange(held_, std::nullopt));
  }
  scene_epoch_ = epoch;
  closed_ns_.reset();
  given_up_ = false;
  fixed_from_ns_ = std::numeric_limits<Nanoseconds>::min();
  if (fixed_) return;
  while (!samples_.empty() && samples_.front().epoch < epoch) {
    samples_.pop_front();
    ++base_;
  }
  scene_first_.reset();
  scene_last_.reset();
  past_lead_ = 0;
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    const Sample& sample = samples_[i];
    if (sample.epoch == epoch) {
      if (!scene_first_) scene_first_ = sample.pose.stamp_ns;
      scene_last_ = sample.pose.stamp_ns;
    } else if (i > 0 && sample.epoch < epoch_ && sample.epoch == samples_[i - 1].epoch) {
      past_lead_ += sample.pose.stamp_ns - samples_[i - 1].pose.stamp_ns;
    }
  }
}

void Track::forget(std::uint32_t epoch) {
  if (!fixed_) {
    pending_.clear();
    held_.reset();
    held_may_be_stale_ = false;
    went_back_ = false;
    enterEpoch(epoch);
    base_ += samples_.size();
    samples_.clear();
  }
  beginEpoch(epoch);
}

// ---- out

Track::Status Track::status() const {
  if (fixed_) return Status::kFixed;
  if (epoch_ > scene_epoch_) return Status::kLeft;
  if (isEmpty()) return given_up_ ? Status::kUncovered : Status::kWaiting;
  return pending_.empty() && isBroken() ? Status::kTimedOut : Status::kLive;
}

std::optional<Nanoseconds> Track::frontier() const {
  if (!last_released_ || isBroken()) return floor_;
  return last_released_;
}

Nanoseconds Track::lead() const {
  return past_lead_ + (epoch_ > scene_epoch_ && last_released_ ? *last_released_ - *first_released_ : 0);
}

std::optional<std::uint32_t> Track::firstEpochAfter(std::uint32_t epoch) const {
  for (const Sample& sample : samples_)
    if (sample.epoch > epoch) return sample.epoch;
  if (epoch_ > epoch) return epoch_;
  return std::nullopt;
}

bool Track::has(std::size_t index) const {
  if (fixed_) return true;
  return index >= base_ && index < base_ + samples_.size() && sample(index).epoch == scene_epoch_;
}

Nanoseconds Track::stamp(std::size_t index) const {
  return fixed_ ? fixed_from_ns_ : sample(index).pose.stamp_ns;
}

std::size_t Track::indexAt(Nanoseconds ns, std::size_t last) const {
  if (fixed_) return base_;
  std::size_t low = base_, high = std::max(base_, last);  // the answer is in [low, high]
  while (low < high) {
    const std::size_t middle = high - (high - low) / 2;
    if (stamp(middle) <= ns) {
      low = middle;
    } else {
      high = middle - 1;
    }
  }
  return low;
}

Reach Track::reach(std::size_t index) const {
  Reach reach;
  if (fixed_) {
    reach.what = Reach::What::kStill;
    reach.until_ns = closed_ns_.value_or(kForEver);
    reach.reason = impact::Reason::kReset;
    return reach;
  }
  const Sample& here = sample(index);
  const bool has_next = has(index + 1);
  if (has_next && sample(index + 1).join == Join::kJoined) {
    const Sample& next = sample(index + 1);
    reach.what = Reach::What::kMoves;
    reach.until_ns = next.pose.stamp_ns;
    reach.motion = &next.segment.motion;
    reach.doubt = next.segment.doubt;
    reach.error = next.segment.error;
    return reach;
  }
  const bool ended = closed_ns_ || epoch_ > scene_epoch_;
  if (here.after == After::kFrozen) {
    reach.what = Reach::What::kStill;
    reach.doubt = impact::Reason::kTimeout;
    reach.reason = has_next ? impact::Reason::kTimeout : impact::Reason::kReset;
    if (has_next) {
      reach.until_ns = stamp(index + 1);
    } else if (closed_ns_) {
      reach.until_ns = std::max(*closed_ns_, here.pose.stamp_ns);
    } else {
      reach.guess_of_rest = true;
    }
  } else if (here.after == After::kDropped) {
    reach.what = Reach::What::kBreak;
    reach.reason = impact::Reason::kTimeout;
  } else if (has_next) {
    reach.what = Reach::What::kBreak;
    reach.reason = impact::Reason::kGap;
  } else if (ended) {
    reach.what = Reach::What::kBreak;
    reach.reason = impact::Reason::kReset;
  }
  return reach;
}

motion::RigidMotion Track::restAt(std::size_t index) const {
  if (fixed_) return samples_.front().segment.motion;
  motion::RigidMotion rest = motion::fixedAt(sample(index).pose.pose);
  rest.start_ns = rest.end_ns = stamp(index);
  return rest;
}

void Track::dropBefore(std::size_t index) {
  while (!fixed_ && samples_.size() > 1 && base_ < index) {
    samples_.pop_front();
    ++base_;
  }
}

}  // namespace collision_node::scene

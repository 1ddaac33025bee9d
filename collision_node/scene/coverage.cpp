#include "collision_node/scene/coverage.h"

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

bool Coverage::isSwept(int object, const Track& track) const {
  return track.isFixed() || track.isFrozen() || flags_[object].is_swept;
}

Coverage::Kind Coverage::kindOf(int object, const Track& track) const {
  const Flags& flags = flags_[object];
  if (!isCovered(track) || !isSwept(object, track) || flags.had_hole || flags.was_unswept)
    return Kind::kUncovered;
  return flags.was_doubtful || flags.is_doubtful || track.isFrozen() ? Kind::kDoubtful : Kind::kSure;
}

void Coverage::startEpoch() { flags_.assign(flags_.size(), Flags()); }

void Coverage::take(int object, const Sample& sample) {
  Flags& flags = flags_[object];
  flags.is_swept = sample.join == Join::kJoined;
  flags.is_doubtful = flags.is_swept && sample.segment.doubt != impact::Reason::kNone;
  if (flags.is_doubtful) flags.was_doubtful = true;
  if (sample.join == Join::kGap || sample.join == Join::kTimeout) flags.had_hole = true;
}

void Coverage::look(int object, const Track& track) {
  if (track.isFrozen()) flags_[object].was_doubtful = true;
}

void Coverage::beat(const TimeLine& time_line) {
  for (std::size_t i = 0; i < flags_.size(); ++i) {
    const Track& track = time_line.tracks()[i];
    Flags& flags = flags_[i];
    flags.had_hole = isMissed(track);
    flags.was_unswept = !isSwept(static_cast<int>(i), track);
    flags.was_doubtful = false;
  }
}

}  // namespace collision_node::scene

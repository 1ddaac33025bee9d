/// One object's poses in time order: a state machine from poses as they arrive to released samples and
/// breaks.
///
/// Rules: a pose is released once the same track has delivered one at least `reorder` later, or has ended. Of
/// two poses with one stamp the first wins, as far back as `jump` before the last released one. Any other
/// pose older than the last released one is held; it opens a new epoch when the next one goes on from it,
/// else it is late: one bad stamp opens nothing.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>

#include "collision_node/scene/tracks/instant.h"
#include "collision_node/scene/tracks/ring.h"
#include "collision_node/scene/tracks/segment.h"

namespace collision_node::scene {

class Fingerprint;

/// How a released pose hangs on the one before it. Nothing is swept unless it is joined.
enum class Join : std::uint8_t { kFirst, kJoined, kGap, kTimeout };

/// What follows the last pose of a track that went silent.
enum class After : std::uint8_t { kOpen, kDropped, kFrozen };

/// A released pose and the motion that led to it.
struct Sample {
  std::uint32_t epoch = 0;
  motion::StampedPose pose;
  bool guessed = false;  ///< the stamp was invented by the receiver
  Join join = Join::kFirst;
  Segment segment;  ///< from the sample before; only when joined
  /// [m] How far the object's origin has come since the track's first pose, rounded up. Across a hole: the
  /// straight way.
  double travelled = 0.0;
  After after = After::kOpen;
};

struct TrackOptions {
  MotionModel motion = MotionModel::kSlerp;
  OnTimeout on_timeout = OnTimeout::kDrop;
  double max_speed = std::numeric_limits<double>::infinity();  ///< [m/s] faster is a teleport
  motion::MotionBounds bounds;                                 ///< more spin than that is a teleport, too
  bool poses_are_composed = false;  ///< of several transforms: the bounds do not speak of them
  Nanoseconds reorder_ns = 0, max_gap_ns = 0, jump_ns = 0;
};

/// Every pose handed in ends in exactly one of accepted, late, duplicate and rejected. One may still be held.
struct InputCounts {
  std::uint64_t accepted = 0, late = 0, duplicate = 0, rejected = 0;
  std::uint64_t reordered = 0;  ///< of the accepted: those that came after a younger one
  std::uint64_t holes = 0;      ///< stretches between accepted poses that are not swept
};

/// What a track does from one of its samples on.
struct Reach {
  enum class What : std::uint8_t {
    kWait,   ///< not known yet
    kMoves,  ///< along `motion` until `until_ns`, where the next sample is
    kStill,  ///< at rest until `until_ns`; there the run ends with `reason`
    kBreak   ///< the run ends at this sample with `reason`
  } what = What::kWait;
  Nanoseconds until_ns = std::numeric_limits<Nanoseconds>::max();
  const motion::RigidMotion* motion = nullptr;  ///< kMoves
  impact::Reason reason = impact::Reason::kNone;
  impact::Reason doubt = impact::Reason::kNone;
  motion::ModelError error;    ///< of the motion; none at rest, unless the rest is a guess
  bool guess_of_rest = false;  ///< kStill because the source went silent: known no further than the watermark
};

class Track {
 public:
  /// In the scene's epoch. kTimedOut: went silent (dropped or frozen). kLeft: already in a later epoch.
  enum class Status : std::uint8_t { kFixed, kWaiting, kUncovered, kLive, kTimedOut, kLeft };

  explicit Track(const TrackOptions& options) : options_(options) {}
  /// Stands at `pose` from ever to ever.
  explicit Track(const Pose& pose);

  // ---- in

  /// One pose as it arrives. `floor`: a track that is not live may not join the epoch before it (everything
  /// older is decided). Must not be called on a fixed track.
  void add(motion::StampedPose pose, bool guessed, std::optional<Nanoseconds> floor);
  /// Releases everything delivered; a held pose is late. The track stays live. `floor`: see add().
  void releaseAll(std::optional<Nanoseconds> floor = std::nullopt);
  /// The source went silent: releases everything and ends the run there, or freezes the object.
  void timeOut();
  /// A fixed track that has come late says nothing of this epoch before `ns`.
  void joinAt(Nanoseconds ns) { fixed_from_ns_ = ns; }
  void giveUpWaiting() { given_up_ = true; }
  /// The next pose begins `epoch`, however its stamp compares. Ignored by a track that has just gone back by
  /// itself.
  void clockWentBack(std::uint32_t epoch);
  /// Its own poses went back, and /clock has not said so yet.
  bool wentBack() const { return went_back_; }
  /// The scene's epoch ends at `end_ns`: releases everything, ends the run.
  void close(Nanoseconds end_ns);
  /// The scene goes on in `epoch`; older samples are forgotten, and a track that stayed behind joins it.
  void beginEpoch(std::uint32_t epoch);
  /// Forgets all poses and begins `epoch`. Counters stay.
  void forget(std::uint32_t epoch);

  // ---- out, of the scene's epoch

  bool isFixed() const { return fixed_; }
  Status status() const;
  bool isFrozen() const { return !fixed_ && !samples_.empty() && samples_.back().after == After::kFrozen; }
  std::uint32_t epoch() const { return epoch_; }  ///< the epoch the track itself has reached
  /// Newest delivered stamp. Requires status kLive.
  Nanoseconds newest() const { return newest_; }
  /// First and last released stamps in the scene's epoch.
  std::optional<Nanoseconds> firstReleased() const { return scene_first_; }
  std::optional<Nanoseconds> lastReleased() const { return scene_last_; }
  /// Nothing older than this will be released any more; unset when a first pose might still be of any age.
  std::optional<Nanoseconds> frontier() const;
  /// How far the data beyond the scene's epoch have come, all their epochs together. [ns]
  Nanoseconds lead() const;
  /// The first epoch after `epoch` that the track has poses of, or has reached.
  std::optional<std::uint32_t> firstEpochAfter(std::uint32_t epoch) const;
  /// Its stamps say nothing of how far the others must have come.
  bool comesAhead() const { return comes_ahead_; }
  const InputCounts& counts() const { return counts_; }
  /// Of all epochs.
  const std::optional<Hole>& firstHole() const { return first_hole_; }

  // Samples by a running index that survives pruning.
  std::size_t firstIndex() const { return base_; }
  /// One behind the newest sample kept, of whatever epoch.
  std::size_t endIndex() const { return base_ + samples_.size(); }
  /// The last sample in [firstIndex(), last] whose stamp is at most `ns`; the first one when there is none.
  std::size_t indexAt(Nanoseconds ns, std::size_t last) const;
  std::size_t keptSamples() const { return samples_.size(); }
  bool has(std::size_t index) const;
  /// A fixed track's stamp is the smallest there is, unless it joined late.
  Nanoseconds stamp(std::size_t index) const;
  const Sample& sample(std::size_t index) const { return samples_[index - base_]; }
  Reach reach(std::size_t index) const;
  /// The motion of a track at rest at `index`.
  motion::RigidMotion restAt(std::size_t index) const;
  /// Forgets samples before `index`; always keeps the last one.
  void dropBefore(std::size_t index);
  /// All that what it does later depends on, when everything up to `watermark` is solved (cut.cpp).
  void describe(std::optional<Nanoseconds> watermark, Fingerprint& to) const;

 private:
  struct Arrival {
    motion::StampedPose pose;
    bool guessed = false;
  };
  struct Earlier {
    bool operator()(const Arrival& l, Nanoseconds r) const { return l.pose.stamp_ns < r; }
    bool operator()(Nanoseconds l, const Arrival& r) const { return l < r.pose.stamp_ns; }
  };

  bool isKnown(Nanoseconds stamp_ns) const;
  Nanoseconds backBy(Nanoseconds stamp_ns) const;
  void resolveHeld(const motion::StampedPose& next, std::optional<Nanoseconds> floor);
  void insertFirst(const Arrival& arrival, std::optional<Nanoseconds> floor);
  void place(const Arrival& arrival, std::optional<Nanoseconds> floor);
  void insert(const Arrival& arrival);
  void releaseUpTo(Nanoseconds stamp_ns);
  void release(const Arrival& arrival);
  void enterEpoch(std::uint32_t epoch);
  void noteHole(impact::Reason reason);
  void noteWay(Sample& sample);
  bool isEmpty() const { return pending_.empty() && !last_released_; }
  bool isBroken() const { return last_released_ && samples_.back().after != After::kOpen; }

  TrackOptions options_;
  bool fixed_ = false;
  bool held_may_be_stale_ = false;  ///< held_ may be a leftover from before /clock went back
  bool went_back_ = false;          ///< by its own poses, and /clock has not said so yet
  bool given_up_ = false;
  bool comes_ahead_ = false;
  std::uint32_t epoch_ = 0, scene_epoch_ = 0;
  Ring<Arrival> pending_;                      ///< delivered, not released, of epoch_; by stamp
  std::optional<Nanoseconds> last_released_;   ///< in epoch_
  std::optional<Nanoseconds> first_released_;  ///< in epoch_
  Ring<Nanoseconds> recent_;                   ///< released in epoch_ within the last `jump`, ascending
  std::optional<Nanoseconds> scene_first_, scene_last_;
  Nanoseconds past_lead_ = 0;         ///< how long the epochs between the scene's and epoch_ lasted
  std::optional<Nanoseconds> floor_;  ///< where a track that joined late may begin; until its next release
  Nanoseconds newest_ = 0;            ///< in epoch_, of those delivered
  std::optional<Nanoseconds> stale_from_;  ///< a first pose this young may be such a leftover
  std::optional<Nanoseconds> closed_ns_;
  Ring<Sample> samples_;    ///< of the scene's epoch and later ones
  std::size_t base_ = 0;    ///< index of samples_.front()
  double travelled_ = 0.0;  ///< Sample::travelled of the newest
  InputCounts counts_;
  // What follows is hardly ever looked at.
  std::optional<Arrival> held_;
  Nanoseconds fixed_from_ns_ = std::numeric_limits<Nanoseconds>::min();
  std::optional<Hole> first_hole_;
};

}  // namespace collision_node::scene

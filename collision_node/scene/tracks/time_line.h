/// All tracks of a scene on one axis of data time: epochs, who is live, and the watermark.
///
/// The scene goes through (epoch, stamp) in lexicographic order. No clock is read: time is what the poses
/// say.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "collision_node/scene/tracks/smallest.h"
#include "collision_node/scene/tracks/track.h"

namespace collision_node::scene {

class TimeLine {
 public:
  /// `timeout_ns`: how far a track may lag behind the newest released stamp before it is dropped or frozen,
  /// and how long a first pose is waited for.
  TimeLine(std::vector<Track> tracks, Nanoseconds timeout_ns);

  // ---- in

  void add(int track, const motion::StampedPose& pose, bool guessed);
  /// The track stands at `pose` from ever to ever, though in this epoch it joins at the watermark. False, and
  /// nothing done, when it has poses or is fixed already.
  bool fix(int track, const Pose& pose);
  void clockWentBack();
  /// The end: releases everything delivered and waits for nobody. More poses may follow.
  void releaseAll();

  // ---- epochs

  std::uint32_t epoch() const { return epoch_; }
  /// Tracks have gone back in time, and nobody still speaks of the epoch (or has for too long).
  bool epochIsOver() const;
  bool hasLaterEpoch() const { return latest_epoch_ > epoch_; }
  /// Ends every run of the epoch; the pieces up to here can be walked to their end.
  void closeEpoch();
  /// After closeEpoch(): goes on with the next epoch that has poses.
  void nextEpoch();
  /// After closeEpoch(): forgets all poses; a new epoch begins with nothing.
  void forget();

  // ---- what is known of the epoch

  /// No pose older than this will be released any more: the smallest last released stamp over live moving
  /// tracks. Unset while a first pose is waited for. Never goes back within an epoch.
  std::optional<Nanoseconds> watermark() const { return watermark_; }
  std::optional<Nanoseconds> firstReleased() const { return first_; }
  std::optional<Nanoseconds> newestReleased() const { return newest_; }
  /// How far time has come: the newest released stamp of tracks that are not sent ahead of it. Where all are,
  /// of all.
  std::optional<Nanoseconds> now() const { return pacers_ == 0 ? newest_ : now_; }
  /// Released or not. Requires a watermark.
  Nanoseconds newestDelivered() const;
  /// The newest stamp delivered in the scene's epoch, if there is one.
  std::optional<Nanoseconds> newestInEpoch() const;
  /// All that what it does later depends on (cut.cpp).
  void describe(Fingerprint& to) const;
  const std::vector<Track>& tracks() const { return tracks_; }
  /// Tracks that have released something or changed their status since the last call.
  std::vector<int> takeChanged();
  /// Forgets a track's samples before `index`.
  void dropBefore(int track, std::size_t index) { tracks_[track].dropBefore(index); }

 private:
  std::optional<Nanoseconds> begin() const { return pacers_ == 0 ? first_ : began_; }
  void note(int track);
  void checkTimeouts();
  void updateWatermark();
  void startOver();

  std::vector<Track> tracks_;
  Nanoseconds timeout_ns_;
  std::uint32_t epoch_ = 0, latest_epoch_ = 0;
  std::optional<Nanoseconds> watermark_, first_, newest_;
  std::optional<Nanoseconds> began_, now_;  ///< first and newest, of the pacers
  std::vector<char> paces_;                 ///< by track: it moves, and is not sent ahead of its time
  int pacers_ = 0;
  Nanoseconds next_check_ns_;        ///< no track can have timed out before the newest stamp passes this
  Smallest<Nanoseconds> frontiers_;  ///< by track: how far it lets the watermark go
  std::vector<char> is_changed_;
  std::vector<int> changed_;  ///< those of is_changed_
};

}  // namespace collision_node::scene

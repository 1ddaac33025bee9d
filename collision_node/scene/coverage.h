/// What a heartbeat may say of each object: known all the time since the last one, known but in doubt, or
/// not.
#pragma once

#include <cstdint>
#include <vector>

#include "collision_node/scene/tracks/time_line.h"

namespace collision_node::scene {

/// True when the track's object is known to be somewhere right now: "clear" may speak of it.
bool isCovered(const Track& track);

/// True when the object was waited for in vain, or dropped.
bool isMissed(const Track& track);

class Coverage {
 public:
  explicit Coverage(std::size_t objects) : flags_(objects) {}

  /// How a pair of this object and a faultless one stands, when nothing else is wrong.
  enum class Kind : std::uint8_t { kSure, kDoubtful, kUncovered };
  Kind kindOf(int object, const Track& track) const;

  /// A hole since the last heartbeat, or missed at it: its name belongs into the next one.
  bool hadHole(int object) const { return flags_[object].had_hole; }

  void startEpoch();
  /// The track has released `sample`, of the scene's epoch.
  void take(int object, const Sample& sample);
  /// The track has changed its status.
  void look(int object, const Track& track);
  /// A heartbeat has been told.
  void beat(const TimeLine& time_line);

 private:
  struct Flags {
    // since the last heartbeat
    bool had_hole = false, was_unswept = false, was_doubtful = false;
    // of the newest sample
    bool is_swept = false;  ///< something leads to it
    bool is_doubtful = false;
  };

  bool isSwept(int object, const Track& track) const;

  std::vector<Flags> flags_;
};

}  // namespace collision_node::scene

/// nav_msgs/Path: a whole track in each message, and what a later message adds to it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "collision_node/messages/pose_reader.h"

namespace collision_node::scene {
class Fingerprint;
}

namespace collision_node::messages {

extern const char* const kPath;     ///< nav_msgs/Path
extern const char* const kPathMd5;  ///< of the version that is read

/// The poses of a Path in order, each with its own stamp and frame (an empty one: the Path's). Throws
/// PoseError: another version; cut short; stamps that all are zero or equal, or that go back; more than one
/// frame. A path without poses is good.
std::vector<PoseReading> readPath(const RawMessage& message);

/// What was taken of the paths on a topic. The rules of time hold for each pose; a pose that is sent again is
/// no news.
class PathMemory {
 public:
  PathMemory(motion::Nanoseconds reorder_ns, motion::Nanoseconds jump_ns)
      : reorder_ns_(reorder_ns), jump_ns_(jump_ns) {}

  /// The poses of the next message that are to be handed on. With N the newest stamp taken so far:
  /// - newer than N, or at most `reorder` older and not in the message before: handed on;
  /// - in the message before with the same pose: left out, nothing is said anew; with another pose: left out
  ///   and counted as duplicate, for the first that came wins;
  /// - others: left out and counted as late;
  /// - when the message ends more than `jump` before N, the track began anew: all are handed on.
  std::vector<PoseReading> news(std::vector<PoseReading> path);
  /// The next path is the first.
  void forget() { newest_.reset(); }
  /// All that what is handed on later depends on.
  void describe(scene::Fingerprint& to) const;

  std::uint64_t duplicates() const { return duplicates_; }
  std::uint64_t late() const { return late_; }

 private:
  motion::Nanoseconds reorder_ns_, jump_ns_;
  std::optional<motion::Nanoseconds> newest_;
  std::vector<PoseReading> before_;  // the message before
  std::uint64_t duplicates_ = 0, late_ = 0;
};

}  // namespace collision_node::messages

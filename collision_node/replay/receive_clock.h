/// From stamps back to receive times, across epochs.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>

#include "collision_node/motion/stamped_pose.h"

namespace collision_node::replay {

/// Learns the distance between receive time and stamp from the poses, in order of receive time, and places
/// events among them by it. Transport delay wobbles and is not followed; stamps that jump are. Stamps that
/// jump back begin a time that events take part in only once they carry a later epoch: those of the old epoch
/// are published after it has begun.
class ReceiveClock {
 public:
  using Nanoseconds = motion::Nanoseconds;

  /// `jump_ns`: a smaller change is delay.
  explicit ReceiveClock(Nanoseconds jump_ns) : jump_ns_(jump_ns) {}

  void poseSeen(Nanoseconds received_ns, Nanoseconds stamp_ns);
  /// Receive time of `stamp_ns` in `epoch`; epochs must not decrease from call to call. The stamp itself
  /// before any pose was seen.
  Nanoseconds at(std::uint32_t epoch, Nanoseconds stamp_ns);

 private:
  /// Receive time minus stamp, by the first stamp it holds for.
  using Offsets = std::map<Nanoseconds, Nanoseconds>;
  static Nanoseconds offsetAt(const Offsets& offsets, Nanoseconds stamp_ns);
  bool isNear(Nanoseconds a, Nanoseconds b) const { return (a > b ? a - b : b - a) <= jump_ns_; }

  Nanoseconds jump_ns_;
  std::uint32_t epoch_ = 0;
  std::deque<Offsets> times_;          // front: of epoch_; the rest belongs to later ones
  std::optional<Nanoseconds> jumped_;  // offset of a pose whose stamp jumped back; the next one decides
};

}  // namespace collision_node::replay

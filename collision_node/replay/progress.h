/// A bar on a terminal, with rate and time left.
#pragma once

#include <chrono>
#include <cstdint>
#include <ostream>

#include "collision_node/motion/stamped_pose.h"

namespace collision_node::replay {

class Progress {
 public:
  /// Draws nothing unless `show`. Reading goes from one receive time to the other.
  Progress(std::ostream& err, bool show, motion::Nanoseconds begin_ns, motion::Nanoseconds end_ns);
  /// One message more; the bar is drawn anew ten times a second at most.
  void at(motion::Nanoseconds received_ns) {
    ++messages_;
    if (show_ && messages_ % kLookEvery == 0) look(received_ns);
  }
  void finish();  ///< takes the bar away

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr std::uint64_t kLookEvery = 256;  // messages: a clock is slower than most of them
  void look(motion::Nanoseconds received_ns);

  std::ostream& err_;
  bool show_;
  double begin_, length_;  // [s]
  std::uint64_t messages_ = 0;
  Clock::time_point start_ = Clock::now(), drawn_ = start_;
  bool is_drawn_ = false;
};

}  // namespace collision_node::replay

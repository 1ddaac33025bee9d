/// What ends when, for a clock that never goes back.
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "collision_node/motion/stamped_pose.h"

namespace collision_node::scene {

/// Names and instants; those of the past are handed out in any order. Adding one costs the same however many
/// there are. Source: the radix heap of R. Ahuja, K. Mehlhorn, J. Orlin and R. Tarjan (1990): an instant is
/// kept by the highest bit in which it differs from now.
class Endings {
 public:
  /// An instant before now is taken for now.
  void add(motion::Nanoseconds ns, std::int32_t name) {
    const std::uint64_t at = std::max(ordered(ns), now_);
    lists_[bitsOf(at ^ now_)].push_back({at, name});
  }

  /// Now is `ns`, unless it is later already. Calls over(name) for all that ends at `ns` or before.
  template <typename Over>
  void advance(motion::Nanoseconds ns, Over&& over) {
    const std::uint64_t next = std::max(ordered(ns), now_);
    const int highest = bitsOf(next ^ now_);
    now_ = next;
    // Who differs from the old instant in a lower bit than the new one does is before the new one; who
    // differs in a higher bit is behind it, and differs from it in the same bit.
    for (int bit = 0; bit <= highest; ++bit) {
      ending_.swap(lists_[bit]);
      for (const Ending& ending : ending_) {
        if (ending.at <= now_) {
          over(ending.name);
        } else {
          lists_[bitsOf(ending.at ^ now_)].push_back(ending);
        }
      }
      ending_.clear();
    }
  }

  void clear() {
    for (std::vector<Ending>& list : lists_) list.clear();
    now_ = 0;
  }

 private:
  struct Ending {
    std::uint64_t at;
    std::int32_t name;
  };

  static std::uint64_t ordered(motion::Nanoseconds ns) {
    return static_cast<std::uint64_t>(ns) ^ (std::uint64_t{1} << 63);
  }
  static int bitsOf(std::uint64_t x) { return x == 0 ? 0 : 64 - __builtin_clzll(x); }

  std::uint64_t now_ = 0;
  std::vector<Ending> lists_[65];  ///< by the number of bits up to the highest that differs
  std::vector<Ending> ending_;
};

}  // namespace collision_node::scene

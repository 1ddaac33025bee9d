/// The smallest of many numbers, each of which may change at any time: a tournament in an array.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace collision_node::scene {

template <typename Value>
class Smallest {
 public:
  /// `count` numbers, all of them `value`.
  Smallest(std::size_t count, Value value) : leaves_(1) {
    while (leaves_ < count) leaves_ *= 2;
    winners_.assign(2 * leaves_, value);
  }

  /// Logarithmic in the count.
  void set(std::size_t index, Value value) {
    std::size_t node = leaves_ + index;
    winners_[node] = value;
    while (node > 1) {
      node /= 2;
      const Value winner = std::min(winners_[2 * node], winners_[2 * node + 1]);
      if (winner == winners_[node]) return;
      winners_[node] = winner;
    }
  }

  Value get() const { return winners_[1]; }

 private:
  std::size_t leaves_;
  std::vector<Value> winners_;  ///< [1] is the root, the leaves are at [leaves_, 2 leaves_)
};

}  // namespace collision_node::scene

/// What a walk has still to look at, nearest in time first: time is cut into many days, and what falls on the
/// same day is taken newest first. Source: R. Brown 1988, calendar queues.
///
/// A walk that stops at the first contact must look at all that begins before it; in this order it looks at
/// hardly anything else. What it proves does not depend on the order.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "collision_node/impact/walk/node_test.h"

namespace collision_node::impact {

class Agenda {
 public:
  /// A pair of nodes and the part of its slab in which they can touch.
  struct Item {
    std::int32_t node[2];  ///< of A and of B
    std::int32_t slab;
    std::int32_t next;  ///< of the same day; for the agenda only
    Span span;
  };

  /// Starts over, for spans in [from, to]. Unless `by_time`, the newest item is always the next.
  void start(double from, double to, bool by_time);
  bool empty() const { return held_ == 0; }
  void push(const Item& item);
  /// The next one, if any; it may be changed, but for when its span begins.
  Item& top() { return items_[static_cast<std::size_t>(first_[today()])]; }
  Item pop();

 private:
  static constexpr int kDays = 2048, kWord = 64;  // measured: from 1024 on it makes no difference
  /// With more items the newest one is the next: from there on memory grows with the depth alone.
  static constexpr std::int32_t kMany = 4096;

  /// The first day that has items.
  int today() {
    while (busy_[word_] == 0) ++word_;
    return kWord * word_ + __builtin_ctzll(busy_[word_]);
  }
  int dayOf(double time) const {
    return static_cast<int>(std::min<double>(kDays - 1, std::max(0.0, (time - from_) * per_time_)));
  }

  std::vector<Item> items_;  ///< and places of former ones
  std::int32_t free_ = -1;   ///< the first of those
  std::int32_t held_ = 0;    ///< items
  double from_ = 0.0, per_time_ = 0.0;
  int word_ = 0;  ///< none before has a busy day
  std::uint64_t busy_[kDays / kWord] = {};
  std::int32_t first_[kDays];  ///< item of each busy day
};

inline void Agenda::start(double from, double to, bool by_time) {
  items_.clear();
  free_ = -1;
  held_ = 0;
  from_ = from;
  const double per_time = kDays / (to - from);
  per_time_ = by_time && per_time < 1e300 ? per_time : 0.0;
  word_ = 0;
  std::fill(busy_, busy_ + kDays / kWord, 0);
}

inline void Agenda::push(const Item& item) {
  std::int32_t place = free_;
  if (place >= 0) {
    free_ = items_[static_cast<std::size_t>(place)].next;
    items_[static_cast<std::size_t>(place)] = item;
  } else {
    place = static_cast<std::int32_t>(items_.size());
    items_.push_back(item);
  }
  const int day = held_ < kMany ? dayOf(item.span.low) : today(), word = day / kWord;
  const std::uint64_t bit = std::uint64_t{1} << day % kWord;
  items_[static_cast<std::size_t>(place)].next = (busy_[word] & bit) != 0 ? first_[day] : -1;
  first_[day] = place;
  busy_[word] |= bit;
  word_ = std::min(word_, word);
  ++held_;
}

inline Agenda::Item Agenda::pop() {
  const int day = today();
  const std::int32_t place = first_[day];
  const Item item = items_[static_cast<std::size_t>(place)];
  first_[day] = item.next;
  if (item.next < 0) busy_[word_] &= busy_[word_] - 1;
  items_[static_cast<std::size_t>(place)].next = free_;
  free_ = place;
  --held_;
  return item;
}

}  // namespace collision_node::impact

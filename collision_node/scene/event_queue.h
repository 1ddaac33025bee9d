/// Events wait here until nothing earlier can come; then they leave in order, with their numbers.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <tuple>
#include <utility>
#include <vector>

#include "collision_node/scene/engine.h"
#include "collision_node/scene/tracks/instant.h"

namespace collision_node::scene {

/// The number of one contact, given when its first event is published. Shared by an impact and its
/// separation.
struct ContactNumber {
  bool is_given = false;
  std::uint64_t value = 0;
};

/// A pair's place in byte order of (object a, link a, object b, link b), a being the smaller of the two.
using PairRank = std::uint64_t;

/// What one pair has to say, until it is its turn to speak: pairs may be solved at the same time.
struct Outbox {
  struct Item {
    PairRank rank;
    Event event;
    std::shared_ptr<ContactNumber> contact;
  };
  void push(PairRank rank, const Event& event, std::shared_ptr<ContactNumber> contact) {
    items.push_back({rank, event, std::move(contact)});
  }
  std::vector<Item> items;
};

class EventQueue {
 public:
  /// Empties the outbox. Events of one pair that compare equal in everything leave in the order they came.
  void take(Outbox& outbox);

  bool empty() const { return events_.empty(); }
  /// True when the first event lies before `limit`.
  bool hasBefore(const Instant& limit) const {
    return !empty() && std::get<0>(events_.begin()->first) < limit;
  }

  /// Takes the first event out and gives it its event_id and contact_id.
  Event pop();

  /// event_id and contact_id start at 0 again. The queue must be empty.
  void newEpoch();

 private:
  // toi_lower, toi_upper, pair (a, then b), kind, arrival
  using Key = std::tuple<Instant, Instant, PairRank, impact::Kind, std::uint64_t>;
  struct Waiting {
    Event event;
    std::shared_ptr<ContactNumber> contact;
  };

  std::map<Key, Waiting> events_;
  std::uint64_t arrivals_ = 0;
  std::uint64_t next_event_ = 0, next_contact_ = 0;
};

}  // namespace collision_node::scene

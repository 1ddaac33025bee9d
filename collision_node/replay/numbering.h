/// The numbers of events, from those of one run or window to those of the whole they are part of.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

namespace collision_node::replay {

/// Of one event, or of what a file's cut speaks of.
struct Numbers {
  std::uint32_t epoch = 0;
  std::uint64_t event_id = 0, contact_id = 0;
  bool is_last = false;  ///< no other event has this contact_id
};

/// Counts on over windows: event ids and contact ids from 0 in each epoch, in the order they come.
class Numbering {
 public:
  /// What follows is counted on from here. `epoch`: its own number of the epoch that goes on. Its contacts
  /// that are open are known here as `known`; `own` and `known` have the same length.
  void beginWindow(std::uint32_t epoch, const std::vector<std::uint64_t>& own,
                   const std::vector<std::uint64_t>& known);
  /// Gives contacts that are open at the begin of all that is counted the first numbers, 0 ...
  std::vector<std::uint64_t> giveFirst(std::size_t count);

  /// Requires events in order: throws std::out_of_range when the epoch goes back.
  Numbers next(const Numbers& own);
  /// Moves on to its own `epoch`, of which there need be no event.
  void moveTo(std::uint32_t epoch);
  /// The number of a contact that goes on; throws std::out_of_range when there is none.
  std::uint64_t contact(std::uint64_t own) const { return contacts_.at(own); }
  std::uint32_t epoch() const { return epoch_; }

 private:
  std::uint32_t own_epoch_ = 0, epoch_ = 0;
  std::uint64_t next_event_ = 0, next_contact_ = 0;
  std::map<std::uint64_t, std::uint64_t> contacts_;  // of this epoch: own number -> number here
};

}  // namespace collision_node::replay

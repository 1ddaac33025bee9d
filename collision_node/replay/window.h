/// Which events of a session are the window's, and what is open at its ends.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <tuple>

#include "collision_node/replay/numbering.h"
#include "collision_node/replay/window_lines.h"
#include "collision_node/scene/engine.h"

namespace collision_node::replay {

/// The events up to some instant, in the order of (epoch, stamp): a place in the stream of events.
struct Place {
  std::uint32_t epoch = 0;
  std::optional<Nanoseconds> stamp_ns;  ///< nothing: before all events of the epoch

  /// True for an event that lies behind this place.
  bool isBefore(const scene::Event& event) const;
  bool isBefore(std::uint32_t epoch, Nanoseconds stamp_ns) const;
};

/// See docs/decisions/windows.md. Wants the session's events in order, from its first one on.
class Window {
 public:
  /// `opens` and `closes` when it is cut there; the recording's begin and end need no cut. They may be called
  /// before all events up to there have come.
  void openAt(const scene::Cut& cut);
  void closeAt(const scene::Cut& cut);
  bool isOpen() const { return is_open_; }
  const std::optional<Place>& end() const { return end_; }

  /// True when the event is the window's; then it has the window's numbers.
  bool take(scene::Event& event);
  /// The same of a heartbeat.
  bool take(scene::Stats& stats) const;

  /// Fill in epoch, stamp, state and contacts. What opens may be asked for once the first event of the window
  /// has come, or all up to its begin have; what closes, once all up to its end have.
  void describeBegin(WindowEnd& end);
  void describeEnd(WindowEnd& end);

 private:
  using Key = std::tuple<std::string, std::string, std::string, std::string>;  // object and link of a, of b
  void see(const scene::Event& event);
  void moveContactsTo(std::uint32_t epoch);
  void begin();
  template <typename Visit>
  void forEachContact(Visit&& visit) const;

  Place begin_;
  std::optional<Place> end_;
  std::uint64_t begin_state_ = 0, end_state_ = 0;
  bool is_open_ = false, has_begun_ = false;
  std::uint32_t contacts_epoch_ = 0;
  /// Open so far, by the session's numbers, in the order they opened. A pair has two when an object comes
  /// back from a hole to where it was: the old one's end may be rounded to behind the new one's begin.
  std::map<Key, std::vector<std::uint64_t>> contacts_;
  std::vector<OpenContact> contacts_at_begin_;
  Numbering numbering_;
};

}  // namespace collision_node::replay

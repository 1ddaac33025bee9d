#include "collision_node/replay/receive_clock.h"

#include <iterator>

namespace collision_node::replay {

void ReceiveClock::poseSeen(Nanoseconds received_ns, Nanoseconds stamp_ns) {
  const Nanoseconds offset = received_ns - stamp_ns;
  if (times_.empty()) {
    times_.push_back({{stamp_ns, offset}});
    return;
  }
  // Some tracks are still in the old time while others have jumped.
  for (const Offsets& time : times_)
    if (isNear(offsetAt(time, stamp_ns), offset)) return;
  if (offset < offsetAt(times_.back(), stamp_ns)) {
    times_.back().emplace(stamp_ns, offset);  // stamps jumped ahead: the same epoch goes on
  } else if (jumped_ && isNear(*jumped_, offset)) {
    times_.push_back({{stamp_ns, offset}});
    jumped_.reset();
  } else {
    jumped_ = offset;  // one bad stamp is no new time
  }
}

ReceiveClock::Nanoseconds ReceiveClock::at(std::uint32_t epoch, Nanoseconds stamp_ns) {
  for (; epoch_ < epoch; ++epoch_)
    if (times_.size() > 1) times_.pop_front();
  return times_.empty() ? stamp_ns : stamp_ns + offsetAt(times_.front(), stamp_ns);
}

ReceiveClock::Nanoseconds ReceiveClock::offsetAt(const Offsets& offsets, Nanoseconds stamp_ns) {
  const auto after = offsets.upper_bound(stamp_ns);
  return after == offsets.begin() ? after->second : std::prev(after)->second;
}

}  // namespace collision_node::replay

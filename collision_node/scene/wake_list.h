/// When do resting pairs have to be looked at again? Each is asked for once one of its objects has gone half
/// of the way that is left.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

namespace collision_node::scene {

class ObjectPair;

/// One object's alarms: by the reading of its odometer.
class WakeList {
 public:
  struct Alarm {
    double at;  ///< [m]
    ObjectPair* pair;
    std::uint64_t nap;  ///< of that pair; an alarm of an earlier one is void
  };

  void add(const Alarm& alarm) {
    alarms_.push_back(alarm);
    std::push_heap(alarms_.begin(), alarms_.end(), later);
  }

  /// Takes out an alarm that is due at this reading.
  bool take(double reading, Alarm& alarm) {
    if (alarms_.empty() || alarms_.front().at > reading) return false;
    std::pop_heap(alarms_.begin(), alarms_.end(), later);
    alarm = alarms_.back();
    alarms_.pop_back();
    return true;
  }

  /// Void alarms of an object that stays where it is are never due: forgets them now and then.
  template <typename IsVoid>
  void tidy(const IsVoid& is_void) {
    if (alarms_.size() < tidy_at_) return;
    alarms_.erase(std::remove_if(alarms_.begin(), alarms_.end(), is_void), alarms_.end());
    std::make_heap(alarms_.begin(), alarms_.end(), later);
    tidy_at_ = 2 * alarms_.size() + 64;
  }

  void clear() { alarms_.clear(); }

 private:
  static bool later(const Alarm& l, const Alarm& r) { return l.at > r.at; }

  std::vector<Alarm> alarms_;
  std::size_t tidy_at_ = 64;
};

}  // namespace collision_node::scene

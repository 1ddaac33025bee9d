/// When do resting pairs have to be looked at again? Each is asked for once one of its objects has gone its
/// share of the way that is left.
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

namespace collision_node::scene {

class ObjectPair;

/// By object and the reading of its odometer. What is void is told without a look at the pair, which is far
/// away in memory.
class Alarms {
 public:
  explicit Alarms(std::size_t objects) : lists_(objects) {}

  /// Names a pair, which must outlive this.
  std::uint32_t nameOf(ObjectPair& pair) {
    pairs_.push_back(&pair);
    naps_.push_back(0);
    return static_cast<std::uint32_t>(pairs_.size() - 1);
  }

  /// Asks for a pair when the object's odometer reads `at` [m].
  void set(int object, double at, std::uint32_t name) {
    List& list = lists_[object];
    tidy(list);
    list.alarms.push_back({at, name, naps_[name]});
    std::push_heap(list.alarms.begin(), list.alarms.end(), later);
  }

  /// What has been set for this pair is void.
  void silence(std::uint32_t name) { ++naps_[name]; }

  /// Silences the pairs that are asked for at this reading, and calls wake(pair) for each.
  template <typename Wake>
  void take(int object, double reading, const Wake& wake) {
    std::vector<Alarm>& alarms = lists_[object].alarms;
    while (!alarms.empty() && alarms.front().at <= reading) {
      const Alarm alarm = alarms.front();
      std::pop_heap(alarms.begin(), alarms.end(), later);
      alarms.pop_back();
      if (isVoid(alarm)) continue;
      silence(alarm.name);
      wake(*pairs_[alarm.name]);
    }
  }

  void clear() {
    for (List& list : lists_) list.alarms.clear();
  }

 private:
  struct Alarm {
    double at;
    std::uint32_t name, nap;  ///< what comes after 2^32 naps asks once too often
  };
  struct List {
    std::vector<Alarm> alarms;  ///< a heap
    std::size_t tidy_at = 64;
  };

  static bool later(const Alarm& l, const Alarm& r) { return l.at > r.at; }
  bool isVoid(const Alarm& alarm) const { return alarm.nap != naps_[alarm.name]; }

  /// Void alarms of an object that stays where it is are never due: forgets them now and then.
  void tidy(List& list) const {
    std::vector<Alarm>& alarms = list.alarms;
    if (alarms.size() < list.tidy_at) return;
    alarms.erase(
        std::remove_if(alarms.begin(), alarms.end(), [this](const Alarm& alarm) { return isVoid(alarm); }),
        alarms.end());
    std::make_heap(alarms.begin(), alarms.end(), later);
    list.tidy_at = 2 * alarms.size() + 64;
  }

  std::vector<ObjectPair*> pairs_;   ///< by name
  std::vector<std::uint32_t> naps_;  ///< how often each has been silenced
  std::vector<List> lists_;          ///< by object
};

}  // namespace collision_node::scene

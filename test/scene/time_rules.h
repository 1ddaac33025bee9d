/// The rules of time, written down once more, slowly: every accepted pose is kept for ever, and what is
/// released, decided and touching is worked out from scratch whenever somebody asks.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "mishaps.h"

namespace collision_node::scene {

using Ns = motion::Nanoseconds;

class TimeRules {
 public:
  struct Limits {
    Ns reorder, max_gap, timeout, jump;
  };
  struct Counts {
    std::uint64_t accepted = 0, late = 0, duplicate = 0;
  };
  /// One change of contact of two spheres of radius 0.5 m.
  struct Change {
    std::uint32_t epoch;
    int a, b;
    std::string what;  ///< "IMPACT", "SEPARATION", "INITIAL_OVERLAP", or "SEPARATION reason"
    Ns piece_ns;       ///< the time is counted from here
    double seconds;
    std::string or_what = {};  ///< both ended at one instant: the other one's reason is as true
  };

  TimeRules(int objects, const Limits& limits) : limits_(limits), lanes_(objects) {}

  void add(const Arrival& arrival) {
    sort(lanes_[arrival.object], arrival.stamp_ns, arrival.x);
    settle();
    while (isOver()) nextEpoch();
  }

  /// The end of the data: all is released, epoch by epoch.
  void flush() {
    for (;;) {
      for (Lane& lane : lanes_) {
        if (lane.held) ++counts_.late;
        lane.held.reset();
        if (!lane.poses().empty()) lane.all_until = std::max(lane.all_until, lane.newest());
        if (lane.epoch == epoch_ && lane.poses().empty()) lane.given_up = true;
      }
      settle();
      if (!hasLater()) return;
      nextEpoch();
    }
  }

  std::uint32_t epoch() const { return epoch_; }
  std::optional<Ns> watermark() const { return watermark_; }
  const Counts& counts() const { return counts_; }

  /// All changes of contact that the released poses hold. Call after flush().
  std::vector<Change> changes() const {
    std::vector<Change> out;
    for (std::uint32_t epoch = 0; epoch <= epoch_; ++epoch)
      for (int a = 0; a < static_cast<int>(lanes_.size()); ++a)
        for (int b = a + 1; b < static_cast<int>(lanes_.size()); ++b)
          for (const Stretch& of_a : stretches(lanes_[a], epoch))
            for (const Stretch& of_b : stretches(lanes_[b], epoch)) meet(epoch, a, b, of_a, of_b, out);
    return out;
  }

 private:
  using Poses = std::map<Ns, double>;
  struct Lane {
    std::uint32_t epoch = 0;
    std::map<std::uint32_t, Poses> accepted;             // by epoch
    std::map<std::uint32_t, std::set<Ns>> silent_after;  // by epoch: dropped behind this stamp
    std::optional<std::pair<Ns, double>> held;
    Ns all_until = kNever;    // released at once up to here, by a flush or when it fell silent
    std::optional<Ns> floor;  // joined late: nothing older may come, until the first release
    bool given_up = false;

    Poses& poses() { return accepted[epoch]; }
    Ns newest() { return poses().rbegin()->first; }
    bool isSilent() { return !poses().empty() && silent_after[epoch].count(newest()) != 0; }
  };
  struct Stretch {
    std::vector<std::pair<Ns, double>> poses;
    std::string end;  // why it ends; empty: the data end
  };

  static constexpr Ns kNever = std::numeric_limits<Ns>::min();

  std::optional<Ns> lastReleased(Lane& lane) const {
    if (lane.poses().empty()) return std::nullopt;
    const Ns limit = std::max(lane.newest() - limits_.reorder, lane.all_until);
    std::optional<Ns> last;
    for (const auto& pose : lane.poses())
      if (pose.first <= limit) last = pose.first;
    return last;
  }

  void sort(Lane& lane, Ns t, double x) {
    const auto reached = [&] { return lastReleased(lane).value_or(lane.newest()); };
    const auto isKnown = [&] {
      if (lane.poses().count(t) == 0) return false;
      const std::optional<Ns> last = lastReleased(lane);
      return !last || t >= *last - limits_.jump;
    };
    const bool round_is_new = lane.held && reached() - lane.held->first > limits_.jump;
    if ((lane.held && lane.held->first == t) || (!round_is_new && isKnown())) {
      ++counts_.duplicate;
      return;
    }
    if (lane.held) {
      const std::pair<Ns, double> held = *lane.held;
      lane.held.reset();
      if (t > held.first && t <= reached()) {
        ++lane.epoch;
        lane.all_until = kNever;
        lane.floor.reset();
        accept(lane, held.first, held.second);
      } else {
        ++counts_.late;
      }
    }
    if (isKnown()) {
      ++counts_.duplicate;
      return;
    }
    if (!lane.poses().empty() && t < reached() - (lastReleased(lane) ? 0 : limits_.jump)) {
      lane.held = {t, x};
      return;
    }
    if (lane.epoch == epoch_) {
      if (lane.poses().empty() || lane.isSilent()) lane.floor = watermark_;
      if (lane.floor && t < *lane.floor) {
        ++counts_.late;
        return;
      }
    }
    accept(lane, t, x);
  }

  void accept(Lane& lane, Ns t, double x) {
    const std::optional<Ns> before = lastReleased(lane);
    ++counts_.accepted;
    lane.poses()[t] = x;
    if (lastReleased(lane) != before) lane.floor.reset();
  }

  /// Who has been silent for too long, and how far everything is decided.
  void settle() {
    std::optional<Ns> first, newest;
    const auto look = [&] {
      first.reset();
      newest.reset();
      for (Lane& lane : lanes_) {
        if (lane.accepted[epoch_].empty()) continue;
        const std::optional<Ns> last =
            lane.epoch > epoch_ ? lane.accepted[epoch_].rbegin()->first : lastReleased(lane);
        if (!last) continue;
        const Ns begin = lane.accepted[epoch_].begin()->first;
        first = first ? std::min(*first, begin) : begin;
        newest = newest ? std::max(*newest, *last) : *last;
      }
    };
    look();
    if (newest) {
      const Ns now = *newest;
      for (Lane& lane : lanes_) {
        if (lane.epoch != epoch_ || lane.poses().empty() || lane.isSilent()) continue;
        if (now - lane.newest() <= limits_.timeout) continue;
        lane.all_until = lane.newest();
        lane.silent_after[epoch_].insert(lane.newest());
      }
      look();
      for (Lane& lane : lanes_)
        if (lane.epoch == epoch_ && lane.poses().empty() && now - *first > limits_.timeout)
          lane.given_up = true;
    }
    std::optional<Ns> smallest;
    for (Lane& lane : lanes_) {
      if (lane.epoch != epoch_ || lane.isSilent()) continue;
      if (lane.poses().empty()) {
        if (!lane.given_up) return;  // a first pose may still be of any age
        continue;
      }
      std::optional<Ns> last = lastReleased(lane);
      if (last && lane.silent_after[epoch_].count(*last) != 0) last.reset();
      if (!last) last = lane.floor;
      if (!last) return;
      smallest = smallest ? std::min(*smallest, *last) : *last;
    }
    if (smallest) watermark_ = watermark_ ? std::max(*watermark_, *smallest) : *smallest;
  }

  bool hasLater() const {
    return std::any_of(lanes_.begin(), lanes_.end(), [&](const Lane& lane) { return lane.epoch > epoch_; });
  }
  bool isOver() {
    bool anyone_here = false, too_long = false;
    for (Lane& lane : lanes_) {
      if (lane.epoch == epoch_ && !lane.poses().empty() && !lane.isSilent()) anyone_here = true;
      Ns ahead = 0;  // data of later epochs
      for (const auto& [epoch, poses] : lane.accepted) {
        if (epoch <= epoch_ || poses.empty()) continue;
        const std::optional<Ns> last = epoch < lane.epoch ? poses.rbegin()->first : lastReleased(lane);
        if (last) ahead += *last - poses.begin()->first;
      }
      if (ahead > limits_.timeout) too_long = true;
    }
    return hasLater() && (too_long || !anyone_here);
  }
  void nextEpoch() {
    std::uint32_t next = std::numeric_limits<std::uint32_t>::max();
    for (const Lane& lane : lanes_)
      for (const auto& [epoch, poses] : lane.accepted)
        if (epoch > epoch_ && !poses.empty()) next = std::min(next, epoch);
    epoch_ = next;
    for (Lane& lane : lanes_) {
      lane.given_up = false;
      if (lane.epoch >= epoch_) continue;
      lane.epoch = epoch_;
      lane.all_until = kNever;
      lane.floor.reset();
      if (lane.held) accept(lane, lane.held->first, lane.held->second);  // it went back with the others
      lane.held.reset();
    }
    watermark_.reset();
    settle();
  }

  std::vector<Stretch> stretches(const Lane& lane, std::uint32_t epoch) const {
    std::vector<Stretch> out;
    const auto poses = lane.accepted.find(epoch);
    if (poses == lane.accepted.end() || poses->second.empty()) return out;
    const auto silent = lane.silent_after.find(epoch);
    const auto isSilentAfter = [&](Ns t) {
      return silent != lane.silent_after.end() && silent->second.count(t) != 0;
    };
    out.emplace_back();
    for (const auto& pose : poses->second) {
      Stretch& now = out.back();
      if (!now.poses.empty()) {
        const Ns last = now.poses.back().first;
        if (isSilentAfter(last) || pose.first - last > limits_.max_gap) {
          now.end = isSilentAfter(last) ? "TIMEOUT" : "GAP";
          out.emplace_back();
        }
      }
      out.back().poses.push_back(pose);
    }
    if (isSilentAfter(out.back().poses.back().first)) {
      out.back().end = "TIMEOUT";
    } else if (epoch < epoch_) {
      out.back().end = "RESET";
    }
    return out;
  }

  static double at(const Stretch& stretch, Ns t) {
    for (std::size_t i = 1; i < stretch.poses.size(); ++i) {
      const auto& [from, x] = stretch.poses[i - 1];
      const auto& [to, y] = stretch.poses[i];
      if (t >= from && t <= to)
        return x + (y - x) * (static_cast<double>(t - from) / static_cast<double>(to - from));
    }
    return std::numeric_limits<double>::quiet_NaN();
  }

  static void meet(std::uint32_t epoch, int a, int b, const Stretch& of_a, const Stretch& of_b,
                   std::vector<Change>& out) {
    const Ns begin = std::max(of_a.poses.front().first, of_b.poses.front().first);
    const Ns end = std::min(of_a.poses.back().first, of_b.poses.back().first);
    if (begin >= end) return;
    std::set<Ns> cuts{begin, end};
    for (const Stretch* stretch : {&of_a, &of_b})
      for (const auto& pose : stretch->poses)
        if (pose.first > begin && pose.first < end) cuts.insert(pose.first);
    bool touching = std::abs(at(of_b, begin) - at(of_a, begin)) <= 1.0;
    if (touching) out.push_back({epoch, a, b, "INITIAL_OVERLAP", begin, 0.0});
    for (auto cut = cuts.begin(); std::next(cut) != cuts.end(); ++cut) {
      const Ns from = *cut, to = *std::next(cut);
      const double gap = at(of_b, from) - at(of_a, from), later = at(of_b, to) - at(of_a, to);
      const double h = static_cast<double>(to - from) * 1e-9;
      std::vector<double> crossings;
      for (const double level : {-1.0, 1.0})
        if ((gap - level) * (later - level) < 0.0) crossings.push_back(h * (level - gap) / (later - gap));
      std::sort(crossings.begin(), crossings.end());
      for (const double crossing : crossings) {
        touching = !touching;
        out.push_back({epoch, a, b, touching ? "IMPACT" : "SEPARATION", from, crossing});
      }
    }
    const bool a_ends = of_a.poses.back().first == end && !of_a.end.empty();
    const bool b_ends = of_b.poses.back().first == end && !of_b.end.empty();
    if (touching && (a_ends || b_ends)) {
      const Ns last = *std::prev(cuts.end(), 2);
      const double seconds = static_cast<double>(end - last) * 1e-9;
      const std::string reason = a_ends ? of_a.end : of_b.end, other = b_ends ? of_b.end : of_a.end;
      out.push_back({epoch, a, b, "SEPARATION " + reason, last, seconds, "SEPARATION " + other});
    }
  }

  Limits limits_;
  std::vector<Lane> lanes_;
  std::uint32_t epoch_ = 0;
  std::optional<Ns> watermark_;
  Counts counts_;
};

}  // namespace collision_node::scene

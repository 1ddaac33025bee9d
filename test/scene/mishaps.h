/// Streams of several objects as a bad network, a looping player and a restarted simulation deliver them.
#pragma once

#include <algorithm>
#include <random>
#include <vector>

#include "collision_node/motion/stamped_pose.h"

namespace collision_node::scene {

/// One pose of a sphere on the x axis, in order of arrival.
struct Arrival {
  int object = 0;
  motion::Nanoseconds stamp_ns = 0;
  double x = 0.0;  ///< [m]
};

/// What may happen to a stream, as chances for each pose. Lengths of time are in units of `unit_ns`.
struct Mishaps {
  motion::Nanoseconds unit_ns = 1;
  motion::Nanoseconds begin_ns = 0;  ///< where stamps begin
  int objects = 3, rounds = 60;
};

inline std::vector<Arrival> arrivalsWithMishaps(std::mt19937_64& random, const Mishaps& with) {
  using motion::Nanoseconds;
  const auto chance = [&](double p) { return std::bernoulli_distribution(p)(random); };
  const auto upTo = [&](Nanoseconds n) {
    return with.unit_ns * std::uniform_int_distribution<Nanoseconds>(0, n)(random);
  };
  const auto place = [&] { return std::uniform_real_distribution<double>(-2.0, 2.0)(random); };
  std::vector<Arrival> out;
  Nanoseconds now = with.begin_ns + upTo(2000);
  std::vector<Nanoseconds> silent_until(with.objects, now), skew(with.objects, 0);
  for (int i = 0; i < with.objects; ++i)
    if (chance(0.3)) silent_until[i] = now + upTo(3000);  // joins late, or too late
  for (int round = 0; round < with.rounds; ++round) {
    now += with.unit_ns * 20 + upTo(60);
    if (chance(0.02)) now += upTo(2500);                 // all of them pause
    if (chance(0.02)) now = with.begin_ns + upTo(2000);  // a bag in a loop
    for (int i = 0; i < with.objects; ++i) {
      if (chance(0.01)) silent_until[i] = now + upTo(4000);  // a stall, long enough to be left out
      if (chance(0.01)) skew[i] -= upTo(2000);               // a source that starts again, by itself
      if (chance(0.02)) skew[i] = 0;
      if (now < silent_until[i] || chance(0.05)) continue;  // silent, or one is lost
      const Nanoseconds stamp = now + skew[i] + upTo(15);
      out.push_back({i, stamp, place()});
      if (chance(0.05)) out.push_back({i, stamp, place()});              // the same stamp, another pose
      if (chance(0.03)) out.push_back({i, stamp + 1, place()});          // one nanosecond later
      if (chance(0.04)) out.push_back({i, stamp - upTo(400), place()});  // a straggler
      if (chance(0.01)) out.push_back({i, 0, place()});                  // a header never filled
      if (chance(0.01)) out.push_back({i, 1'000'000'000'000'000'000, place()});  // 1e9 s
    }
    for (int swaps = 0; swaps < 2; ++swaps) {
      if (!chance(0.2) || out.size() < 6) continue;
      const std::size_t last = out.size() - 1;
      std::swap(out[last], out[last - 1 - static_cast<std::size_t>(upTo(4) / with.unit_ns)]);
    }
  }
  return out;
}

}  // namespace collision_node::scene

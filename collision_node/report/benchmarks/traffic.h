/// What moves in the rows of many objects.
#pragma once

#include <utility>
#include <vector>

#include "collision_node/scene/broad_phase/broad_phase.h"

namespace collision_node::report {

constexpr int kTrafficSteps = 100;
constexpr double kTrafficStep = 0.01;  ///< [s]

/// Spheres at constant density, every tenth at 200 to 2000 m/s, the others at up to 10 m/s; who leaves the
/// cube turns round. Kept as poses are: where each is at the beginning of each step, and of one more.
struct Traffic {
  explicit Traffic(std::size_t count);

  std::size_t count() const { return radius.size(); }
  scene::Sweep sweep(int step, std::size_t i) const { return {at[step][i], at[step + 1][i], radius[i]}; }

  std::vector<double> radius;
  std::vector<std::vector<geometry::Vec3>> at;
};

/// The broad phase alone, and the list of pairs that whoever uses it keeps.
class TrafficPairs {
 public:
  explicit TrafficPairs(const Traffic& traffic) : traffic_(traffic), broad_(traffic.count()) {}

  /// Of every step the pairs of swept boxes that meet, but for those that thick lines keep apart.
  std::size_t count();

 private:
  const Traffic& traffic_;
  scene::BroadPhase broad_;
  std::vector<std::pair<int, int>> near_, named_, all_;
};

}  // namespace collision_node::report

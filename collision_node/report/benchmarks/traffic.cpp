#include "collision_node/report/benchmarks/traffic.h"

#include <algorithm>
#include <cmath>

#include "collision_node/report/random.h"
#include "collision_node/scene/broad_phase/broad_phase.h"

namespace collision_node::report {

using scene::BroadPhase;
using scene::Sweep;

std::vector<std::vector<Sweep>> traffic(std::size_t count) {
  Random random(count);
  const double half = 5.0 * std::cbrt(static_cast<double>(count));
  const geometry::Vec3 corner = geometry::Vec3::Constant(half);
  std::vector<geometry::Vec3> at, velocity;
  std::vector<double> radius;
  for (std::size_t i = 0; i < count; ++i) {
    at.push_back(random.inBox(-corner, corner));
    velocity.push_back(i % 10 == 0 ? random.vector(200.0, 2000.0) : random.vector(0.0, 10.0));
    radius.push_back(random.in(0.2, 1.0));
  }
  std::vector<std::vector<Sweep>> steps(kTrafficSteps);
  for (std::vector<Sweep>& step : steps) {
    for (std::size_t i = 0; i < count; ++i) {
      const geometry::Vec3 next = at[i] + kTrafficStep * velocity[i];
      step.push_back({at[i], next, radius[i]});
      at[i] = next;
      for (int k = 0; k < 3; ++k)
        if (std::abs(next[k]) > half) velocity[i][k] = -std::copysign(velocity[i][k], next[k]);
    }
  }
  return steps;
}

std::size_t pairsInTraffic(const std::vector<std::vector<Sweep>>& steps) {
  const int count = static_cast<int>(steps.front().size());
  BroadPhase broad(steps.front().size());
  broad.startEpoch();
  std::vector<std::pair<int, int>> near;
  std::size_t pairs = 0;
  for (int step = 0; step < kTrafficSteps; ++step) {
    const auto known = static_cast<std::ptrdiff_t>(near.size());
    for (int i = 0; i < count; ++i)
      for (const int other : broad.move(i, steps[step][i], step, step + 1, step == 0))
        near.emplace_back(std::min(i, other), std::max(i, other));
    std::sort(near.begin() + known, near.end());
    std::inplace_merge(near.begin(), near.begin() + known, near.end());
    near.erase(std::unique(near.begin(), near.end()), near.end());
    for (const auto& [a, b] : near) pairs += scene::meet(steps[step][a].box(), steps[step][b].box()) ? 1 : 0;
    broad.forgetBefore(step + 1);
    near.erase(std::remove_if(near.begin(), near.end(),
                              [&](const auto& pair) { return !broad.mayMeet(pair.first, pair.second); }),
               near.end());
  }
  return pairs;
}

}  // namespace collision_node::report

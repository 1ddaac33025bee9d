#include "collision_node/report/benchmarks/traffic.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "collision_node/report/random.h"

namespace collision_node::report {

using geometry::Vec3;

Traffic::Traffic(std::size_t count) {
  Random random(count);
  const double half = 5.0 * std::cbrt(static_cast<double>(count));
  const Vec3 corner = Vec3::Constant(half);
  std::vector<Vec3> now, velocity;
  for (std::size_t i = 0; i < count; ++i) {
    now.push_back(random.inBox(-corner, corner));
    velocity.push_back(i % 10 == 0 ? random.vector(200.0, 2000.0) : random.vector(0.0, 10.0));
    radius.push_back(random.in(0.2, 1.0));
  }
  at.push_back(now);
  for (int step = 0; step < kTrafficSteps; ++step) {
    for (std::size_t i = 0; i < count; ++i) {
      now[i] += kTrafficStep * velocity[i];
      for (int k = 0; k < 3; ++k)
        if (std::abs(now[i][k]) > half) velocity[i][k] = -std::copysign(velocity[i][k], now[i][k]);
    }
    at.push_back(now);
  }
}

std::size_t TrafficPairs::count() {
  broad_.startEpoch();
  near_.clear();
  std::size_t pairs = 0;
  for (int step = 0; step < kTrafficSteps; ++step) {
    named_.clear();
    for (int i = 0; i < static_cast<int>(traffic_.count()); ++i)
      for (const int other : broad_.move(i, traffic_.sweep(step, i), step, step + 1, step == 0))
        named_.emplace_back(std::min(i, other), std::max(i, other));
    std::sort(named_.begin(), named_.end());
    named_.erase(std::unique(named_.begin(), named_.end()), named_.end());
    all_.resize(near_.size() + named_.size());
    all_.erase(std::set_union(near_.begin(), near_.end(), named_.begin(), named_.end(), all_.begin()),
               all_.end());
    for (const auto& [a, b] : all_)
      pairs += scene::meet(traffic_.sweep(step, a).box(), traffic_.sweep(step, b).box()) ? 1 : 0;
    broad_.forgetBefore(step + 1);
    near_.clear();
    std::copy_if(all_.begin(), all_.end(), std::back_inserter(near_),
                 [&](const auto& pair) { return broad_.mayMeet(pair.first, pair.second); });
  }
  return pairs;
}

}  // namespace collision_node::report

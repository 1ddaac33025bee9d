#include <algorithm>
#include <numeric>

#include "collision_node/report/benchmarks/other_rows.h"
#include "collision_node/report/peers_broad.h"
#include "collision_node/report/random.h"
#include "collision_node/scene/broad_phase.h"

namespace collision_node::report {
namespace {

using scene::Bounds;
using scene::BroadPhase;
using scene::Sweep;

constexpr int kSteps = 100;

Sweep sweepOf(const geometry::Vec3& from, const geometry::Vec3& to, double radius) {
  return {from, to, radius, scene::grown({from.cwiseMin(to), from.cwiseMax(to)}, radius)};
}

/// By step, then by object: spheres at constant density, every tenth at 200 to 2000 m/s, the others at up to
/// 10 m/s, steps of 10 ms; who leaves the cube comes back through the other side's wall.
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
  std::vector<std::vector<Sweep>> steps(kSteps);
  for (std::vector<Sweep>& step : steps) {
    for (std::size_t i = 0; i < count; ++i) {
      const geometry::Vec3 next = at[i] + 0.01 * velocity[i];
      step.push_back(sweepOf(at[i], next, radius[i]));
      at[i] = next;
      for (int k = 0; k < 3; ++k)
        if (std::abs(next[k]) > half) velocity[i][k] = -std::copysign(velocity[i][k], next[k]);
    }
  }
  return steps;
}

/// The ten lines everybody writes first.
class SortAndSweep : public BroadPeer {
 public:
  explicit SortAndSweep(std::size_t count) : order_(count) { std::iota(order_.begin(), order_.end(), 0U); }

  std::size_t pairs(const std::vector<Bounds>& boxes) override {
    std::size_t pairs = 0;
    std::sort(order_.begin(), order_.end(),
              [&](std::uint32_t l, std::uint32_t r) { return boxes[l].lower.x() < boxes[r].lower.x(); });
    for (std::size_t i = 0; i < order_.size(); ++i) {
      const Bounds& a = boxes[order_[i]];
      for (std::size_t k = i + 1; k < order_.size(); ++k) {
        const Bounds& b = boxes[order_[k]];
        if (b.lower.x() > a.upper.x()) break;
        pairs += scene::meet(a, b) ? 1 : 0;
      }
    }
    return pairs;
  }

 private:
  std::vector<std::uint32_t> order_;
};

/// Every step's pairs of swept boxes that meet, but for those that thick lines keep apart.
std::size_t ours(const std::vector<std::vector<Sweep>>& steps) {
  const int count = static_cast<int>(steps.front().size());
  BroadPhase broad(steps.front().size());
  broad.startEpoch();
  std::vector<std::pair<int, int>> near;
  std::size_t pairs = 0;
  for (int step = 0; step < kSteps; ++step) {
    for (int i = 0; i < count; ++i)
      for (const int other : broad.move(i, steps[step][i], step, step + 1, step == 0))
        near.emplace_back(std::min(i, other), std::max(i, other));
    std::sort(near.begin(), near.end());
    near.erase(std::unique(near.begin(), near.end()), near.end());
    for (const auto& [a, b] : near) pairs += scene::meet(steps[step][a].box, steps[step][b].box) ? 1 : 0;
    broad.forgetBefore(step + 1);
    near.erase(std::remove_if(near.begin(), near.end(),
                              [&](const auto& pair) { return !broad.mayMeet(pair.first, pair.second); }),
               near.end());
  }
  return pairs;
}

Line lineOf(const std::string& row, double here, double there, const std::string& name, double reach,
            const std::string& quality) {
  Line line;
  line.row = row;
  line.ours = readable(here);
  line.reference = readable(there);
  line.reference_name = name;
  line.ratio = there / here;
  line.reach = reach;
  line.quality = quality;
  return line;
}

void swarmLines(std::size_t count, double reach, bool only_ours, std::vector<Line>& lines, double& seconds) {
  const std::vector<std::vector<Sweep>> steps = traffic(count);
  std::vector<std::vector<Bounds>> boxes;
  for (const std::vector<Sweep>& step : steps) {
    boxes.emplace_back();
    for (const Sweep& sweep : step) boxes.back().push_back(sweep.box);
  }
  struct Other {
    std::string name;
    double reach;
    std::unique_ptr<BroadPeer> peer;
    std::size_t pairs;
  };
  std::vector<Other> others;
  const auto compareWith = [&](const char* name, double wanted, std::unique_ptr<BroadPeer> peer) {
    if (peer) others.push_back({name, wanted, std::move(peer), 0});
  };
  if (!only_ours) {
    compareWith("sort and sweep", reach, std::make_unique<SortAndSweep>(count));
    compareWith("FCL SSaP", 1.0, makeFclBroadPhase(boxes.front()));
    compareWith("Bullet btDbvtBroadphase", 1.0, makeBulletBroadPhase(boxes.front()));
  }
  std::size_t here = 0;
  std::vector<std::function<void()>> calls = {[&] { here = ours(steps); }};
  for (Other& other : others) {
    calls.push_back([&other, &boxes] {
      other.pairs = 0;
      for (const std::vector<Bounds>& step : boxes) other.pairs += other.peer->pairs(step);
    });
  }
  const std::vector<double> times = timeByTurns(calls);
  seconds = times[0] / kSteps;
  for (std::size_t i = 0; i < others.size(); ++i)
    lines.push_back(
        lineOf("moving boxes, " + std::to_string(count), seconds, times[i + 1] / kSteps, others[i].name,
               others[i].reach,
               std::to_string(here) + " pairs | - | " + std::to_string(others[i].pairs) + " pairs | -"));
}

void shotLine(bool only_ours, std::vector<Line>& lines) {
  constexpr int kObstacles = 10000, kShots = 1000;
  Random random(7);
  const geometry::Vec3 corner(250.0, 250.0, 20.0);
  std::vector<int> standing;
  std::vector<Bounds> boxes;
  for (int i = 0; i < kObstacles; ++i) {
    const geometry::Vec3 at = random.inBox(-corner, corner);
    standing.push_back(i);
    boxes.push_back(scene::grown({at, at}, random.in(0.2, 1.5)));
  }
  std::vector<Sweep> shots;
  for (int i = 0; i < kShots; ++i) {
    const geometry::Vec3 from = random.inBox(-corner, corner);
    shots.push_back(sweepOf(from, from + random.vector(66.0, 67.0), 0.001));
  }
  BroadPhase broad(kObstacles + 1);
  broad.stand(standing, boxes);
  broad.startEpoch();
  std::size_t named = 0, hits = 0;
  std::vector<std::function<void()>> calls = {[&] {
    named = 0;
    for (const Sweep& shot : shots) {
      named += broad.move(kObstacles, shot, 0, 1, true).size();
      broad.forgetBefore(1);
    }
  }};
  const std::unique_ptr<RayPeer> peer = only_ours ? nullptr : makeEmbreeBoxes(boxes);
  if (peer)
    calls.push_back([&] {
      hits = 0;
      for (const Sweep& shot : shots) hits += peer->hits(shot.from, shot.to) ? 1 : 0;
    });
  const std::vector<double> times = timeByTurns(calls);
  if (peer)
    lines.push_back(lineOf("shot over 10 000 obstacles", times[0] / kShots, times[1] / kShots,
                           "Embree, one ray", 1.0 / 3.0,
                           std::to_string(named) + " named | - | " + std::to_string(hits) + " hit | -"));
}

}  // namespace

std::vector<Line> broadLines(bool only_ours) {
  std::vector<Line> lines;
  double at_1k = 0.0, at_10k = 0.0, any = 0.0;
  swarmLines(100, 1.0, only_ours, lines, any);
  swarmLines(1000, 1.3, only_ours, lines, at_1k);
  swarmLines(10000, 2.0, only_ours, lines, at_10k);
  lines.push_back(
      lineOf("growth, 1k to 10k", at_10k, 12.0 * at_1k, "twelve times a step of 1k", 1.0, "- | - | - | -"));
  shotLine(only_ours, lines);
  return lines;
}

}  // namespace collision_node::report

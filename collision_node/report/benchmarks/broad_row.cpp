#include <algorithm>
#include <limits>
#include <numeric>

#include "collision_node/report/benchmarks/other_rows.h"
#include "collision_node/report/benchmarks/traffic.h"
#include "collision_node/report/peers_broad.h"
#include "collision_node/report/random.h"
#include "collision_node/scene/broad_phase/broad_phase.h"

namespace collision_node::report {
namespace {

using scene::Bounds;
using scene::BroadPhase;
using scene::Sweep;

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

void swarmLines(std::size_t count, double reach, bool only_ours, std::vector<Line>& lines) {
  const Traffic traffic(count);
  std::vector<std::vector<Bounds>> boxes(kTrafficSteps);
  for (int step = 0; step < kTrafficSteps; ++step)
    for (std::size_t i = 0; i < count; ++i) boxes[step].push_back(traffic.sweep(step, i).box());
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
  TrafficPairs ours(traffic);
  std::vector<std::function<void()>> calls = {[&] { here = ours.count(); }};
  for (Other& other : others) {
    calls.push_back([&other, &boxes] {
      other.pairs = 0;
      for (const std::vector<Bounds>& step : boxes) other.pairs += other.peer->pairs(step);
    });
  }
  const std::vector<double> times = timeByTurns(calls);
  for (std::size_t i = 0; i < others.size(); ++i)
    lines.push_back(
        lineOf("moving boxes, " + std::to_string(count), times[0] / kTrafficSteps,
               times[i + 1] / kTrafficSteps, others[i].name, others[i].reach,
               std::to_string(here) + " pairs | - | " + std::to_string(others[i].pairs) + " pairs | -"));
}

/// By turns, too: what the machine does meanwhile is done to both.
void growthLine(std::vector<Line>& lines) {
  const Traffic thousand(1000), ten_thousand(10000);
  TrafficPairs fewer(thousand), more(ten_thousand);
  double of_fewer = std::numeric_limits<double>::infinity(), of_more = of_fewer;
  constexpr int kRounds = 3;  // a few percent decide
  for (int round = 0; round < kRounds; ++round) {
    const std::vector<double> times = timeByTurns({[&] { fewer.count(); }, [&] { more.count(); }});
    of_fewer = std::min(of_fewer, times[0]);
    of_more = std::min(of_more, times[1]);
  }
  lines.push_back(lineOf("growth, 1k to 10k", of_more / kTrafficSteps, 12.0 * of_fewer / kTrafficSteps,
                         "twelve times a step of 1k", 1.0, "- | - | - | -"));
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
    shots.push_back({from, from + random.vector(66.0, 67.0), 0.001});
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
  swarmLines(100, 1.0, only_ours, lines);
  swarmLines(1000, 1.3, only_ours, lines);
  swarmLines(10000, 2.0, only_ours, lines);
  growthLine(lines);
  shotLine(only_ours, lines);
  return lines;
}

}  // namespace collision_node::report

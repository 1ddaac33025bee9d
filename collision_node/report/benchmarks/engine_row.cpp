#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>

#include "collision_node/report/benchmarks/other_rows.h"
#include "collision_node/report/benchmarks/traffic.h"
#include "collision_node/report/made_meshes.h"
#include "collision_node/report/random.h"
#include "collision_node/report/scenes/building.h"
#include "collision_node/scene/engine.h"

namespace collision_node::report {
namespace {

using geometry::Vec3;

scene::Object objectOf(std::size_t number, geometry::Shape shape) {
  char name[16];
  std::snprintf(name, sizeof name, "o%06zu", number);
  scene::Object object;
  object.name = name;
  object.source.type = scene::PoseSource::Type::kTopic;
  object.source.topic = object.name + "/pose";
  scene::Link link;
  link.name = "body";
  link.shapes.push_back({std::move(shape), geometry::Pose(), "made"});
  link.body = std::make_shared<geometry::Body>(link.shapes);
  object.links.push_back(std::move(link));
  return object;
}

motion::StampedPose poseAt(double seconds, const Vec3& position, const geometry::Quat& orientation) {
  motion::StampedPose pose;
  pose.stamp_ns = kStart + static_cast<motion::Nanoseconds>(seconds * 1e9);
  pose.pose = {position, orientation};
  return pose;
}

struct Counts {
  std::size_t events = 0;
  std::size_t most_bytes = 0;  ///< that the engine held at the end of a step
};

/// `pose(object, step)`, all objects step by step.
template <typename PoseAt>
Counts runEngine(const std::shared_ptr<const scene::Scene>& scene, int threads, int steps,
                 const PoseAt& pose) {
  Counts counts;
  const std::size_t before = liveBytes();
  scene::Engine::Sinks sinks;
  sinks.event = [&](const scene::Event&) { ++counts.events; };
  scene::Engine engine(scene, impact::MethodName::kCertified, sinks, {false, threads});
  for (int step = 0; step <= steps; ++step) {
    for (std::size_t i = 0; i < scene->objects.size(); ++i)
      engine.addPose(static_cast<int>(i), pose(i, step));
    counts.most_bytes = std::max(counts.most_bytes, liveBytes() - before);
  }
  engine.flush();
  return counts;
}

void crowdLine(std::size_t count, bool only_ours, std::vector<Line>& lines) {
  const Traffic traffic(count);
  const auto scene = std::make_shared<scene::Scene>();
  for (std::size_t i = 0; i < count; ++i)
    scene->objects.push_back(objectOf(i, geometry::Sphere{traffic.radius[i]}));
  Counts counts;
  std::vector<std::function<void()>> calls = {[&] {
    counts = runEngine(scene, 1, kTrafficSteps, [&](std::size_t i, int step) {
      return poseAt(kTrafficStep * step, traffic.at[step][i], geometry::Quat::Identity());
    });
  }};
  TrafficPairs alone(traffic);
  if (!only_ours) calls.push_back([&] { alone.count(); });
  const std::vector<double> times = timeByTurns(calls);
  if (only_ours) return;
  char quality[100];
  std::snprintf(quality, sizeof quality, "%zu events, %.0f MB | - | - | -", counts.events,
                1e-6 * static_cast<double>(counts.most_bytes));
  lines.push_back(lineOf("engine, " + std::to_string(count) + " movers, a step", times[0] / kTrafficSteps,
                         times[1] / kTrafficSteps, "the broad phase alone", 0.0, quality));
}

/// Bodies that tumble to and fro through each other within `half` [m]: every release has some milliseconds of
/// work.
void threadsLine(const char* name, int count, double half,
                 const std::function<geometry::Shape(int, Random&)>& shape, std::vector<Line>& lines) {
  constexpr int kSteps = 30, kRepeats = 6;  // wall time: others on the machine count
  constexpr double kStep = 0.033;
  Random random(11);
  const auto scene = std::make_shared<scene::Scene>();
  std::vector<Vec3> at, velocity, spin;
  for (int i = 0; i < count; ++i) {
    scene->objects.push_back(objectOf(static_cast<std::size_t>(i), shape(i, random)));
    at.push_back(random.inBox(Vec3::Constant(-half), Vec3::Constant(half)));
    velocity.push_back(random.vector(0.0, 5.0));
    spin.push_back(random.vector(0.0, 20.0));
  }
  const auto poseOf = [&](std::size_t i, int step) {
    const double t = kStep * step;
    const geometry::Quat turned(Eigen::AngleAxisd(spin[i].norm() * t, spin[i].normalized()));
    return poseAt(t, at[i] + velocity[i] * (0.2 * std::sin(5.0 * t)), turned);
  };
  double seconds[2] = {1e9, 1e9};
  std::size_t events[2] = {};
  for (int repeat = 0; repeat < kRepeats; ++repeat) {
    for (const int threads : {1, 2}) {
      const auto start = std::chrono::steady_clock::now();
      events[threads - 1] = runEngine(scene, threads, kSteps, poseOf).events;
      const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
      seconds[threads - 1] = std::min(seconds[threads - 1], taken.count());
    }
  }
  lines.push_back(lineOf(
      std::string("engine, ") + name + ", two threads", seconds[1], seconds[0], "one thread, wall time", 1.8,
      std::to_string(events[1]) + " events | - | " + std::to_string(events[0]) + " events | -"));
}

}  // namespace

std::vector<Line> engineLines(bool only_ours) {
  std::vector<Line> lines;
  for (const std::size_t count : {1000, 10000}) crowdLine(count, only_ours, lines);
  if (only_ours) return lines;
  const auto primitive = [](int i, Random& random) -> geometry::Shape {
    const double size = random.in(0.1, 0.4);
    if (i % 3 == 0) return geometry::Box{Vec3(size, 2.0 * size, 0.5 * size)};
    if (i % 3 == 1) return geometry::Cylinder{0.5 * size, 2.0 * size};
    return geometry::Capsule{0.4 * size, 2.0 * size};
  };
  threadsLine("300 primitives", 300, 2.0, primitive, lines);
  const auto mesh = [](int i, Random&) -> geometry::Shape {
    return geometry::Mesh{noisySphere(11, static_cast<std::uint64_t>(i))};
  };
  threadsLine("30 meshes", 30, 3.0, mesh, lines);
  return lines;
}

}  // namespace collision_node::report

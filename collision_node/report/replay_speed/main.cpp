/// replay_speed: how long `replay` takes for a bag, against reading the same bag through rosbag.
///
///   replay_speed write FILE.bag SCENE.yaml POSES [OBJECTS]   a bag of poses whose truth is in closed form,
///   and its scene replay_speed read FILE.bag                               rosbag::View +
///   instantiate<PoseStamped>; prints seconds replay_speed compare REPLAY FILE.bag SCENE.yaml          both,
///   three times each in turn; the ratio of the best,
///                                                            and the events against the truth
///   replay_speed plans REPLAY FILE.bag SCENE.yaml            replay with and without `--plan full`: times,
///   same bytes replay_speed start REPLAY SCENE.yaml ...                 until each scene is loaded, and
///   memory by then
///
/// The scene: OBJECTS balls of radius 0.1 on a square grid 10 m apart, each on a topic of its own at 100 Hz,
/// all in phase but for a ns each. Ball i swings along x: x = x_i + A s(t), s a triangle wave of period 40 s;
/// A is 1 m, and 5.5 m for every tenth ball, which then meets its neighbour (at its own A = 1, in the
/// opposite phase) once a period.
#include <geometry_msgs/PoseStamped.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace {

constexpr double kRadius = 0.1, kGrid = 10.0, kRate = 100.0, kPeriod = 40.0, kFar = 5.5, kNear = 1.0;
constexpr std::int64_t kFirstNs = 1'700'000'000'000'000'000;

/// 0 at 0, 1 after half a period, 0 again after all of it; straight between stamps, as half a period is a
/// whole number of them.
double wave(std::int64_t step) {
  const auto period = static_cast<std::int64_t>(kPeriod * kRate);
  const std::int64_t at = step % period;
  return static_cast<double>(std::min(at, period - at)) / (0.5 * static_cast<double>(period));
}

std::string nameOf(int i) {
  char text[16];
  std::snprintf(text, sizeof text, "ball%04d", i);
  return text;
}

/// Every tenth ball swings far, away from its left neighbour; the one to its right comes towards it.
double reachOf(int i) { return i % 10 == 0 ? kFar : i % 10 == 1 ? -(kGrid - kFar) : kNear; }

void write(const std::string& bag_name, const std::string& scene_name, std::int64_t poses, int objects) {
  const int side = static_cast<int>(std::ceil(std::sqrt(objects)));
  std::ofstream scene(scene_name);
  scene << "world_frame: world\nobjects:\n";
  for (int i = 0; i < objects; ++i)
    scene << "  " << nameOf(i) << ":\n    sphere: {radius: " << kRadius
          << "}\n    pose: {topic: " << nameOf(i) << "/pose}\n";
  rosbag::Bag bag(bag_name, rosbag::bagmode::Write);
  bag.setCompression(rosbag::compression::Uncompressed);
  geometry_msgs::PoseStamped pose;
  pose.header.frame_id = "world";
  pose.pose.orientation.w = 1.0;
  for (std::int64_t n = 0; n < poses; ++n) {
    const auto i = static_cast<int>(n % objects);
    const std::int64_t step = n / objects;
    pose.header.seq = static_cast<std::uint32_t>(step);
    pose.header.stamp.fromNSec(
        static_cast<std::uint64_t>(kFirstNs + step * static_cast<std::int64_t>(1e9 / kRate) + i));
    pose.pose.position.x = kGrid * (i % side) + reachOf(i) * wave(step);
    pose.pose.position.y = kGrid * (i / side);
    bag.write("/" + nameOf(i) + "/pose", pose.header.stamp, pose);
  }
}

double seconds(const std::chrono::steady_clock::time_point& since) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - since).count();
}

double read(const std::string& name) {
  const auto start = std::chrono::steady_clock::now();
  rosbag::Bag bag(name);
  double sum = 0.0;
  std::uint64_t count = 0;
  for (const auto& message : rosbag::View(bag)) {
    const auto pose = message.instantiate<geometry_msgs::PoseStamped>();
    if (!pose) continue;
    sum += pose->pose.position.x;
    ++count;
  }
  const double took = seconds(start);
  std::printf("rosbag::View + instantiate: %llu poses in %.3f s (sum %.6g)\n",
              static_cast<unsigned long long>(count), took, sum);
  return took;
}

struct Took {
  double wall = 0.0, cpu = 0.0;
  long memory_kb = 0;  // the most that was resident
};

/// Throws nothing: a program that fails ends this one.
Took run(const std::vector<std::string>& words) {
  const auto start = std::chrono::steady_clock::now();
  std::fflush(stdout);  // or the child would print what waits, too
  const pid_t child = fork();
  if (child == 0) {
    std::vector<char*> arguments;
    for (const auto& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    if (std::freopen("/dev/null", "w", stdout) == nullptr) _exit(126);
    execv(arguments.front(), arguments.data());
    _exit(127);
  }
  int status = 0;
  rusage usage{};
  if (child < 0 || wait4(child, &status, 0, &usage) != child || !WIFEXITED(status) ||
      WEXITSTATUS(status) != 0) {
    std::fprintf(stderr, "%s failed\n", words.front().c_str());
    std::exit(1);
  }
  const auto inSeconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return {seconds(start), inSeconds(usage.ru_utime) + inSeconds(usage.ru_stime), usage.ru_maxrss};
}

/// Ball 10 k and ball 10 k + 1 meet where their waves leave no more than two radii between them.
int checkEvents(const std::string& events_name, const std::string& scene_name, std::int64_t steps) {
  int objects = 0;
  std::ifstream scene(scene_name);
  for (std::string line; std::getline(scene, line);) objects += line.rfind("  ball", 0) == 0 ? 1 : 0;
  const int side = static_cast<int>(std::ceil(std::sqrt(objects)));
  const auto period = static_cast<std::int64_t>(kPeriod * kRate);
  // x distance = grid - (reaches) wave <= 2 radius, from that wave on to the same one on the way back.
  const double meets = (kGrid - 2.0 * kRadius) / kGrid * 0.5 * kPeriod;
  std::vector<double> expected;
  for (int i = 0; i + 1 < objects; i += 10) {
    if (i % side == side - 1) continue;
    for (std::int64_t round = 0; round * period < steps; ++round)
      for (const double at : {meets, kPeriod - meets})
        if ((static_cast<double>(round) * kPeriod + at) * kRate < static_cast<double>(steps - 1))
          expected.push_back(static_cast<double>(round) * kPeriod + at);
  }
  std::vector<double> found;
  std::ifstream events(events_name);
  const std::string key = "{\"header\":{\"stamp\":";
  for (std::string line; std::getline(events, line);)
    if (line.rfind(key, 0) == 0)
      found.push_back(1e-9 * static_cast<double>(std::atoll(line.c_str() + key.size()) - kFirstNs));
  std::sort(expected.begin(), expected.end());
  int wrong = found.size() == expected.size() ? 0 : 1;
  for (std::size_t i = 0; i < std::min(found.size(), expected.size()); ++i)
    if (std::abs(found[i] - expected[i]) > 1e-6) ++wrong;  // the phases of a ns each move the instants
  std::printf("events: %zu, in closed form %zu, wrong %d\n", found.size(), expected.size(), wrong);
  return wrong;
}

int compare(const std::string& self, const std::string& replay, const std::string& bag,
            const std::string& scene) {
  const std::string events = bag + ".jsonl";
  Took best_read{1e9, 0.0, 0}, best_replay{1e9, 0.0, 0};
  for (int round = 0; round < 3; ++round) {
    const Took reading = run({self, "read", bag});
    const Took replaying = run({replay, scene, bag, "--jsonl", events});
    if (reading.wall < best_read.wall) best_read = reading;
    if (replaying.wall < best_replay.wall) best_replay = replaying;
  }
  std::printf("rosbag %.2f s, %ld MB; replay %.2f s, %ld MB; ratio %.2f\n", best_read.wall,
              best_read.memory_kb / 1024, best_replay.wall, best_replay.memory_kb / 1024,
              best_replay.wall / best_read.wall);
  rosbag::Bag in(bag);
  rosbag::View view(in);
  std::int64_t steps =
      static_cast<std::int64_t>(std::llround((view.getEndTime() - view.getBeginTime()).toSec() * kRate)) + 1;
  return checkEvents(events, scene, steps) == 0 ? 0 : 1;
}

Took bestOf(int rounds, const std::vector<std::string>& words) {
  Took best{1e9, 1e9, 0};
  for (int round = 0; round < rounds; ++round) {
    const Took took = run(words);
    if (took.cpu < best.cpu) best = took;
  }
  return best;
}

std::string bytesOf(const std::string& name) {
  std::ifstream file(name, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

int comparePlans(const std::string& replay, const std::string& bag, const std::string& scene) {
  const std::string planned = bag + ".planned.jsonl", full = bag + ".full.jsonl";
  const Took best_planned = bestOf(3, {replay, scene, bag, "--jsonl", planned});
  const Took best_full = bestOf(3, {replay, scene, bag, "--jsonl", full, "--plan", "full"});
  const bool same = bytesOf(planned) == bytesOf(full);
  std::printf("replay %.2f s, --plan full %.2f s of CPU; ratio %.3f; %s\n", best_planned.cpu, best_full.cpu,
              best_planned.cpu / best_full.cpu, same ? "the same bytes" : "DIFFERENT events");
  return same ? 0 : 1;
}

void measureStarts(const std::string& replay, const std::vector<std::string>& scenes) {
  for (const std::string& scene : scenes) {
    const Took took = bestOf(10, {replay, scene, "--plan"});
    std::printf("%s: %.1f ms of CPU, %.1f MB\n", scene.c_str(), 1e3 * took.cpu,
                1.024e-3 * static_cast<double>(took.memory_kb));
  }
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  if (words.size() >= 4 && words[0] == "write") {
    write(words[1], words[2], std::atoll(words[3].c_str()),
          words.size() > 4 ? std::atoi(words[4].c_str()) : 100);
    return 0;
  }
  if (words.size() == 2 && words[0] == "read") return read(words[1]) > 0.0 ? 0 : 1;
  if (words.size() == 4 && words[0] == "compare")
    return compare("/proc/self/exe", words[1], words[2], words[3]);
  if (words.size() == 4 && words[0] == "plans") return comparePlans(words[1], words[2], words[3]);
  if (words.size() >= 3 && words[0] == "start") {
    measureStarts(words[1], {words.begin() + 2, words.end()});
    return 0;
  }
  std::fprintf(stderr,
               "usage: replay_speed write FILE.bag SCENE.yaml POSES [OBJECTS] | read FILE.bag | "
               "compare REPLAY FILE.bag SCENE.yaml | plans REPLAY FILE.bag SCENE.yaml | start REPLAY "
               "SCENE.yaml ...\n");
  return 2;
}

// Hours of poses: memory stays flat. An hour, or a day with COLLISION_NODE_LONG.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <fstream>

#include "engine_fixture.h"

namespace collision_node::scene {
namespace {

/// Of this process, from the kernel. [bytes]
double residentMemory() {
  std::ifstream statm("/proc/self/statm");
  double total = 0.0, resident = 0.0;
  statm >> total >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE));
}

TEST(EngineSoak, MemoryStaysFlatOverLoopsSilencesAndImpacts) {
  const double hours = std::getenv("COLLISION_NODE_LONG") ? 24.0 : 1.0;
  std::uint64_t events = 0, beats = 0;
  Engine engine(sceneOf({movingSphere("a"), movingSphere("b"), movingSphere("sometimes")}),
                impact::MethodName::kCertified,
                {[&](const Event&) { ++events; }, [&](const Stats&) { ++beats; }});
  constexpr Nanoseconds kStep = 10, kRound = 20000;  // [ms] 100 Hz; a loop of 20 s
  const auto rounds = static_cast<int>(hours * 3600e3 / kRound);
  double early = 0.0;
  for (int round = 0; round < rounds; ++round) {
    for (Nanoseconds t = 0; t < kRound; t += kStep) {
      const double s = 1e-3 * static_cast<double>(t);
      engine.addPose(0, poseAt(t, 3.0 * std::sin(2.0 * s)));
      if (t % 70 != 0) engine.addPose(1, poseAt(t + 3, 0.5 * std::sin(s)));
      if (round % 3 != 0 || t < kRound / 2) engine.addPose(2, poseAt(t + 5, 5.0));
    }
    if (round == rounds / 5) early = residentMemory();
  }
  const double grown = residentMemory() - early;
  engine.flush();
  EXPECT_EQ(engine.stats().epoch + 1, static_cast<std::uint32_t>(rounds));
  EXPECT_GT(events, 20u * static_cast<std::uint64_t>(rounds));
  EXPECT_GE(beats, 20u * static_cast<std::uint64_t>(rounds));
  EXPECT_LT(grown, 1e6) << "bytes since a fifth of the time";
}

}  // namespace
}  // namespace collision_node::scene

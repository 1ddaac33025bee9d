/// The bar on a terminal.
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "collision_node/replay/progress.h"

namespace collision_node::test {
namespace {

using replay::Progress;
constexpr motion::Nanoseconds kBegin = 1'000'000'000'000, kEnd = kBegin + 8'000'000'000;

/// Messages received at `at_ns` until something is drawn, at most five seconds of them.
std::string drawnAt(motion::Nanoseconds at_ns, Progress& progress, std::ostringstream& out) {
  const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(5);
  while (out.str().empty() && std::chrono::steady_clock::now() < until) progress.at(at_ns);
  return out.str();
}

TEST(Progress, showsHowFarHowFastAndWhatIsLeftAndTakesItselfAway) {
  std::ostringstream out;
  Progress progress(out, true, kBegin, kEnd);
  const std::string line = drawnAt(kBegin + 2'000'000'000, progress, out);
  EXPECT_EQ(line.substr(0, 43), "\r[" + std::string(10, '#') + std::string(30, ' ') + "]") << line;
  EXPECT_NE(line.find("]  25 % "), std::string::npos) << line;
  EXPECT_NE(line.find(" k/s, "), std::string::npos) << line;
  EXPECT_NE(line.find(" s left"), std::string::npos) << line;
  EXPECT_EQ(line.size(), 80u);
  out.str("");
  progress.finish();
  EXPECT_EQ(out.str(), "\r" + std::string(79, ' ') + "\r");
  out.str("");
  progress.finish();
  EXPECT_EQ(out.str(), "");
}

TEST(Progress, staysInItsBarsWhateverTheTimesAre) {
  for (const auto& [at, percent, marks] :
       {std::tuple{kBegin - 5, "]   0 % ", 0}, std::tuple{kEnd + 5, "] 100 % ", 40}}) {
    std::ostringstream out;
    Progress progress(out, true, kBegin, kEnd);
    const std::string line = drawnAt(at, progress, out);
    EXPECT_EQ(std::count(line.begin(), line.end(), '#'), marks);
    EXPECT_NE(line.find(percent), std::string::npos) << line;
  }
}

TEST(Progress, drawsNothingUnlessAskedNorOfARecordingWithoutLength) {
  for (const bool show : {false, true}) {
    std::ostringstream out;
    Progress progress(out, show, kBegin, show ? kBegin : kEnd);
    const auto until = std::chrono::steady_clock::now() + std::chrono::milliseconds(250);
    while (std::chrono::steady_clock::now() < until) progress.at(kBegin);
    progress.finish();
    EXPECT_EQ(out.str(), "");
  }
}

}  // namespace
}  // namespace collision_node::test

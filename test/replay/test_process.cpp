/// The program as a process: interrupts, memory, disks that are full.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <thread>

#include "collision_node/replay/merge.h"
#include "test/replay/bags.h"

namespace collision_node::test {
namespace {

class Process : public testing::Test {
 protected:
  Process() { scene_ = folder_.write("scene.yaml", kScene); }
  std::string path(const std::string& name) const { return folder_.path() + "/" + name; }

  /// Starts the program beside this test; what it prints goes to files.
  pid_t start(const std::vector<std::string>& words, const std::string& out = "/dev/null") {
    const std::string program =
        (std::filesystem::read_symlink("/proc/self/exe").parent_path() / "replay").string();
    std::vector<char*> arguments{const_cast<char*>(program.c_str())};
    for (const auto& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    const std::string err = path("err");
    const pid_t child = fork();
    if (child == 0) {
      if (std::freopen(out.c_str(), "w", stdout) == nullptr ||
          std::freopen(err.c_str(), "w", stderr) == nullptr)
        _exit(126);
      execv(program.c_str(), arguments.data());
      _exit(127);
    }
    return child;
  }
  /// Exit code; `peak_kb`: the most memory that was resident.
  int end(pid_t child, long* peak_kb = nullptr) {
    int status = 0;
    rusage usage{};
    if (wait4(child, &status, 0, &usage) != child || !WIFEXITED(status)) return -1;
    if (peak_kb != nullptr) *peak_kb = usage.ru_maxrss;
    return WEXITSTATUS(status);
  }

  /// A ball that swings through the wall twice a second, 1000 poses a second.
  void writeSwing(const std::string& file, int count, double away = 0.0) {
    rosbag::Bag bag(file, rosbag::bagmode::Write);
    bag.setCompression(rosbag::compression::LZ4);
    geometry_msgs::PoseStamped pose = ballPose(0);
    for (int i = 0; i < count; ++i) {
      pose.header.stamp.fromNSec(static_cast<std::uint64_t>(kFirstNs + 1'000'000LL * i));
      pose.pose.position.x = away + 2.0 * std::sin(1e-3 * 6.283185307179586 * i);
      bag.write("/ball/pose", pose.header.stamp, pose);
    }
  }

  test_support::TempFolder folder_;
  std::string scene_;
};

TEST_F(Process, anInterruptEndsTheWindowThereAndAnotherRunGoesOn) {
  const std::string bag = path("in.bag"), first = path("first.jsonl"), second = path("second.jsonl");
  writeSwing(bag, 100'000);
  for (const int signal : {SIGINT, SIGTERM}) {
    const pid_t child = start({scene_, bag, "--jsonl", first});
    while (!std::filesystem::exists(first + ".part"))
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    kill(child, signal);
    ASSERT_EQ(end(child), 130) << bytesOf(path("err"));
    const std::string err = bytesOf(path("err"));
    const auto at = err.find("--from ");
    ASSERT_NE(at, std::string::npos) << err;
    const std::string from = err.substr(at + 7, err.find('`', at) - at - 7);
    EXPECT_LT(std::atof(from.c_str()), 99.0) << "it was over before it was interrupted";
    EXPECT_FALSE(std::filesystem::exists(first + ".part"));
    ASSERT_EQ(end(start({scene_, bag, "--jsonl", second, "--from", from})), 0) << bytesOf(path("err"));
    ASSERT_EQ(end(start({scene_, bag, "--jsonl", path("whole.jsonl")})), 0);
    ASSERT_EQ(end(start({"merge", first, second, "--jsonl", path("merged.jsonl")})), 0)
        << bytesOf(path("err"));
    EXPECT_TRUE(bytesOf(path("merged.jsonl")) == bytesOf(path("whole.jsonl")));
    std::filesystem::remove(first);
  }
}

/// The second one comes while the end of the window is still being decided: `reorder` is as long as the bag.
TEST_F(Process, aSecondInterruptGivesUp) {
  const std::string bag = path("in.bag"), out = path("out.jsonl");
  writeSwing(bag, 300'000);
  std::string slow = kScene;
  slow.replace(slow.find("reorder: 0.1, max_gap: 0.3, timeout: 0.5"), 40,
               "reorder: 400, max_gap: 0.3, timeout: 500");
  scene_ = folder_.write("slow.yaml", slow);
  for (const int signal : {SIGINT, SIGTERM}) {
    const pid_t child = start({scene_, bag, "--jsonl", out});
    while (!std::filesystem::exists(out + ".part")) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    kill(child, signal);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));  // two at once would count as one
    kill(child, signal);
    EXPECT_EQ(end(child), 130) << bytesOf(path("err"));
    EXPECT_EQ(bytesOf(path("err")).find("--from "), std::string::npos) << bytesOf(path("err"));
    EXPECT_FALSE(std::filesystem::exists(out));
    EXPECT_FALSE(std::filesystem::exists(out + ".part"));
  }
}

/// rosbag's own index takes some 90 bytes of memory a message: 13 MB here.
TEST_F(Process, fourTimesTheRecordingTakesNoMoreMemory) {
  long peak[2] = {0, 0};
  for (int i = 0; i < 2; ++i) {
    const std::string bag = path("long" + std::to_string(i) + ".bag");
    writeSwing(bag, i == 0 ? 50'000 : 200'000, 100.0);
    ASSERT_EQ(end(start({scene_, bag, "--jsonl", path("out.jsonl")}), &peak[i]), 0) << bytesOf(path("err"));
  }
  EXPECT_LT(peak[1], peak[0] + 4096) << peak[0] << " kB, then " << peak[1] << " kB";
}

TEST_F(Process, aFullDiskIsToldAndLeavesNoFile) {
  const std::string bag = path("in.bag");
  writeBall(bag);
  for (const char* option : {"--jsonl", "--csv"}) {
    EXPECT_EQ(end(start({scene_, bag, option, "/dev/full"})), 2) << option;
    EXPECT_NE(bytesOf(path("err")).find("/dev/full: could not be written whole"), std::string::npos);
  }
  EXPECT_EQ(end(start({scene_, bag, "--jsonl", "-"}, "/dev/full")), 2);
  EXPECT_NE(bytesOf(path("err")).find("standard output"), std::string::npos);
  EXPECT_EQ(end(start({scene_, bag, "--out", "/dev/full"})), 2);
  ASSERT_EQ(end(start({scene_, bag, "--jsonl", path("w.jsonl"), "--from", "0"})), 0);
  EXPECT_EQ(end(start({"merge", path("w.jsonl")}, "/dev/full")), 2);
  EXPECT_EQ(end(start({"merge", path("w.jsonl"), "--jsonl", "/dev/full"})), 2);
}

}  // namespace
}  // namespace collision_node::test

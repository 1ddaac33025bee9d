/// Every bad input: code 2, one clear line, no file. The executable itself, too.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <nav_msgs/GridCells.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <tf2_msgs/TFMessage.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstring>

#include "test/replay/bags.h"

namespace collision_node::test {
namespace {

class BadInput : public testing::Test {
 protected:
  BadInput() {
    scene_ = folder_.write("scene.yaml", kScene);
    good_ = path("good.bag");
    writeBall(good_);
  }
  std::string path(const std::string& name) const { return folder_.path() + "/" + name; }

  /// Runs with every kind of output asked for; expects code 2, one line with all `parts`, and nothing
  /// written.
  void expectLine(std::vector<std::string> arguments, const std::vector<std::string>& parts) {
    for (const char* output : {"--out", "--jsonl", "--csv"}) {
      arguments.push_back(output);
      arguments.push_back(path(std::string("result") + output));
    }
    const Outcome got = replayed(arguments);
    EXPECT_EQ(got.code, 2);
    EXPECT_EQ(std::count(got.err.begin(), got.err.end(), '\n'), 1) << got.err;
    for (const auto& part : parts)
      EXPECT_NE(got.err.find(part), std::string::npos) << part << "\nin: " << got.err;
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path()))
      EXPECT_EQ(entry.path().filename().string().find("result"), std::string::npos) << entry.path();
  }

  test_support::TempFolder folder_;
  std::string scene_, good_;
};

/// The program beside this test.
Outcome executed(const std::string& arguments) {
  const auto self = std::filesystem::read_symlink("/proc/self/exe");
  const std::string command = "'" + (self.parent_path() / "replay").string() + "' " + arguments + " 2>&1";
  Outcome outcome;
  FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return outcome;
  char buffer[4096];
  while (const auto n = fread(buffer, 1, sizeof buffer, pipe)) outcome.out.append(buffer, n);
  const int status = pclose(pipe);
  outcome.code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return outcome;
}

TEST_F(BadInput, absentScene) { expectLine({path("none.yaml"), good_}, {path("none.yaml")}); }

TEST_F(BadInput, absentMesh) {
  const std::string scene = folder_.write("mesh.yaml",
                                          "objects:\n  ball:\n    mesh: {file: gone.stl}\n"
                                          "    pose: {topic: ball/pose}\n");
  expectLine({scene, good_}, {"mesh.yaml", "gone.stl"});
}

TEST_F(BadInput, unknownKeyNamesTheNearest) {
  const std::string scene = folder_.write("key.yaml", std::string(kScene) + "precison: {time: 1.0e-9}\n");
  expectLine({scene, good_}, {"key.yaml", "precison", "precision"});
}

TEST_F(BadInput, absentBag) { expectLine({scene_, path("none.bag")}, {path("none.bag"), "no such bag"}); }

TEST_F(BadInput, emptyBag) {
  writeBytes(path("empty.bag"), "");
  expectLine({scene_, path("empty.bag")}, {"empty.bag", "0 bytes"});
}

TEST_F(BadInput, notABag) {
  writeBytes(path("text.bag"), "objects:\n");
  expectLine({scene_, path("text.bag")}, {"text.bag", "#ROSBAG"});
}

TEST_F(BadInput, bagOfAnotherVersion) {
  writeBytes(path("old.bag"), "#ROSBAG V1.2\n" + std::string(100, 'x'));
  expectLine({scene_, path("old.bag")}, {"old.bag", "version V1.2", "V2.0", "rosbag fix"});
}

TEST_F(BadInput, aLengthThatNoMessageHas) {
  {
    rosbag::Bag bag(path("long.bag"), rosbag::bagmode::Write);
    bag.setCompression(rosbag::compression::Uncompressed);
    for (int i = 0; i < 60; ++i) bag.write("/ball/pose", ballPose(i).header.stamp, ballPose(i));
  }
  std::string bytes = bytesOf(path("long.bag"));
  // A message's bytes begin with seq 0 and the stamp; its length stands before.
  const auto stamp = ballPose(40).header.stamp;
  std::string start(8, '\0');
  std::memcpy(start.data(), &stamp.sec, 4);
  std::memcpy(start.data() + 4, &stamp.nsec, 4);
  std::size_t at = std::string::npos;
  for (std::size_t from = bytes.find(start); from != std::string::npos; from = bytes.find(start, from + 1))
    if (bytes.compare(from + 12, 5, "world") == 0) at = from - 8;
  ASSERT_NE(at, std::string::npos);
  const std::uint32_t length = 1'500'000'000;
  std::memcpy(bytes.data() + at, &length, 4);
  writeBytes(path("long.bag"), bytes);
  const Outcome got =
      executed("'" + scene_ + "' '" + path("long.bag") + "' --jsonl '" + path("kept.jsonl") + "'");
  EXPECT_EQ(got.code, 2) << got.out;
  EXPECT_NE(got.out.find("longer than its chunk"), std::string::npos) << got.out;
  const std::string kept = bytesOf(path("kept.jsonl"));
  EXPECT_EQ(std::count(kept.begin(), kept.end(), '\n'), 2) << "the events before the damage are kept";
}

/// The messages themselves say when they came: the index of a chunk is not needed.
TEST_F(BadInput, anIndexThatPointsBeyondItsChunk) {
  std::string bytes = bytesOf(good_);
  const auto stamp = ballPose(30).header.stamp;
  std::string time(8, '\0');
  std::memcpy(time.data(), &stamp.sec, 4);
  std::memcpy(time.data() + 4, &stamp.nsec, 4);
  const auto at = bytes.find(time);  // the bag is compressed: only the index holds it as it is
  ASSERT_NE(at, std::string::npos);
  bytes[at + 11] = '\x7f';
  writeBytes(path("index.bag"), bytes);
  const Outcome got = executed("'" + scene_ + "' '" + path("index.bag") + "'");
  EXPECT_EQ(got.code, 0);
  EXPECT_EQ(got.out, executed("'" + scene_ + "' '" + good_ + "'").out);
}

TEST_F(BadInput, aChunkThatLiesBesideItsTime) {
  std::string bytes = bytesOf(good_);
  // The end of a bag says of each chunk when its messages came.
  const auto at = bytes.find("start_time=");
  ASSERT_NE(at, std::string::npos);
  bytes[at + 11] = static_cast<char>(bytes[at + 11] + 1);
  writeBytes(path("late.bag"), bytes);
  const Outcome got = executed("'" + scene_ + "' '" + path("late.bag") + "'");
  EXPECT_EQ(got.code, 2);
  EXPECT_NE(got.out.find("outside its chunk's time"), std::string::npos) << got.out;
}

TEST_F(BadInput, aTimeInTheIndexThatIsNone) {
  std::string bytes = bytesOf(good_);
  // The index of a chunk holds each message's receive time a second time: damage the last one's.
  const auto stamp = ballPose(59).header.stamp;
  std::string time(8, '\0');
  std::memcpy(time.data(), &stamp.sec, 4);
  std::memcpy(time.data() + 4, &stamp.nsec, 4);
  int damaged = 0;
  for (std::size_t at = bytes.find(time); at != std::string::npos; at = bytes.find(time, at + 1), ++damaged)
    bytes[at + 3] = '\xff';
  ASSERT_GT(damaged, 0);
  writeBytes(path("time.bag"), bytes);
  const Outcome got = executed("'" + scene_ + "' '" + path("time.bag") + "'");
  EXPECT_NE(got.code, -1) << "killed by a signal: " << got.out;
}

TEST_F(BadInput, aPackageThatNobodyHas) {
  const std::string scene =
      folder_.write("package.yaml",
                    "objects:\n  ball:\n    mesh: {file: package://no_such_package/a.stl}\n"
                    "    pose: {topic: ball/pose}\n");
  const Outcome got = executed("'" + scene + "' '" + good_ + "'");
  EXPECT_EQ(got.code, 2);
  EXPECT_EQ(std::count(got.out.begin(), got.out.end(), '\n'), 1) << got.out;
  EXPECT_NE(got.out.find("no_such_package"), std::string::npos) << got.out;
}

TEST_F(BadInput, bagWithoutMessages) {
  { rosbag::Bag bag(path("void.bag"), rosbag::bagmode::Write); }
  expectLine({scene_, path("void.bag")}, {"void.bag", "no messages"});
}

TEST_F(BadInput, bagThatWasNeverClosed) {
  std::string bytes = bytesOf(good_);
  const auto at = bytes.find("index_pos=");
  ASSERT_NE(at, std::string::npos);
  bytes.replace(at + 10, 8, std::string(8, '\0'));
  writeBytes(path("open.bag"), bytes);
  expectLine({scene_, path("open.bag")}, {"open.bag", "rosbag reindex", "copy"});
}

TEST_F(BadInput, truncatedBag) {
  const std::string bytes = bytesOf(good_);
  for (const double share : {0.3, 0.7, 0.99}) {
    writeBytes(path("cut.bag"),
               bytes.substr(0, static_cast<std::size_t>(share * static_cast<double>(bytes.size()))));
    expectLine({scene_, path("cut.bag")}, {"cut.bag", "rosbag reindex", "copy"});
  }
}

TEST_F(BadInput, topicThatTheBagLacks) {
  writeBall(path("other.bag"), 10, "/puck/pose");
  expectLine({scene_, path("other.bag")}, {"/ball/pose", "/puck/pose (geometry_msgs/PoseStamped)"});
}

TEST_F(BadInput, wrongTypeOnATopic) {
  {
    rosbag::Bag bag(path("cells.bag"), rosbag::bagmode::Write);
    bag.write("/ball/pose", ros::Time(1), nav_msgs::GridCells());
  }
  expectLine({scene_, path("cells.bag")}, {"/ball/pose", "'ball'", "nav_msgs/GridCells"});
  // Told from the connections, before anything is read.
  expectLine({scene_, path("cells.bag"), "--from", "100"}, {"/ball/pose", "'ball'", "nav_msgs/GridCells"});
}

TEST_F(BadInput, wrongFrame) {
  writeBall(path("odom.bag"), 10, "/ball/pose", "odom");
  expectLine({scene_, path("odom.bag")}, {"/ball/pose", "'odom", "'world'"});
}

TEST_F(BadInput, tfFrameThatHangsOnNothing) {
  const std::string scene = folder_.write("tf.yaml",
                                          "objects:\n  ball:\n    point: {}\n    pose: {tf: bal}\n"
                                          "  wall:\n    point: {}\n    pose: {fixed: {}}\n");
  {
    rosbag::Bag bag(path("tf.bag"), rosbag::bagmode::Write);
    tf2_msgs::TFMessage tf;
    tf.transforms.resize(1);
    tf.transforms[0].header.frame_id = "world";
    tf.transforms[0].child_frame_id = "ball";
    tf.transforms[0].transform.rotation.w = 1.0;
    bag.write("/tf", ros::Time(1), tf);
  }
  expectLine({scene, path("tf.bag")}, {"'bal'", "'world'", "ball"});
}

TEST_F(BadInput, outputsThatCannotBe) {
  EXPECT_EQ(replayed({scene_, good_, "--out", path("no/such/out.bag")}).code, 2);
  const std::string before = bytesOf(good_);
  const Outcome got = replayed({scene_, good_, "--out", good_});
  EXPECT_EQ(got.code, 2);
  EXPECT_NE(got.err.find("is an input"), std::string::npos) << got.err;
  EXPECT_EQ(bytesOf(good_), before);
  EXPECT_EQ(replayed({scene_, good_, "--csv", "-"}).code, 2);
}

TEST_F(BadInput, resultsNeverReplaceAnInputNorEachOther) {
  const std::string before = bytesOf(scene_);
  for (const char* option : {"--jsonl", "--csv", "--out"}) {
    const Outcome got = replayed({scene_, good_, option, scene_});
    EXPECT_EQ(got.code, 2) << option;
    EXPECT_NE(got.err.find("is an input"), std::string::npos) << got.err;
    EXPECT_EQ(bytesOf(scene_), before) << option;
  }
  const std::string same = path("same");
  for (const std::string& other : {same, same + ".part", folder_.path() + "/./same"}) {
    const Outcome got = replayed({scene_, good_, "--jsonl", same, "--csv", other});
    EXPECT_EQ(got.code, 2) << other;
    EXPECT_EQ(std::count(got.err.begin(), got.err.end(), '\n'), 1) << got.err;
    EXPECT_NE(got.err.find("file of its own"), std::string::npos) << got.err;
    EXPECT_FALSE(std::filesystem::exists(same));
    EXPECT_FALSE(std::filesystem::exists(other));
  }
  // The name that is written first may be an input, too.
  std::filesystem::copy_file(good_, path("x.part"));
  EXPECT_EQ(replayed({scene_, path("x.part"), "--jsonl", path("x")}).code, 2);
  EXPECT_EQ(bytesOf(path("x.part")), bytesOf(good_));
}

TEST_F(BadInput, aPipeIsWrittenIntoAndStaysAPipe) {
  const std::string pipe = path("pipe");
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  const int reader = open(pipe.c_str(), O_RDONLY | O_NONBLOCK);  // its buffer holds the two events
  ASSERT_GE(reader, 0);
  EXPECT_EQ(replayed({scene_, good_, "--jsonl", pipe}).code, 0);
  char bytes[65536];
  const auto size = read(reader, bytes, sizeof bytes);
  close(reader);
  ASSERT_GT(size, 0);
  EXPECT_EQ(std::count(bytes, bytes + size, '\n'), 2);
  EXPECT_TRUE(std::filesystem::is_fifo(pipe));
  EXPECT_FALSE(std::filesystem::exists(pipe + ".part"));
  EXPECT_EQ(replayed({scene_, good_, "--out", pipe}).code, 2) << "a bag cannot be written into a pipe";
  EXPECT_TRUE(std::filesystem::is_fifo(pipe));
}

TEST_F(BadInput, aLinkStaysALink) {
  writeBytes(path("target.csv"), "old");
  std::filesystem::create_symlink(path("target.csv"), path("link.csv"));
  EXPECT_EQ(replayed({scene_, good_, "--csv", path("link.csv")}).code, 0);
  EXPECT_TRUE(std::filesystem::is_symlink(path("link.csv")));
  EXPECT_NE(bytesOf(path("target.csv")), "old");
}

TEST_F(BadInput, badArguments) {
  expectLine({scene_, good_, "--from", "1e12"}, {"--from", "1e12", "1e9"});
  expectLine({scene_, good_, "--to", "5e9"}, {"--to", "5e9", "1e9"});
  expectLine({scene_, good_, "--method", "best"}, {"best", "certified", "paper_a"});
  expectLine({scene_, good_, "--form", "1"}, {"--form"});
  expectLine({scene_, good_, "--from", "soon"}, {"--from", "soon"});
  expectLine({scene_, good_, "--from", "2", "--to", "1"}, {"--from", "--to"});
  expectLine({scene_, good_, "--threads", "0"}, {"--threads", "0"});
  expectLine({scene_}, {"no bag"});
  EXPECT_EQ(replayed({}).code, 2);
  EXPECT_EQ(replayed({scene_, good_, "--out"}).code, 2);
}

TEST_F(BadInput, aDamagedChunkKeepsWhatCameBefore) {
  const std::string file = path("damaged.bag");
  writeBall(file, 60, "/ball/pose", "world", 400);
  std::string bytes = bytesOf(file);
  std::vector<std::size_t> chunks;
  for (std::size_t at = bytes.find("compression=lz4"); at != std::string::npos;
       at = bytes.find("compression=lz4", at + 1))
    chunks.push_back(at);
  ASSERT_GT(chunks.size(), 6u);
  const std::size_t middle = chunks[chunks.size() / 2];
  for (std::size_t i = 0; i < 40; ++i) bytes[middle + 100 + i] = static_cast<char>(~bytes[middle + 100 + i]);
  writeBytes(file, bytes);

  const Outcome got = replayed({scene_, file, "--jsonl", path("kept.jsonl"), "--out", path("kept.bag")});
  EXPECT_EQ(got.code, 2);
  EXPECT_EQ(std::count(got.err.begin(), got.err.end(), '\n'), 1) << got.err;
  EXPECT_NE(got.err.find("damaged.bag"), std::string::npos) << got.err;
  EXPECT_NE(got.err.find("messages before it are used"), std::string::npos) << got.err;
  const std::string kept = bytesOf(path("kept.jsonl"));
  EXPECT_EQ(std::count(kept.begin(), kept.end(), '\n'), 2) << "the impact came before the damage";
  EXPECT_TRUE(std::filesystem::exists(path("kept.bag")));
}

TEST_F(BadInput, theProgramReturnsTheCode) {
  EXPECT_EQ(executed("'" + scene_ + "' '" + good_ + "'").code, 0);
  EXPECT_EQ(executed("'" + scene_ + "' /none.bag").code, 2);
  const Outcome help = executed("--help");
  EXPECT_EQ(help.code, 0);
  EXPECT_NE(help.out.find("--jsonl"), std::string::npos);
}

}  // namespace
}  // namespace collision_node::test

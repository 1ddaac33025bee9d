/// Bags as one stream: order, compression, cuts, several bags, damage anywhere.
#include <gtest/gtest.h>
#include <rosbag/view.h>
#include <std_msgs/UInt32.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <random>
#include <tuple>

#include "collision_node/replay/bag_stream.h"
#include "test/replay/bags.h"

namespace collision_node::test {
namespace {

using replay::BagFile;
using replay::BagStream;
using replay::Nanoseconds;

constexpr Nanoseconds kEver = std::numeric_limits<Nanoseconds>::min();
constexpr Nanoseconds kNever = std::numeric_limits<Nanoseconds>::max();

using Got = std::vector<std::tuple<Nanoseconds, std::string, std::uint32_t>>;

class Stream : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return folder_.path() + "/" + name; }

  /// Messages that carry their own number, received out of order by up to `wobble` ns, in small chunks.
  void write(const std::string& name, int count, rosbag::compression::CompressionType compression,
             std::uint32_t seed, std::int64_t wobble) {
    rosbag::Bag bag(path(name), rosbag::bagmode::Write);
    bag.setCompression(compression);
    bag.setChunkThreshold(700);
    std::mt19937 random(seed);
    for (int i = 0; i < count; ++i) {
      std_msgs::UInt32 message;
      message.data = seed * 100'000 + static_cast<std::uint32_t>(i);
      ros::Time time;
      const auto late = std::uniform_int_distribution<std::int64_t>(0, wobble)(random);
      time.fromNSec(static_cast<std::uint64_t>(1'000'000'000'000 + i * 1000 + late));
      bag.write("/topic" + std::to_string(random() % 5), time, message);
    }
  }

  Got ours(const std::vector<std::string>& names, Nanoseconds from, Nanoseconds to) const {
    std::vector<std::unique_ptr<BagFile>> bags;
    std::vector<std::vector<Nanoseconds>> wanted;
    for (const auto& name : names) {
      bags.push_back(std::make_unique<BagFile>(path(name)));
      wanted.emplace_back(bags.back()->connections().size(), from);
    }
    BagStream stream(bags, wanted, to);
    Got out;
    while (const auto* m = stream.next()) {
      std::uint32_t number = 0;
      std::memcpy(&number, m->data, std::min<std::size_t>(m->size, sizeof number));
      out.emplace_back(m->received_ns, bags[m->bag]->connections()[m->connection].topic, number);
    }
    return out;
  }

  /// What rosbag says; messages of one time in whatever order.
  Got theirs(const std::vector<std::string>& names, Nanoseconds from, Nanoseconds to) const {
    Got out;
    for (const auto& name : names) {
      rosbag::Bag bag(path(name));
      for (const auto& m : rosbag::View(bag)) {
        const auto time = static_cast<Nanoseconds>(m.getTime().toNSec());
        if (time >= from && time < to)
          out.emplace_back(time, m.getTopic(), m.instantiate<std_msgs::UInt32>()->data);
      }
    }
    return out;
  }

  test_support::TempFolder folder_;
};

TEST_F(Stream, holdsWhatRosbagHoldsInOrderOfReceiveTime) {
  write("plain.bag", 700, rosbag::compression::Uncompressed, 1, 0);
  write("lz4.bag", 700, rosbag::compression::LZ4, 2, 40'000);
  write("bz2.bag", 700, rosbag::compression::BZ2, 3, 400'000);
  const std::vector<std::string> all{"plain.bag", "lz4.bag", "bz2.bag"};
  for (const auto& names : {std::vector<std::string>{"plain.bag"}, {"lz4.bag"}, {"bz2.bag"}, all})
    for (const auto& [from, to] : {std::pair{kEver, kNever}, {1'000'000'100'000, 1'000'000'400'500}}) {
      Got got = ours(names, from, to), expected = theirs(names, from, to);
      EXPECT_TRUE(std::is_sorted(got.begin(), got.end(), [](const auto& l, const auto& r) {
        return std::get<0>(l) < std::get<0>(r);
      }));
      std::sort(got.begin(), got.end());
      std::sort(expected.begin(), expected.end());
      EXPECT_EQ(got, expected) << names.front() << " of " << names.size();
      EXPECT_FALSE(got.empty());
    }
}

TEST_F(Stream, equalTimesComeInTheOrderOfBagsAndWriting) {
  for (const char* name : {"a.bag", "b.bag"}) {
    rosbag::Bag bag(path(name), rosbag::bagmode::Write);
    bag.setChunkThreshold(300);
    std_msgs::UInt32 message;
    for (int i = 0; i < 200; ++i) {
      message.data = static_cast<std::uint32_t>(i + (name[0] == 'b' ? 1000 : 0));
      bag.write(i % 2 == 0 ? "/p" : "/q", ros::Time(5), message);
    }
  }
  const Got got = ours({"a.bag", "b.bag"}, kEver, kNever);
  ASSERT_EQ(got.size(), 400u);
  for (std::uint32_t i = 0; i < 400; ++i) EXPECT_EQ(std::get<2>(got[i]), i < 200 ? i : i + 800);
}

/// Any damage is told: never a crash, never a message that was not written.
TEST_F(Stream, randomDamage) {
  int refused = 0, broken = 0, whole = 0;
  for (const auto compression :
       {rosbag::compression::Uncompressed, rosbag::compression::LZ4, rosbag::compression::BZ2}) {
    write("good.bag", 120, compression, 4, 10'000);
    const std::string good = bytesOf(path("good.bag"));
    const Got all = ours({"good.bag"}, kEver, kNever);
    std::mt19937 random(static_cast<std::uint32_t>(compression) + 1);
    for (int round = 0; round < 150; ++round) {
      std::string bytes = good;
      for (int i = 0; i < 3; ++i) bytes[random() % bytes.size()] = static_cast<char>(random());
      if (round % 10 == 0) bytes.resize(random() % bytes.size());
      writeBytes(path("bad.bag"), bytes);
      try {
        const Got got = ours({"bad.bag"}, kEver, kNever);
        ++whole;
        EXPECT_LE(got.size(), all.size());
      } catch (const replay::InputError&) {
        ++refused;
      } catch (const replay::DamageError&) {
        ++broken;
      }
    }
  }
  EXPECT_GT(refused, 20);
  EXPECT_GT(broken, 20);
  EXPECT_GT(whole, 20);
}

}  // namespace
}  // namespace collision_node::test

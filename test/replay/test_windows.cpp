/// Windows of a recording, merged, are the bytes of one run; what cannot be merged is refused.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <set>

#include "collision_node/replay/merge.h"
#include "test/replay/bags.h"
#include "test/replay/random_recording.h"

namespace collision_node::test {
namespace {

class Windows : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return folder_.path() + "/" + name; }

  /// Seconds after the begin, so that the same nanosecond is read back.
  static std::string seconds(std::int64_t ns) {
    char text[40];
    std::snprintf(text, sizeof text, "%lld.%09lld", static_cast<long long>(ns / 1'000'000'000),
                  static_cast<long long>(ns % 1'000'000'000));
    return text;
  }

  /// Runs [from, to); a negative one is the begin or the end.
  std::string window(const std::string& name, std::int64_t from, std::int64_t to) {
    std::vector<std::string> words{scene_, bag_, "--jsonl", path(name), "--lead", lead_};
    if (from >= 0) words.insert(words.end(), {"--from", seconds(from)});
    if (to >= 0) words.insert(words.end(), {"--to", seconds(to)});
    const Outcome got = replayed(words);
    EXPECT_EQ(got.code, 0) << got.err;
    return path(name);
  }

  Outcome merged(std::vector<std::string> words) {
    std::ostringstream out;
    Outcome outcome;
    try {
      outcome.code = replay::merge(replay::parseMergeOptions(words), out);
    } catch (const replay::InputError& error) {
      outcome.code = 2;
      outcome.err = error.what();
    }
    outcome.out = out.str();
    return outcome;
  }

  void record(std::uint32_t seed, const RandomRecording::Traits& traits) {
    const RandomRecording recording(seed, traits);
    received_ = recording.received();
    scene_ = folder_.write("scene.yaml", kRandomScene);
    folder_.write("crane.urdf", kCraneUrdf);
    bag_ = path("in.bag");
    recording.write(bag_);
    whole_ = replayed({scene_, bag_, "--jsonl", "-"}).out;
  }

  /// At random, at the receive time of a message, or just behind it.
  std::vector<std::int64_t> cuts(std::mt19937& random) const {
    std::set<std::int64_t> out;
    const auto count = 1 + random() % 5;
    while (out.size() < count) {
      const std::int64_t at = received_[random() % received_.size()];
      const auto kind = random() % 3;
      if (kind == 0) out.insert(at);
      if (kind == 1) out.insert(std::min(at + 1, received_.back()));
      if (kind == 2) out.insert(static_cast<std::int64_t>(random() % 8'000'000'000ULL));
    }
    return {out.begin(), out.end()};
  }

  /// "" when they are the same.
  static std::string difference(const std::string& got, const std::string& expected) {
    std::istringstream l(got), r(expected);
    for (int number = 1;; ++number) {
      std::string left = "(nothing)", right = left;
      const bool has_left = !!std::getline(l, left), has_right = !!std::getline(r, right);
      if (!has_left && !has_right) return "";
      if (left != right)
        return "line " + std::to_string(number) + "\ngot      " + left.substr(0, 400) + "\nexpected " +
               right.substr(0, 400);
    }
  }

  static std::size_t contactsAt(const std::string& file) {
    std::istringstream lines(bytesOf(file));
    std::string first;
    std::getline(lines, first);
    return static_cast<std::size_t>(std::count(first.begin(), first.end(), '{') - 2) / 3;
  }

  /// Merges windows at random cuts, all of them and some of them.
  void expectSameBytes(std::uint32_t seed) {
    std::mt19937 random(seed + 1000);
    std::vector<std::int64_t> ends = cuts(random);
    ends.insert(ends.begin(), -1);
    ends.push_back(-1);
    lead_ = "0";
    if (!mergesToTheSameBytes(seed, ends, random)) {
      ++refused_;
      lead_ = "1e9";
      ASSERT_TRUE(mergesToTheSameBytes(seed, ends, random)) << "seed " << seed;
    }
  }

  /// False when the merge is refused.
  bool mergesToTheSameBytes(std::uint32_t seed, const std::vector<std::int64_t>& ends, std::mt19937& random) {
    std::vector<std::string> files;
    for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
      files.push_back(window("w" + std::to_string(i), ends[i], ends[i + 1]));
      if (i > 0 && contactsAt(files.back()) > 0) ++cut_contacts_;
      ++windows_;
    }
    std::vector<std::string> shuffled = files;
    std::shuffle(shuffled.begin(), shuffled.end(), random);
    const Outcome all = merged(shuffled);
    if (all.code == 2) {
      EXPECT_NE(all.err.find("--lead"), std::string::npos) << all.err;
      return false;
    }
    EXPECT_EQ(difference(all.out, whole_), "") << "seed " << seed;
    const std::size_t first = random() % files.size(), last = first + random() % (files.size() - first);
    const Outcome some = merged({files.begin() + static_cast<std::ptrdiff_t>(first),
                                 files.begin() + static_cast<std::ptrdiff_t>(last) + 1});
    EXPECT_EQ(some.code, 0) << some.err;
    if (first > 0 || last + 1 < files.size()) {
      EXPECT_EQ(difference(some.out, bytesOf(window("some", ends[first], ends[last + 1]))), "")
          << "seed " << seed;
    }
    return true;
  }

  test_support::TempFolder folder_;
  std::string scene_, bag_, whole_, lead_ = "0";
  std::vector<std::int64_t> received_;
  int windows_ = 0, cut_contacts_ = 0, refused_ = 0;
};

TEST_F(Windows, mergedAreOneRun) {
  const std::uint32_t rounds = std::getenv("COLLISION_NODE_LONG") != nullptr ? 1000 : 30;
  std::size_t events = 0;
  for (std::uint32_t seed = 1; seed <= rounds; ++seed) {
    RandomRecording::Traits traits;
    traits.loops = seed % 3 == 0;
    traits.stone_once = seed % 5 == 0;
    traits.holes = seed % 2 == 0;
    record(seed, traits);
    events += static_cast<std::size_t>(std::count(whole_.begin(), whole_.end(), '\n'));
    expectSameBytes(seed);
    if (HasFailure()) return;
  }
  std::printf("%d windows of %u recordings, %zu events; %d windows began in a contact\n", windows_, rounds,
              events, cut_contacts_);
  EXPECT_GT(events, 10u * rounds);
  EXPECT_GT(cut_contacts_, static_cast<int>(rounds) / 4);
}

/// The ball is in the wall from 99.7 to 100.9 ms after its first pose; its fourth pose is at 100 ms.
class Walls : public Windows {
 protected:
  Walls() {
    scene_ = folder_.write("scene.yaml", kScene);
    bag_ = path("in.bag");
    writeBall(bag_);
    whole_ = replayed({scene_, bag_, "--jsonl", "-"}).out;
    first_ = window("first.jsonl", -1, kCut);
    second_ = window("second.jsonl", kCut, -1);
  }
  void expectRefused(const std::vector<std::string>& files, const std::vector<std::string>& parts) {
    const Outcome got = merged(files);
    EXPECT_EQ(got.code, 2);
    EXPECT_EQ(got.out, "");
    for (const auto& part : parts)
      EXPECT_NE(got.err.find(part), std::string::npos) << part << "\n" << got.err;
  }
  std::string edited(const std::string& file, const std::string& from, const std::string& to) {
    std::string bytes = bytesOf(file);
    const auto at = bytes.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    if (at != std::string::npos) bytes.replace(at, from.size(), to);
    writeBytes(path("edited.jsonl"), bytes);
    return path("edited.jsonl");
  }

  static constexpr std::int64_t kCut = 110'000'000;
  std::string first_, second_;
};

TEST_F(Walls, aCutInAContactIsNamedOnBothSidesAndJoined) {
  EXPECT_EQ(contactsAt(second_), 1u);
  const std::string closes = bytesOf(first_), opens = bytesOf(second_);
  const std::string contact =
      "\"contacts\":[{\"contact_id\":0,\"a\":{\"object\":\"ball\",\"link\":\"ball\"},\"b\":{\"object\":"
      "\"wall\",\"link\":\"wall\"}}]}\n";
  EXPECT_EQ(closes.substr(closes.size() - contact.size()), contact);
  EXPECT_NE(opens.find(contact), std::string::npos);
  EXPECT_NE(closes.find("\"IMPACT\""), std::string::npos);
  EXPECT_NE(opens.find("\"SEPARATION\""), std::string::npos);
  EXPECT_EQ(merged({second_, first_}).out, whole_);
  ASSERT_EQ(merged({first_, second_, "--jsonl", path("merged.jsonl")}).code, 0);
  EXPECT_EQ(bytesOf(path("merged.jsonl")), whole_);
}

TEST_F(Walls, emptyWindowsAndWholeOnesMergeToo) {
  const std::string empty = window("empty.jsonl", kCut, kCut);
  EXPECT_EQ(merged({first_, empty, second_}).out, whole_);
  const std::string all = window("all.jsonl", 0, 1'000'000'000'000);
  EXPECT_NE(bytesOf(all), whole_);
  EXPECT_EQ(merged({all}).out, whole_);
}

TEST_F(Walls, whatDoesNotFitIsRefused) {
  const std::string early = window("early.jsonl", -1, kCut - 50'000'000),
                    late = window("late.jsonl", kCut + 1, -1);
  expectRefused({early, second_}, {"early.jsonl", "second.jsonl", "hole", "0.060000000 s", "0.110000000 s"});
  expectRefused({first_, late}, {"hole"});
  expectRefused({first_, window("wide.jsonl", kCut - 50'000'000, -1)}, {"overlap"});
  expectRefused({first_, first_, second_}, {"overlap"});
  expectRefused({path("none.jsonl")}, {"none.jsonl", "cannot be read"});
  writeBytes(path("plain.jsonl"), whole_);
  expectRefused({path("plain.jsonl")}, {"plain.jsonl", "where it was cut"});
  expectRefused({bag_}, {"in.bag"});
  const std::string bytes = bytesOf(first_);
  writeBytes(path("short.jsonl"), bytes.substr(0, bytes.size() - 10));
  expectRefused({path("short.jsonl"), second_}, {"short.jsonl", "line 3", "did not finish"});
  writeBytes(path("open.jsonl"), bytes.substr(0, bytes.rfind("{\"window\"")));
  expectRefused({path("open.jsonl"), second_}, {"open.jsonl", "no line that closes"});
  expectRefused({first_, edited(second_, "\"stamp\":17", "\"stamp\":16")}, {"do not agree", "--lead"});
  expectRefused({first_, edited(second_, "{\"object\":\"wall\"", "{\"object\":\"door\"")},
                {"ball/ball", "door"});
  expectRefused({first_, edited(second_, "\"messages\":60", "\"messages\":61")}, {"different recordings"});
  expectRefused({edited(first_, "\"epoch\":0,\"event_id\"", "\"epoch\":7,\"event_id\""), second_},
                {"edited.jsonl", "epoch"});
  expectRefused({edited(first_, "\"event_id\":0", "\"event_id\":1"), second_}, {"event 0", "missing"});
  expectRefused({}, {"no windows"});
  expectRefused({first_, "--json"}, {"--json"});
  expectRefused({first_, second_, "--jsonl", first_}, {"is an input"});
  EXPECT_EQ(bytesOf(first_), bytes);
}

TEST_F(Walls, windowsOfAnotherSceneAreRefused) {
  std::string text = kScene;
  text.replace(text.find("radius: 0.1"), 11, "radius: 0.2");
  scene_ = folder_.write("other.yaml", text);
  expectRefused({first_, window("other.jsonl", kCut, -1)}, {"different scenes"});
  // The same scene under another name is the same.
  scene_ = folder_.write("copy.yaml", kScene);
  EXPECT_EQ(merged({first_, window("copy.jsonl", kCut, -1)}).out, whole_);
}

TEST_F(Walls, aWindowBehindTheEndIsRefused) {
  const Outcome got = replayed({scene_, bag_, "--from", "100"});
  EXPECT_EQ(got.code, 2);
  EXPECT_NE(got.err.find("ends 1.966666647 s after"), std::string::npos) << got.err;
}

}  // namespace
}  // namespace collision_node::test

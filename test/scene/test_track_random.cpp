// Random mishaps against a slow, obvious model of the same rules: the model keeps every accepted stamp and
// works out from scratch what is released.
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "collision_node/scene/tracks/track.h"

namespace collision_node::scene {
namespace {

constexpr Nanoseconds kReorder = 100, kMaxGap = 1000, kJump = 700;  // [ns]; the rules know no scale

class Model {
 public:
  struct Released {
    std::uint32_t epoch;
    Nanoseconds stamp;
    bool joined;
    bool operator==(const Released& o) const {
      return epoch == o.epoch && stamp == o.stamp && joined == o.joined;
    }
  };

  void add(Nanoseconds t) {
    const bool far_held = held_ && reached() - *held_ > kJump;
    if ((held_ && t == *held_) || (!far_held && isKnown(t))) {
      ++duplicate;
      return;
    }
    if (held_) {
      if (t > *held_ && t <= reached()) {
        epochs_.push_back({*held_});
      } else {
        ++late;
      }
      held_.reset();
    }
    if (isKnown(t)) {
      ++duplicate;
    } else if (!epochs_.back().empty() && t < reached() - (lastReleased() ? 0 : kJump)) {
      held_ = t;
    } else {
      epochs_.back().push_back(t);
    }
  }

  void end() {
    if (held_) ++late;
    held_.reset();
    ended_ = true;
  }

  std::vector<Released> released() const {
    std::vector<Released> out;
    for (std::size_t e = 0; e < epochs_.size(); ++e) {
      std::vector<Nanoseconds> sorted = epochs_[e];
      std::sort(sorted.begin(), sorted.end());
      const bool all = ended_ || e + 1 < epochs_.size();
      for (std::size_t i = 0; i < sorted.size(); ++i) {
        if (!all && sorted[i] > sorted.back() - kReorder) break;
        out.push_back(
            {static_cast<std::uint32_t>(e), sorted[i], i > 0 && sorted[i] - sorted[i - 1] <= kMaxGap});
      }
    }
    return out;
  }

  std::uint64_t late = 0, duplicate = 0;

 private:
  /// A stamp that waits for release, or was released at most `jump` ago.
  bool isKnown(Nanoseconds t) const {
    const std::vector<Nanoseconds>& now = epochs_.back();
    return std::count(now.begin(), now.end(), t) != 0 && (!lastReleased() || t >= *lastReleased() - kJump);
  }
  Nanoseconds reached() const { return lastReleased() ? *lastReleased() : newest(); }
  Nanoseconds newest() const { return *std::max_element(epochs_.back().begin(), epochs_.back().end()); }
  std::optional<Nanoseconds> lastReleased() const {
    std::optional<Nanoseconds> last;
    for (const Nanoseconds t : epochs_.back())
      if (t <= newest() - kReorder && (!last || t > *last)) last = t;
    return last;
  }

  std::vector<std::vector<Nanoseconds>> epochs_{1};
  std::optional<Nanoseconds> held_;
  bool ended_ = false;
};

motion::StampedPose at(Nanoseconds stamp) {
  motion::StampedPose pose;
  pose.stamp_ns = stamp;
  return pose;
}

Track makeTrack() {
  TrackOptions options;
  options.reorder_ns = kReorder;
  options.max_gap_ns = kMaxGap;
  options.jump_ns = kJump;
  return Track(options);
}

/// All released samples over all epochs. The scene follows wherever the track has gone.
std::vector<Model::Released> drain(Track& track) {
  std::vector<Model::Released> out;
  for (std::uint32_t epoch = 0;; ++epoch) {
    for (std::size_t i = track.firstIndex(); track.has(i); ++i)
      out.push_back({epoch, track.stamp(i), track.sample(i).join == Join::kJoined});
    if (epoch >= track.epoch()) return out;
    track.beginEpoch(epoch + 1);
  }
}

/// A stream as a bad network and a looping player deliver it.
std::vector<Nanoseconds> mishaps(std::mt19937_64& random) {
  const auto chance = [&](double p) { return std::bernoulli_distribution(p)(random); };
  const auto upTo = [&](Nanoseconds n) { return std::uniform_int_distribution<Nanoseconds>(0, n)(random); };
  std::vector<Nanoseconds> stream;
  Nanoseconds t = upTo(2000);
  for (int i = 0; i < 60; ++i) {
    t += 10 + upTo(60);
    if (chance(0.03)) t += upTo(2500);  // hole
    if (chance(0.03)) t -= upTo(2000);  // loop, short and long
    if (chance(0.05)) continue;         // lost
    stream.push_back(t);
    if (chance(0.05)) stream.push_back(t);              // twice
    if (chance(0.05)) stream.push_back(t - upTo(400));  // straggler
    if (chance(0.02)) stream.push_back(0);              // a header never filled
    if (chance(0.03) && stream.size() > 9) {            // the last ones sent again
      const std::vector<Nanoseconds> again(stream.end() - 3 - upTo(5), stream.end());
      stream.insert(stream.end(), again.begin(), again.end());
    }
    if (chance(0.2) && stream.size() > 1) std::swap(stream[stream.size() - 1], stream[stream.size() - 2]);
  }
  return stream;
}

TEST(TrackAgainstModel, RandomMishaps) {
  const unsigned seed = 7321;
  std::mt19937_64 random(seed);
  std::size_t epochs = 0, late = 0, duplicates = 0;
  for (int round = 0; round < 3000; ++round) {
    SCOPED_TRACE("seed " + std::to_string(seed) + " round " + std::to_string(round));
    Track track = makeTrack();
    Model model;
    const std::vector<Nanoseconds> stream = mishaps(random);
    for (const Nanoseconds t : stream) {
      track.add(at(t), false, {});
      model.add(t);
    }
    if (round % 2 == 0) {
      track.releaseAll();
      model.end();
    }
    const std::uint64_t counted = track.counts().accepted + track.counts().late + track.counts().duplicate;
    EXPECT_LE(stream.size() - counted, round % 2 == 0 ? 0u : 1u);  // one may be held
    EXPECT_EQ(track.counts().late, model.late);
    EXPECT_EQ(track.counts().duplicate, model.duplicate);
    ASSERT_TRUE(drain(track) == model.released());
    epochs += track.epoch();
    late += track.counts().late;
    duplicates += track.counts().duplicate;
  }
  // The streams do what they are for.
  EXPECT_GT(epochs, 1000u);
  EXPECT_GT(late, 1000u);
  EXPECT_GT(duplicates, 1000u);
}

TEST(TrackAgainstModel, OrderWithinTheWindowDoesNotMatter) {
  const unsigned seed = 99;
  std::mt19937_64 random(seed);
  for (int round = 0; round < 500; ++round) {
    SCOPED_TRACE("seed " + std::to_string(seed) + " round " + std::to_string(round));
    // Each pose is delayed by less than the window; delivery is in order of arrival.
    std::vector<std::pair<Nanoseconds, Nanoseconds>> arrivals;
    Nanoseconds t = 0;
    for (int i = 0; i < 80; ++i) {
      t += 1 + static_cast<Nanoseconds>(random() % 60);
      arrivals.push_back({t + static_cast<Nanoseconds>(random() % kReorder), t});
    }
    Track in_order = makeTrack(), delayed = makeTrack();
    for (const auto& arrival : arrivals) in_order.add(at(arrival.second), false, {});
    std::sort(arrivals.begin(), arrivals.end());
    for (const auto& arrival : arrivals) delayed.add(at(arrival.second), false, {});
    in_order.releaseAll();
    delayed.releaseAll();
    EXPECT_EQ(delayed.counts().late, 0u);
    ASSERT_TRUE(drain(in_order) == drain(delayed));
  }
}

}  // namespace
}  // namespace collision_node::scene

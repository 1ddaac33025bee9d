#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "collision_node/scene/tracks/composed_path.h"

namespace collision_node::scene {
namespace {

using motion::StampedPose;
constexpr Nanoseconds kMs = 1'000'000;

StampedPose at(Nanoseconds ms, double x, double yaw = 0.0) {
  StampedPose pose;
  pose.stamp_ns = ms * kMs;
  pose.pose.position.x() = x;
  pose.pose.orientation = geometry::Quat(Eigen::AngleAxisd(yaw, Vec3::UnitZ()));
  return pose;
}

ComposedPath::Part edge(int index, bool inverse = false) { return {index, inverse, {}}; }
ComposedPath::Part shift(double x) { return {-1, false, {Vec3(x, 0, 0), geometry::Quat::Identity()}}; }

struct Path {
  explicit Path(std::vector<ComposedPath::Part> parts, int edges, TimeOptions time = {})
      : path(std::move(parts), edges, time, [this](const StampedPose& pose, bool is_guess) {
          out.push_back(pose);
          guessed.push_back(is_guess);
        }) {}
  void feed(int index, Nanoseconds from, Nanoseconds to, Nanoseconds step, double speed) {
    for (Nanoseconds t = from; t <= to; t += step)
      path.add(index, at(t, speed * 1e-3 * static_cast<double>(t)), false);
  }
  std::vector<Nanoseconds> stamps() const {
    std::vector<Nanoseconds> ms;
    for (const auto& pose : out) ms.push_back(pose.stamp_ns / kMs);
    return ms;
  }
  std::vector<StampedPose> out;
  std::vector<bool> guessed;
  ComposedPath path;
};

using Stamps = std::vector<Nanoseconds>;

TEST(ComposedPath, theKnotsAreTheUnionOfTheEdgesStamps) {
  Path p({edge(0), shift(10), edge(1)}, 2);
  p.feed(0, 0, 300, 100, 1.0);
  p.feed(1, 50, 290, 80, 2.0);
  p.path.flush();
  // From the first instant that both know to the last.
  EXPECT_EQ(p.stamps(), (Stamps{50, 100, 130, 200, 210, 290}));
  for (const auto& pose : p.out) {
    const double s = 1e-9 * static_cast<double>(pose.stamp_ns);
    EXPECT_NEAR(pose.pose.position.x(), s * 1.0 + 10 + s * 2.0, 1e-14);
    EXPECT_LT(pose.model_position, 1e-11);
  }
}

TEST(ComposedPath, aKnotWaitsUntilEveryEdgeIsPastIt) {
  Path p({edge(0), edge(1)}, 2);
  p.feed(0, 0, 500, 10, 1.0);
  EXPECT_TRUE(p.out.empty()) << "nothing of the other edge is known";
  p.feed(1, 0, 200, 50, 1.0);
  // reorder is 100 ms: up to 100 no pose of the second edge can still come between.
  EXPECT_EQ(p.stamps().back(), 100);
  p.feed(1, 250, 250, 50, 1.0);
  EXPECT_EQ(p.stamps().back(), 150);
}

TEST(ComposedPath, theOrderOfArrivalDoesNotMatter) {
  std::mt19937 dice(7);
  std::vector<std::pair<int, StampedPose>> sent;
  for (int i = 0; i <= 60; ++i) sent.emplace_back(0, at(10 * i, std::sin(0.1 * i), 0.05 * i));
  for (int i = 0; i <= 20; ++i) sent.emplace_back(1, at(30 * i + 3, std::cos(0.1 * i), -0.1 * i));
  std::vector<StampedPose> first;
  for (int round = 0; round < 20; ++round) {
    auto order = sent;
    std::stable_sort(order.begin(), order.end(),
                     [](const auto& a, const auto& b) { return a.second.stamp_ns < b.second.stamp_ns; });
    for (std::size_t from = 0; from + 8 <= order.size(); from += 8)
      if (round > 0) std::shuffle(order.begin() + from, order.begin() + from + 8, dice);
    Path p({edge(0), shift(1), edge(1), shift(2)}, 2);
    for (const auto& [index, pose] : order) p.path.add(index, pose, false);
    p.path.flush();
    if (round == 0) first = p.out;
    ASSERT_EQ(p.out.size(), first.size()) << "round " << round;
    for (std::size_t i = 0; i < first.size(); ++i) {
      EXPECT_EQ(p.out[i].stamp_ns, first[i].stamp_ns);
      EXPECT_EQ(p.out[i].pose.position, first[i].pose.position);
      EXPECT_EQ(p.out[i].model_position, first[i].model_position);
    }
  }
  EXPECT_EQ(first.size(), 80u) << "all stamps from 3 to 600 ms";
}

TEST(ComposedPath, aLeverCarriesItsBoundToTheSegmentItEnds) {
  Path p({edge(0), shift(2)}, 1);
  p.path.add(0, at(0, 0, 0.0), false);
  p.path.add(0, at(100, 0, 0.4), false);
  p.path.add(0, at(200, 0, 0.4), false);
  p.path.flush();
  ASSERT_EQ(p.out.size(), 3u);
  EXPECT_EQ(p.out[0].model_position, 0.0);
  EXPECT_NEAR(p.out[1].model_position, 2.0 * 0.4 * 0.4 / 8.0, 2e-3);
  EXPECT_LT(p.out[2].model_position, 1e-12);
}

/// Two edges that turn on: together by more than half a turn between two knots, or against each other.
TEST(ComposedPath, theShortWayRoundIsInDoubtOnlyWhereTheTurnsAddUpToHalfATurn) {
  for (const double second : {1.1, 1.2, -3.0}) {  // half a turn is 3.14 [rad]
    Path p({edge(0), edge(1)}, 2);
    for (const int index : {0, 1}) {
      p.path.add(index, at(0, 0, 0.0), false);
      p.path.add(index, at(100, 0, index == 0 ? 2.0 : second), false);
    }
    p.path.flush();
    ASSERT_EQ(p.out.size(), 2u);
    EXPECT_EQ(p.out[1].may_alias, second == 1.2) << second;
    EXPECT_EQ(p.out[1].model_angle < 3.0, second != 1.2) << second;
  }
}

TEST(ComposedPath, aHoleOfAnEdgeIsAHoleOfThePath) {
  Path p({edge(0), edge(1)}, 2);  // max_gap 1 s
  for (Nanoseconds t = 0; t <= 4000; t += 50) {
    if (t % 100 == 0) p.path.add(0, at(t, 0), false);
    if (t <= 500 || t >= 2050) p.path.add(1, at(t, 0), false);
  }
  p.path.flush();
  Nanoseconds before = 0;
  for (const Nanoseconds ms : p.stamps()) {
    if (ms > 500 && before <= 500) {
      EXPECT_EQ(before, 500);
      EXPECT_EQ(ms, 2050);
    }
    before = ms;
  }
  EXPECT_EQ(before, 4000);
}

TEST(ComposedPath, aSilentEdgeIsNotWaitedForForEver) {
  Path p({edge(0), edge(1)}, 2);
  p.feed(1, 0, 100, 50, 1.0);
  p.feed(0, 0, 5000, 10, 1.0);
  EXPECT_EQ(p.stamps().back(), 100) << "nothing is known of it any more, and nothing is made up";
  p.feed(0, 5010, 6000, 10, 1.0);
  p.feed(1, 6000, 7000, 50, 1.0);
  p.feed(0, 6010, 7000, 10, 1.0);
  p.path.flush();
  EXPECT_EQ(p.stamps().back(), 7000);
  const Stamps all = p.stamps();
  EXPECT_TRUE(std::none_of(all.begin(), all.end(), [](Nanoseconds ms) { return ms > 100 && ms < 6000; }));
}

TEST(ComposedPath, inverseEdgesAreWalkedBackwards) {
  Path p({edge(0, true), edge(1)}, 2);
  p.feed(0, 0, 300, 100, 1.0);
  p.feed(1, 0, 300, 100, 5.0);
  p.path.flush();
  ASSERT_EQ(p.out.size(), 4u);
  EXPECT_NEAR(p.out[3].pose.position.x(), 0.3 * (5.0 - 1.0), 1e-14);
}

TEST(ComposedPath, timeThatGoesBackBeginsAnew) {
  Path p({edge(0), edge(1)}, 2);
  for (int round = 0; round < 2; ++round) {
    for (Nanoseconds t = 0; t <= 5000; t += 50) {
      p.path.add(0, at(t, 1), false);
      p.path.add(1, at(t, 2), false);
    }
  }
  p.path.flush();
  const Stamps all = p.stamps();
  ASSERT_EQ(all.size(), 202u);
  EXPECT_EQ(all[100], 5000);
  EXPECT_EQ(all[101], 0);
  EXPECT_EQ(all[201], 5000);
}

TEST(ComposedPath, theClockGoingBackHandsOutWhatIsThere) {
  Path p({edge(0), edge(1)}, 2);
  p.feed(0, 1000, 1500, 50, 1.0);
  p.feed(1, 1000, 1500, 50, 1.0);
  EXPECT_EQ(p.stamps().back(), 1400);
  p.path.clockWentBack();
  EXPECT_EQ(p.stamps().back(), 1500);
  p.feed(0, 1200, 1900, 50, 1.0);
  p.feed(1, 1200, 1900, 50, 1.0);
  p.path.flush();
  const Stamps all = p.stamps();
  EXPECT_EQ(all[11], 1200);
  EXPECT_EQ(all.back(), 1900);
}

TEST(ComposedPath, aGuessedStampMakesAGuessedPath) {
  Path p({edge(0), edge(1)}, 2);
  p.feed(0, 0, 300, 100, 1.0);
  for (Nanoseconds t = 0; t <= 300; t += 100) p.path.add(1, at(t, 0), true);
  p.path.flush();
  ASSERT_EQ(p.guessed.size(), 4u);
  EXPECT_TRUE(std::all_of(p.guessed.begin(), p.guessed.end(), [](bool g) { return g; }));
}

TEST(ComposedPath, anEdgeWhoseTwistContradictsItMakesThePathDoubtful) {
  Path p({edge(0), edge(1)}, 2);
  for (Nanoseconds t = 0; t <= 300; t += 100) {
    StampedPose spinning = at(t, 0);
    spinning.has_twist = true;
    spinning.angular = Vec3(0, 0, 100);
    p.path.add(0, spinning, false);
    p.path.add(1, at(t, 0), false);
  }
  p.path.flush();
  ASSERT_EQ(p.out.size(), 4u);
  EXPECT_TRUE(p.out[1].may_alias);
}

TEST(ComposedPath, memoryIsLetGo) {
  Path p({edge(0), edge(1)}, 2);
  p.feed(0, 0, 200'000, 1, 1.0);  // the other edge never comes: only what a late one could need stays
  p.feed(1, 200'000, 201'000, 10, 1.0);
  p.feed(0, 200'001, 201'000, 1, 1.0);
  p.path.flush();
  EXPECT_EQ(p.stamps().front(), 200'000);
}

}  // namespace
}  // namespace collision_node::scene

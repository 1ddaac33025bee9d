// The broad phase against all pairs, by closed forms.
#include <gtest/gtest.h>

#include <random>
#include <set>

#include "collision_node/scene/block_question.h"
#include "collision_node/scene/broad_phase.h"

namespace collision_node::scene {
namespace {

class BroadPhaseTest : public testing::Test {
 protected:
  double real(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  Vec3 vector(double size) { return {real(-size, size), real(-size, size), real(-size, size)}; }
  static Sweep sweep(const Vec3& from, const Vec3& to, double radius) {
    return {from, to, radius, grown({from.cwiseMin(to), from.cwiseMax(to)}, radius)};
  }

  std::mt19937_64 random_{17};
};

/// The least distance of two points that go on straight lines in the same time.
double nearest(const Vec3& d, const Vec3& v) {
  const double vv = v.squaredNorm();
  const double t = vv > 0.0 ? std::clamp(-d.dot(v) / vv, 0.0, 1.0) : 0.0;
  return (d + t * v).norm();
}

TEST_F(BroadPhaseTest, NamesEveryTwoThatComeNearAndForgetsTheRest) {
  constexpr int kMoving = 150, kStanding = 50, kSteps = 60;
  BroadPhase broad(kMoving + kStanding);
  std::vector<Vec3> at(kMoving);
  std::vector<double> radius(kMoving);
  std::vector<int> standing;
  std::vector<Bounds> boxes;
  for (int i = 0; i < kMoving; ++i) {
    at[i] = vector(30.0);
    radius[i] = std::exp(real(-4.0, 1.0));
  }
  for (int i = 0; i < kStanding; ++i) {
    standing.push_back(kMoving + i);
    const Vec3 centre = vector(30.0);
    boxes.push_back(grown({centre, centre}, real(0.1, 3.0)));
  }
  broad.stand(standing, boxes);
  broad.startEpoch();
  std::set<std::pair<int, int>> named;
  std::size_t near = 0, most = 0;
  const auto name = [&](int i, const std::vector<int>& others) {
    for (const int other : others) named.insert(std::minmax(i, other));
  };
  for (int i = 0; i < kMoving; ++i) name(i, broad.move(i, sweep(at[i], at[i], radius[i]), 0, 0, true));
  for (int step = 0; step < kSteps; ++step) {
    std::vector<Vec3> way(kMoving);
    for (int i = 0; i < kMoving; ++i) {
      way[i] = i % 10 == 0 ? vector(20.0) : i % 3 == 0 ? Vec3::Zero() : vector(0.2);
      if (at[i].norm() > 30.0) way[i] = -0.5 * at[i];
      name(i, broad.move(i, sweep(at[i], at[i] + way[i], radius[i]), step, step + 1, false));
    }
    for (int i = 0; i < kMoving; ++i) {
      for (int k = 0; k < i; ++k) {
        if (nearest(at[i] - at[k], way[i] - way[k]) > radius[i] + radius[k]) continue;
        ++near;
        ASSERT_EQ(named.count({k, i}), 1u) << k << " x " << i << " in step " << step;
        ASSERT_TRUE(broad.mayMeet(k, i));
      }
      for (int k = 0; k < kStanding; ++k) {
        for (int part = 0; part <= 100; ++part) {
          const Vec3 point = at[i] + way[i] * (0.01 * part);
          if (!meet(boxes[k], {point, point})) continue;
          ASSERT_EQ(named.count({i, kMoving + k}), 1u);
          ASSERT_TRUE(broad.mayMeet(kMoving + k, i));
        }
      }
    }
    for (int i = 0; i < kMoving; ++i) at[i] += way[i];
    broad.forgetBefore(step + 1);
    most = std::max(most, named.size());
    for (auto pair = named.begin(); pair != named.end();)
      pair = broad.mayMeet(pair->first, pair->second) ? std::next(pair) : named.erase(pair);
  }
  EXPECT_GT(near, 500u);
  EXPECT_LT(most, 5000u);  // of 19 900
}

TEST_F(BroadPhaseTest, AnObjectBehindInTimeMeetsWhatWasThereThen) {
  BroadPhase broad(2);
  broad.startEpoch();
  // One flies through x = 5 between 10 and 20 ns and is told of up to 30 ns; the other comes there at 15 ns.
  broad.move(0, sweep({0, 0, 0}, {0, 0, 0}, 0.1), 0, 0, true);
  broad.move(0, sweep({0, 0, 0}, {0, 0, 0}, 0.1), 0, 10, false);
  broad.move(0, sweep({0, 0, 0}, {10, 0, 0}, 0.1), 10, 20, false);
  broad.move(0, sweep({10, 0, 0}, {90, 0, 0}, 0.1), 20, 30, false);
  EXPECT_TRUE(broad.move(1, sweep({5, 9, 0}, {5, 9, 0}, 0.1), 5, 5, true).empty());
  EXPECT_EQ(broad.move(1, sweep({5, 9, 0}, {5, 0, 0}, 0.1), 5, 15, false), std::vector<int>{0});
  broad.forgetBefore(20);
  EXPECT_TRUE(broad.move(1, sweep({5, 0, 0}, {5, 1, 0}, 0.1), 20, 25, false).empty());
}

TEST_F(BroadPhaseTest, BoxesInATreeAreFoundAsInAList) {
  BoxTree tree;
  std::vector<std::pair<std::int32_t, Bounds>> list;
  for (int round = 0; round < 3000; ++round) {
    if (list.size() < 20 || real(0.0, 1.0) < 0.55) {
      // Also all in a row, which would be a list in a tree without rotations.
      const Vec3 at = round < 1000 ? Vec3(round, 0, 0) : vector(300.0);
      const Bounds box = grown({at, at}, std::exp(real(-2.0, 4.0)));
      list.push_back({tree.insert(box, round), box});
    } else {
      const std::size_t i = random_() % list.size();
      tree.remove(list[i].first);
      list.erase(list.begin() + static_cast<std::ptrdiff_t>(i));
    }
    if (round % 10 != 0) continue;
    const Vec3 at = vector(300.0);
    const BoxQuestion question{grown({at, at}, real(0.1, 50.0))};
    std::set<std::int32_t> found, expected;
    tree.visit(question, [&](std::int32_t leaf) { found.insert(leaf); });
    for (const auto& [leaf, box] : list)
      if (question.meets(box)) expected.insert(leaf);
    ASSERT_EQ(found, expected);
  }
  EXPECT_EQ(tree.size(), list.size());
}

TEST_F(BroadPhaseTest, ALineMeetsEveryBoxThatAPointOfItIsNear) {
  std::size_t hits = 0, passed_over = 0;
  for (int round = 0; round < 2000; ++round) {
    const double scale = std::exp(real(-8.0, 12.0));
    const Vec3 offset = round % 2 ? vector(1e6 * scale) : Vec3::Zero();
    Vec3 way = vector(10.0 * scale);
    if (round % 3 == 0) way.y() = 0.0;
    if (round % 5 == 0) way.x() = way.z() = 0.0;
    const Vec3 from = offset + vector(scale);
    const double radius = scale * (0.3 + 1e-5);
    const Sweep line = sweep(from, from + way, radius);
    std::vector<Bounds> boxes;
    for (int i = 0; i < 16; ++i) {
      const Vec3 at = offset + vector(10.0 * scale);
      boxes.push_back(grown({at, at}, scale * real(0.0, 2.0)));
    }
    BroadPhase broad(17);
    std::vector<int> standing;
    for (int i = 0; i < 16; ++i) standing.push_back(i);
    broad.stand(standing, boxes);
    broad.startEpoch();
    const std::vector<int> found = broad.move(16, line, 0, 1, true);
    for (int i = 0; i < 16; ++i) {
      bool is_near = false;
      for (int part = 0; part <= 64 && !is_near; ++part) {
        const Vec3 point = from + way * (part / 64.0);
        is_near = distanceBetween(boxes[i], {point, point}) < 0.3 * scale;
      }
      const bool is_found = std::find(found.begin(), found.end(), i) != found.end();
      if (is_near) {
        ++hits;
        ASSERT_TRUE(is_found) << round << ' ' << i;
      } else if (!is_found) {
        ++passed_over;
      }
    }
  }
  EXPECT_GT(hits, 300u);
  EXPECT_GT(passed_over, 10000u);
}

}  // namespace
}  // namespace collision_node::scene

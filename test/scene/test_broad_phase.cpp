// The broad phase against all pairs, by closed forms.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <set>

#include "collision_node/scene/broad_phase/broad_phase.h"

namespace collision_node::scene {
namespace {

class BroadPhaseTest : public testing::Test {
 protected:
  double real(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  Vec3 vector(double size) { return {real(-size, size), real(-size, size), real(-size, size)}; }
  static Sweep sweep(const Vec3& from, const Vec3& to, double radius) { return {from, to, radius}; }

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

/// What one object was told of: straight ways, each within `radius`, and places that it stands at from then
/// on.
struct Told {
  Vec3 from, to;
  double radius;
  Nanoseconds from_ns, to_ns;
};

/// The least distance of the two while both last; infinite when they share no time behind `settled_ns`.
double nearest(const Told& a, const Told& b, Nanoseconds settled_ns) {
  const Nanoseconds from = std::max({a.from_ns, b.from_ns, settled_ns}), to = std::min(a.to_ns, b.to_ns);
  if (from > to || to <= settled_ns) return std::numeric_limits<double>::infinity();
  const auto at = [](const Told& t, Nanoseconds ns) -> Vec3 {
    if (t.from_ns == t.to_ns || t.from == t.to) return t.to;
    return t.from +
           (t.to - t.from) * (static_cast<double>(ns - t.from_ns) / static_cast<double>(t.to_ns - t.from_ns));
  };
  const Vec3 first = at(a, from) - at(b, from), last = at(a, to) - at(b, to);
  return nearest(first, last - first);
}

TEST_F(BroadPhaseTest, TracksWithStampsOfTheirOwnMissNobodyWhoWasNear) {
  constexpr int kObjects = 60, kRounds = 12000;
  constexpr Nanoseconds kForEver = std::numeric_limits<Nanoseconds>::max();
  const Vec3 offset(4.1e5, -5.4e6, 310.0);  // a map's coordinates
  BroadPhase broad(kObjects);
  broad.startEpoch();
  std::vector<std::vector<Told>> told(kObjects);
  std::vector<Vec3> at(kObjects);
  std::vector<double> radius(kObjects);
  std::set<std::pair<int, int>> named;
  std::size_t near = 0, apart = 0;
  Nanoseconds watermark = -1;
  for (int i = 0; i < kObjects; ++i) {
    at[i] = offset + vector(8.0);
    radius[i] = std::exp(real(-5.0, 1.0));
  }
  // Whoever is farthest behind goes on, but now and then another does; nobody is told of the past.
  for (int round = 0; round < kRounds; ++round) {
    const auto known = [&](int i) {
      if (told[i].empty()) return Nanoseconds{0};
      const Told& last = told[i].back();
      return last.to_ns == kForEver ? last.from_ns : last.to_ns;
    };
    int i = 0;
    for (int k = 1; k < kObjects; ++k)
      if (known(k) < known(i)) i = k;
    if (real(0.0, 1.0) < 0.5) i = static_cast<int>(random_() % kObjects);
    const Nanoseconds from = known(i),
                      to = from + 1 + static_cast<Nanoseconds>(random_() % (i % 3 == 0 ? 1000 : 50));
    const double kind = real(0.0, 1.0);
    std::vector<int> others;
    if (!told[i].empty() && told[i].back().to_ns == kForEver) told[i].back().to_ns = from;
    if (told[i].empty() || kind < 0.03) {  // from out of nowhere, at `to`
      at[i] = offset + vector(8.0);
      told[i].push_back({at[i], at[i], radius[i], to, to});
      others = broad.move(i, sweep(at[i], at[i], radius[i]), to, to, true);
    } else if (kind < 0.06) {  // frozen
      told[i].push_back({at[i], at[i], radius[i], from, kForEver});
      others = broad.stay(i, grown({at[i], at[i]}, radius[i]), from);
      ASSERT_TRUE(broad.isStaying(i));
    } else {
      Vec3 next = at[i] + (i % 5 == 0 ? vector(15.0) : i % 5 == 1 ? Vec3::Zero() : vector(0.3 * radius[i]));
      if ((next - offset).norm() > 10.0) next = 0.5 * (next + offset);
      told[i].push_back({at[i], next, radius[i], from, to});
      others = broad.move(i, sweep(at[i], next, radius[i]), from, to, false);
      at[i] = next;
    }
    for (const int other : others) named.insert(std::minmax(i, other));
    for (int k = 0; k < kObjects; ++k) {
      if (k == i) continue;
      double distance = std::numeric_limits<double>::infinity();
      for (const Told& other : told[k])
        distance = std::min(distance, nearest(told[i].back(), other, watermark));
      if (distance <= radius[i] + radius[k]) {
        ++near;
        ASSERT_EQ(named.count(std::minmax(i, k)), 1u) << i << " x " << k << " in round " << round;
        ASSERT_TRUE(broad.mayMeet(i, k));
      } else if (named.count(std::minmax(i, k)) == 0) {
        ++apart;
      }
    }
    if (round % 20 != 0) continue;
    watermark = kForEver;
    for (int k = 0; k < kObjects; ++k) watermark = std::min(watermark, known(k));
    broad.forgetBefore(watermark);
    for (std::vector<Told>& list : told)
      while (list.size() > 1 && list.front().to_ns <= watermark) list.erase(list.begin());
    for (auto pair = named.begin(); pair != named.end();)
      pair = broad.mayMeet(pair->first, pair->second) ? std::next(pair) : named.erase(pair);
  }
  EXPECT_GT(near, 5000u);
  EXPECT_GT(apart, 100000u);
}

TEST_F(BroadPhaseTest, BoxesInATreeAreFoundAsInAList) {
  BoxTree tree;
  BoxWalk walk;
  std::map<std::int32_t, FloatBox> list;
  std::vector<std::int32_t> free;
  for (int round = 0; round < 6000; ++round) {
    const bool grows = round / 1500 % 2 == 0;
    if (list.size() < 20 || real(0.0, 1.0) < (grows ? 0.8 : 0.2)) {
      // Also all in a row, many at one place, and out of a float's reach.
      const double kind = real(0.0, 1.0);
      const Vec3 at = round < 1000 ? Vec3(round, 0, 0)
                      : kind < 0.1 ? Vec3(7, 7, 7)
                                   : vector(kind < 0.11 ? 1e300 : 300.0);
      std::int32_t item = static_cast<std::int32_t>(list.size() + free.size());
      if (!free.empty()) {
        item = free.back();
        free.pop_back();
      }
      list[item] = imageOf(grown({at, at}, std::exp(real(-2.0, 4.0))), Vec3::Zero());
      if (random_() % 2 == 0) {
        tree.insert(list[item], item);
      } else {
        tree.find(list[item], walk);
        tree.insert(list[item], item, walk);
      }
    } else {
      const auto at = std::next(list.begin(), static_cast<std::ptrdiff_t>(random_() % list.size()));
      tree.remove(at->first);
      free.push_back(at->first);
      list.erase(at);
    }
    ASSERT_EQ(tree.size(), list.size());
    if (round % 10 != 0) continue;
    const Vec3 at = vector(300.0);
    const FloatBox question = imageOf(grown({at, at}, real(0.1, 50.0)), Vec3::Zero());
    std::set<std::int32_t> expected;
    for (const auto& [item, box] : list)
      if (question.meets(box)) expected.insert(item);
    for (const impact::Lanes lanes : {impact::Lanes::kBaseline, impact::fastestLanes()}) {
      tree.find(question, walk, lanes);
      ASSERT_EQ(std::set<std::int32_t>(walk.items(), walk.items() + walk.count()), expected);
      ASSERT_EQ(walk.count(), expected.size());
    }
    const FloatLine line(sweep(at, at + vector(300.0), real(0.1, 10.0)), Vec3::Zero());
    tree.find(line, walk);
    const std::vector<std::int32_t> items(walk.items(), walk.items() + walk.count());
    tree.find(line, walk, impact::Lanes::kBaseline);
    ASSERT_EQ(std::vector<std::int32_t>(walk.items(), walk.items() + walk.count()), items);
  }
}

TEST_F(BroadPhaseTest, BoxesThatOnlyTouchMeetWhereverTheyAreSeenFrom) {
  // Whole multiples of a step that floats do not have: touching is exact in doubles.
  const auto place = [&] { return std::ldexp(static_cast<double>(random_() % (1U << 30)), -20); };
  int not_floats = 0;
  for (int round = 0; round < 5000; ++round) {
    const double wall = place(), reach = place() + 1.0;
    const int axis = round % 3;
    Bounds a{Vec3::Constant(-reach), Vec3::Constant(reach)}, b = a;
    a.upper[axis] = b.lower[axis] = wall;
    a.lower[axis] = wall - reach;
    b.upper[axis] = wall + reach;
    not_floats += static_cast<double>(static_cast<float>(wall)) != wall ? 1 : 0;
    const Vec3 origin = round % 2 ? vector(1e3) : Vec3::Zero();
    ASSERT_TRUE(imageOf(a, origin).meets(imageOf(b, origin)));
    ASSERT_TRUE(imageOf(b, origin).meets(imageOf(a, origin)));
    ASSERT_TRUE(holdsImage(imageOf(a, origin), a, origin));
    Bounds beyond = a;
    beyond.upper[axis] = wall + reach * 0x1p-20;
    ASSERT_EQ(holdsImage(imageOf(a, origin), beyond, origin),
              imageOf(a, origin).holds(imageOf(beyond, origin)));
    BoxTree tree;
    BoxWalk walk;
    tree.insert(imageOf(a, origin), 0);
    tree.find(imageOf(b, origin), walk);
    ASSERT_EQ(walk.count(), 1u);
    // A line along the wall, as far from it as it is thick.
    const double radius = std::ldexp(static_cast<double>(1 + random_() % 1000), -10);
    Vec3 from = Vec3::Constant(-0.5 * reach), to = Vec3::Constant(0.5 * reach);
    from[axis] = to[axis] = wall + radius;
    const double spare = std::ldexp(wall + reach + radius, -44);
    for (const impact::Lanes lanes : {impact::Lanes::kBaseline, impact::fastestLanes()}) {
      tree.find(FloatLine(sweep(from, to, radius + spare), origin), walk, lanes);
      ASSERT_EQ(walk.count(), 1u) << round;
    }
  }
  EXPECT_GT(not_floats, 1000);
}

TEST_F(BroadPhaseTest, WhatEndsIsHandedOutOnceAndInTime) {
  Endings endings;
  std::map<std::int32_t, Nanoseconds> waiting;
  Nanoseconds now = std::numeric_limits<Nanoseconds>::min();
  std::int32_t name = 0;
  for (int round = 0; round < 3000; ++round) {
    for (int i = static_cast<int>(random_() % 5); i > 0; --i) {
      const Nanoseconds far = Nanoseconds{1} << (random_() % 40);
      const Nanoseconds ns =
          round < 10 ? std::numeric_limits<Nanoseconds>::min()
                     : now + static_cast<Nanoseconds>(random_() % static_cast<std::uint64_t>(far));
      endings.add(ns, name);
      waiting[name++] = ns;
    }
    if (round == 10) now = -1000000;
    if (round > 10) now += static_cast<Nanoseconds>(random_() % (random_() % 3 == 0 ? 1U << 30 : 16U));
    std::set<std::int32_t> over, expected;
    endings.advance(now, [&](std::int32_t item) { EXPECT_TRUE(over.insert(item).second); });
    for (auto at = waiting.begin(); at != waiting.end();) {
      if (at->second > now) {
        ++at;
        continue;
      }
      expected.insert(at->first);
      at = waiting.erase(at);
    }
    ASSERT_EQ(over, expected) << round;
  }
  EXPECT_FALSE(waiting.empty());
}

// Ways whose inverse is no float any more; and nobody is named but who is there.
TEST_F(BroadPhaseTest, WaysOfAnyLengthAlongAnAxisMissNobody) {
  for (const double scale : {1.0, 1e25, 1e32, 1e200}) {
    for (const double across : {0.0, 5e-324, 1e-300, 1e-31, 1e-29, scale}) {
      for (const double sign : {-1.0, 1.0}) {
        const Vec3 to = sign * Vec3(10.0 * scale, across, across), at(0.0, 0.05 * sign, 0.05);
        BroadPhase broad(2);
        broad.stand({0}, {Bounds{at, at}});
        broad.startEpoch();
        const std::vector<int> found = broad.move(1, {-to, to, 0.1 * scale}, 0, 1, true);
        EXPECT_EQ(found, std::vector<int>{0}) << scale << ' ' << across * sign;
      }
    }
  }
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

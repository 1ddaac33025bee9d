/// The order in which a walk looks at what it has (impact/walk/agenda.h): nothing is lost or comes twice,
/// what begins sooner comes first, but for what begins at nearly the same time, and memory is bounded.
#include <gtest/gtest.h>

#include <vector>

#include "collision_node/impact/walk/agenda.h"
#include "test/impact/fuzz_shapes.h"

namespace collision_node::impact {
namespace {

constexpr double kFrom = 0.25, kTo = 0.75;
constexpr double kNearly = (kTo - kFrom) / 2000.0;

Agenda::Item item(std::int32_t number, double low) { return {{number, -number}, 7, -1, {low, kTo}}; }

TEST(Agenda, EachItemComesOnceAndTheNearestFirst) {
  constexpr std::size_t kItems = 3000;
  Agenda agenda;
  for (int round = 0; round < 3; ++round) {
    fuzz::Random random(11, round);
    agenda.start(kFrom, kTo, true);
    std::vector<double> waiting;  // low ends by number; < 0 once it came
    const auto pushOne = [&] {
      const double low = random.chance(0.1) ? (random.chance(0.5) ? kFrom : kTo) : random.in(kFrom, kTo);
      agenda.push(item(static_cast<std::int32_t>(waiting.size()), low));
      waiting.push_back(low);
    };
    const auto popOne = [&] {
      const std::int32_t top = agenda.top().node[0];
      const Agenda::Item next = agenda.pop();
      ASSERT_EQ(next.node[0], top);
      ASSERT_EQ(next.node[1], -next.node[0]);
      ASSERT_EQ(next.slab, 7);
      double& low = waiting[static_cast<std::size_t>(next.node[0])];
      ASSERT_EQ(next.span.low, low) << "came twice, or as another";
      for (const double other : waiting) {
        const bool sooner = other >= 0.0 && other + kNearly < low;
        ASSERT_FALSE(sooner) << low << " before " << other;
      }
      low = -1.0;
    };
    while (waiting.size() < kItems) {
      if (agenda.empty() || random.chance(0.6)) {
        pushOne();
      } else {
        popOne();
      }
      if (HasFatalFailure()) return;
    }
    while (!agenda.empty()) {
      popOne();
      if (HasFatalFailure()) return;
    }
    for (const double low : waiting) ASSERT_LT(low, 0.0) << "lost";
  }
}

TEST(Agenda, TheNewestComesFirstWhereTimeDoesNotCountOrIsAnInstant) {
  Agenda agenda;
  for (const bool instant : {false, true}) {
    agenda.start(kFrom, instant ? kFrom : kTo, instant);
    for (std::int32_t i = 0; i < 100; ++i) agenda.push(item(i, instant ? kFrom : kFrom + 1e-3 * i));
    for (std::int32_t i = 100; i-- > 0;) ASSERT_EQ(agenda.pop().node[0], i);
    EXPECT_TRUE(agenda.empty());
  }
}

/// Of a walk that splits each item for ever, the late ones first: the newest is the next once there are many,
/// so that those below it are done before another is begun.
TEST(Agenda, ManyThatWaitAreNotJoinedByMoreThanTheDepth) {
  constexpr std::int32_t kMany = 4096;
  Agenda agenda;
  agenda.start(kFrom, kTo, true);
  for (std::int32_t i = 0; i < kMany; ++i) agenda.push(item(i, kFrom));
  for (std::int32_t i = kMany; i < 2 * kMany; ++i) {
    agenda.push(item(i, kTo));
    ASSERT_EQ(agenda.top().node[0], i);
  }
  for (std::int32_t i = 2 * kMany; i-- > 0;) ASSERT_EQ(agenda.pop().node[0], i);
}

}  // namespace
}  // namespace collision_node::impact

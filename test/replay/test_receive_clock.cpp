#include <gtest/gtest.h>

#include "collision_node/replay/receive_clock.h"

namespace collision_node::replay {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

TEST(ReceiveClock, keepsTheDistanceAndIgnoresDelay) {
  ReceiveClock clock(kSecond);
  EXPECT_EQ(clock.at(0, 7), 7);
  clock.poseSeen(1000 * kSecond, 10 * kSecond);
  clock.poseSeen(1001 * kSecond + 300, 11 * kSecond);
  EXPECT_EQ(clock.at(0, 12 * kSecond), 1002 * kSecond);
}

TEST(ReceiveClock, eventsOfTheOldEpochStayInTheOldTime) {
  ReceiveClock clock(kSecond);
  clock.poseSeen(1000 * kSecond, 10 * kSecond);
  clock.poseSeen(1020 * kSecond, 30 * kSecond);
  clock.poseSeen(1021 * kSecond, 10 * kSecond);
  clock.poseSeen(1022 * kSecond, 11 * kSecond);
  clock.poseSeen(1022 * kSecond, 32 * kSecond);  // another track, still in the old epoch
  EXPECT_EQ(clock.at(0, 29 * kSecond), 1019 * kSecond);
  EXPECT_EQ(clock.at(1, 10 * kSecond), 1021 * kSecond);
  EXPECT_EQ(clock.at(2, 10 * kSecond), 1021 * kSecond) << "an epoch in which stamps did not jump";
}

TEST(ReceiveClock, oneBadStampIsNoNewTime) {
  ReceiveClock clock(kSecond);
  clock.poseSeen(1000 * kSecond, 10 * kSecond);
  clock.poseSeen(1001 * kSecond, 0);
  clock.poseSeen(1002 * kSecond, 12 * kSecond);
  EXPECT_EQ(clock.at(1, 12 * kSecond), 1002 * kSecond);
}

TEST(ReceiveClock, stampsThatJumpAheadGoOnInTheSameEpoch) {
  ReceiveClock clock(kSecond);
  clock.poseSeen(1000 * kSecond, 10 * kSecond);
  clock.poseSeen(1001 * kSecond, 111 * kSecond);
  clock.poseSeen(1002 * kSecond, 112 * kSecond);
  EXPECT_EQ(clock.at(0, 10 * kSecond), 1000 * kSecond);
  EXPECT_EQ(clock.at(0, 111 * kSecond), 1001 * kSecond);
}

}  // namespace
}  // namespace collision_node::replay

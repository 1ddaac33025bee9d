#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "collision_node/motion/seconds_from.h"

namespace collision_node::motion {
namespace {

TEST(SecondsFrom, IsNeverOnTheOtherSideOfTheExactSum) {
  std::mt19937_64 engine(20261127);
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 100000; ++i) {
    const auto shift = static_cast<Nanoseconds>(engine() >> (3 + i % 60)) * (i % 2 == 0 ? 1 : -1);
    const double seconds = std::ldexp(static_cast<double>(engine() >> 11), -53 - i % 40);
    const long double exact = static_cast<long double>(shift) / 1e9L + seconds;
    const long double off = std::abs(static_cast<long double>(shift)) * 1e-9L * 0x1p-60L;  // of this truth
    EXPECT_GE(secondsFrom(7, 7 + shift, seconds, kInfinity), exact - off) << shift << ' ' << seconds;
    EXPECT_LE(secondsFrom(7, 7 + shift, seconds, -kInfinity), exact + off) << shift << ' ' << seconds;
  }
  EXPECT_EQ(secondsFrom(7, 7, 0.1, kInfinity), 0.1);
}

}  // namespace
}  // namespace collision_node::motion

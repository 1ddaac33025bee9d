#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

#include "collision_node/scene/instant.h"

namespace collision_node::scene {
namespace {

/// start + seconds in units of 2^-70 ns, exactly; `seconds` must be a multiple of 2^-70 below 2^-10.
__int128 exact(Nanoseconds start_from_base, double seconds) {
  const auto scaled = static_cast<__int128>(std::ldexp(seconds, 70));
  return (static_cast<__int128>(start_from_base) << 70) + scaled * 1'000'000'000;
}

TEST(Instant, OrdersExactly) {
  const unsigned seed = 1789;
  std::mt19937_64 random(seed);
  const Nanoseconds base = 1'700'000'000'000'000'000;
  int close = 0;
  for (int i = 0; i < 200000; ++i) {
    SCOPED_TRACE("seed " + std::to_string(seed) + " case " + std::to_string(i));
    const auto draw = [&] { return static_cast<Nanoseconds>(random() % 1000); };
    const Nanoseconds s1 = draw();
    Nanoseconds s2 = draw();
    // 53 random bits below 2^-10, and a second time that is almost the same instant from another start
    const double t1 = std::ldexp(static_cast<double>(random() >> 11), -63) * 0.5;
    double t2 = t1 + static_cast<double>(s1 - s2) * 1e-9;
    if (i % 3 == 0) t2 = std::nextafter(t2, 1.0);
    if (i % 5 == 0) s2 = s1, t2 = t1;
    if (t2 < 0.0 || t2 > 9e-4 || t1 > 9e-4) continue;
    t2 = std::ldexp(std::floor(std::ldexp(t2, 70)), -70);
    const Instant i1 = instantAt(base + s1, t1), i2 = instantAt(base + s2, t2);
    const __int128 e1 = exact(s1, std::ldexp(std::floor(std::ldexp(t1, 70)), -70)), e2 = exact(s2, t2);
    ASSERT_EQ(t1, std::ldexp(std::floor(std::ldexp(t1, 70)), -70));
    ASSERT_EQ(i1 < i2, e1 < e2);
    ASSERT_EQ(i2 < i1, e2 < e1);
    ASSERT_EQ(i1 == i2, e1 == e2);
    ASSERT_EQ(i1.ns - base, static_cast<Nanoseconds>(e1 >> 70));  // rounded down
    ++close;
  }
  EXPECT_GT(close, 50000);
}

TEST(Instant, RoundsDownAlsoWhereTheProductRoundsUp) {
  const double just_below = std::nextafter(1e-9, 0.0);  // times 1e9 rounds to 1.0
  EXPECT_EQ(instantAt(10, just_below).ns, 10);
  EXPECT_TRUE(instantAt(10, just_below) < instantAt(11));
  EXPECT_TRUE(instantAt(10, 0.0) == instantAt(10));
  EXPECT_EQ(instantAt(10, -0.5e-9).ns, 9);
}

TEST(Instant, WholeNanosecondsFromSeconds) {
  EXPECT_EQ(toNanoseconds(0.1), 100'000'000);
  EXPECT_EQ(toNanoseconds(1.0 / 3.0), 333'333'333);
  EXPECT_GT(toNanoseconds(std::numeric_limits<double>::infinity()), 3'000'000'000'000'000'000);
}

}  // namespace
}  // namespace collision_node::scene

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <string>

#include "collision_node/scene/tracks/instant.h"

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

/// The number m < 2^54 for which 1e9 * m * 2^-63 has the fraction `part` * 2^-54. It is a double when below
/// 2^53.
std::uint64_t numeratorFor(std::uint64_t part) {
  constexpr std::uint64_t kFive9 = 1953125, kMask = (1ull << 54) - 1;
  std::uint64_t inverse = kFive9;  // Newton: each step doubles the good bits
  for (int i = 0; i < 6; ++i) inverse *= 2 - kFive9 * inverse;
  return (inverse * part) & kMask;
}

double toSeconds(std::uint64_t numerator) { return std::ldexp(static_cast<double>(numerator), -63); }

TEST(Instant, SeesTheSmallestStepFromAWholeNanosecond) {
  constexpr std::uint64_t kWrap = 1ull << 54;
  int seen = 0;
  for (std::uint64_t part = 1; part < 64; part += 2) {
    for (const bool below : {false, true}) {
      const std::uint64_t numerator = numeratorFor(below ? kWrap - part : part);
      if (numerator >= kWrap / 2) continue;
      const double t = toSeconds(numerator);
      const Nanoseconds nearest = std::llround(t * 1e9);
      EXPECT_EQ(instantAt(0, t).ns, below ? nearest - 1 : nearest);  // though t * 1e9 rounds to `nearest`
      EXPECT_EQ(instantAt(0, t) < instantAt(nearest), below);
      EXPECT_EQ(instantAt(nearest) < instantAt(0, t), !below);
      ++seen;
    }
  }
  EXPECT_GT(seen, 10);
}

TEST(Instant, SeesWhatOneDoubleOfNanosecondsCannotHold) {
  // Times with the fractions f and f + 2^-54 ns, f >= 1/2: one double cannot tell them apart.
  constexpr std::uint64_t kHalf = 1ull << 53;
  int seen = 0;
  for (std::uint64_t step = 0; step < 256; step += 2) {
    const std::uint64_t low = numeratorFor(kHalf + step), high = numeratorFor(kHalf + step + 1);
    if (high >= kHalf || (low >= kHalf && low % 2 != 0)) continue;
    const Instant a = instantAt(0, toSeconds(low)), b = instantAt(0, toSeconds(high));
    const Instant same_ns{b.ns, a.part, a.rest};
    EXPECT_TRUE(same_ns < b);
    EXPECT_FALSE(same_ns == b);
    ++seen;
  }
  EXPECT_GT(seen, 10);
}

TEST(Instant, CountsFromItsStart) {
  EXPECT_TRUE(instantAt(10, 0.0) == instantAt(10));
  EXPECT_EQ(instantAt(10, -0.5e-9).ns, 9);
  EXPECT_TRUE(instantAt(0, std::ldexp(1.0, -9)) == instantAt(1953125));  // 2^-9 s is whole in both
}

TEST(Instant, WholeNanosecondsFromSeconds) {
  EXPECT_EQ(toNanoseconds(0.1), 100'000'000);
  EXPECT_EQ(toNanoseconds(1.0 / 3.0), 333'333'333);
  EXPECT_GT(toNanoseconds(std::numeric_limits<double>::infinity()), 3'000'000'000'000'000'000);
}

}  // namespace
}  // namespace collision_node::scene

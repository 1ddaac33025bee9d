/// Two sines at once, against those of 80 bits.
#include <gtest/gtest.h>

#include <cstdio>
#include <random>

#include "collision_node/geometry/two_sines.h"

namespace collision_node::geometry {
namespace {

using Real = long double;

constexpr double kUnit = 0x1p-53;

/// How far they are off [u], at most.
double worstOf(double x, double y) {
  const TwoSines found = sinesOf(Two{x, y});
  Real worst = 0;
  for (int lane = 0; lane < 2; ++lane) {
    const Real angle = lane == 0 ? x : y;
    worst = std::max({worst, std::abs(found.sine[lane] - std::sin(angle)),
                      std::abs(found.cosine[lane] - std::cos(angle))});
  }
  return static_cast<double>(worst / kUnit);
}

TEST(TwoSines, AreWithinTwoRoundingsOfTheExactOnes) {
  // "each is within 2 u of the exact value, u = 2^-53"
  std::mt19937_64 bits(20261127);
  std::uniform_real_distribution<double> share(-1.0, 1.0), power(-60.0, 20.0);
  double worst = 0.0;
  for (int i = 0; i < 1000000; ++i) {
    const double x = share(bits) * std::exp2(power(bits)), y = 4.0 * share(bits);
    worst = std::max(worst, worstOf(x, y));
  }
  for (int i = 0; i < 1000000; ++i) {  // where a quarter ends or the middle of one is
    const auto eighths = static_cast<double>(static_cast<int>(bits() >> 43) - (1 << 20));
    const double x = 0.78539816339744831 * eighths * (1.0 + 4.0 * kUnit * share(bits));
    if (std::abs(x) < 0x1p20) worst = std::max(worst, worstOf(x, std::nextafter(x, 0.0)));
  }
  std::printf("off by %.3f u at most\n", worst);
  EXPECT_LE(worst, 2.0);
  EXPECT_GE(worst, 0.5) << "no double is nearer to most of them";
}

TEST(TwoSines, OfZeroAreExactAndBeyondTheirRangeThoseOfTheLibrary) {
  const TwoSines still = sinesOf(Two{0.0, -0.0});
  EXPECT_TRUE(still.sine[0] == 0.0 && still.sine[1] == 0.0);
  EXPECT_TRUE(still.cosine[0] == 1.0 && still.cosine[1] == 1.0);
  const double far = 0x1.23456789abcdep40;
  const TwoSines one = sinesOf(Two{far, 1.0});
  EXPECT_EQ(one.sine[0], std::sin(far));
  EXPECT_EQ(one.cosine[0], std::cos(far));
  EXPECT_EQ(one.sine[1], std::sin(1.0));
  EXPECT_TRUE(std::isnan(sinesOf(Two{std::nan(""), 1.0}).sine[0]));
}

}  // namespace
}  // namespace collision_node::geometry

/// A cone that holds two others: what is drawn from either lies in it.
#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "collision_node/geometry/normal_cone.h"

namespace {

using collision_node::geometry::coneOfBoth;
using collision_node::geometry::Vec3;

/// A unit vector at an angle to n, towards `side`.
Vec3 leaning(const Vec3& n, double angle, const Vec3& side) {
  const Vec3 across = (side - n * n.dot(side)).normalized();
  return std::cos(angle) * n + std::sin(angle) * across;
}

double angleBetween(const Vec3& u, const Vec3& v) { return std::atan2(u.cross(v).norm(), u.dot(v)); }

TEST(NormalCone, HoldsBothCones) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit(-1.0, 1.0), decade(-9.0, 0.0);
  const auto direction = [&] { return Vec3(unit(random), unit(random), unit(random)).normalized(); };
  for (int i = 0; i < 10000; ++i) {
    const Vec3 n = direction(), other = leaning(n, std::pow(10.0, decade(random)), direction());
    const double angle = std::pow(10.0, decade(random)), other_angle = std::pow(10.0, decade(random));
    const double both = coneOfBoth(n, angle, other, other_angle);
    EXPECT_GE(both, angle);
    EXPECT_GE(both * (1.0 + 1e-14) + 1e-15, angleBetween(n, leaning(other, other_angle, direction())));
    EXPECT_LE(both, std::max(angle, angleBetween(n, other) + other_angle) * (1.0 + 1e-14) + 1e-15);
  }
}

TEST(NormalCone, KnowsNothingFromWhatIsNotANumber) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Vec3 n = Vec3::UnitX(), none = Vec3::Constant(nan);
  EXPECT_EQ(coneOfBoth(n, 0.1, none, 0.1), M_PI);
  EXPECT_EQ(coneOfBoth(none, 0.1, n, 0.1), M_PI);
  EXPECT_EQ(coneOfBoth(n, 0.1, n, nan), M_PI);
  EXPECT_EQ(coneOfBoth(n, nan, n, 0.1), M_PI);
  EXPECT_EQ(coneOfBoth(n, 0.1, -n, 0.1), M_PI);
}

}  // namespace

/// A cone that holds two others: what is drawn from either lies in it.
#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "collision_node/geometry/normal_cone.h"

namespace {

using collision_node::geometry::coneOfBoth;
using collision_node::geometry::Vec3;

using Real = long double;
using Vec3L = Eigen::Matrix<Real, 3, 1>;

/// A unit vector at an angle to n, towards `side`.
Vec3 leaning(const Vec3& n, double angle, const Vec3& side) {
  const Vec3 across = (side - n * n.dot(side)).normalized();
  return std::cos(angle) * n + std::sin(angle) * across;
}

/// In 64 bits, of vectors of any length: the cross product with what the second has beside the first, or its
/// opposite, which keeps the digits of small angles.
Real angleBetween(const Vec3& u, const Vec3& v) {
  const Vec3L x = u.cast<Real>(), y = v.cast<Real>();
  const Vec3L beside = x.dot(y) > 0 ? Vec3L(y - x) : Vec3L(y + x);
  return std::atan2(x.cross(beside).norm(), x.dot(y));
}

/// "holds both the cone about n and the one about `other`": rounding included, for any lean up to half a
/// turn.
TEST(NormalCone, HoldsBothCones) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit(-1.0, 1.0), decade(-9.0, 0.0);
  const auto direction = [&] { return Vec3(unit(random), unit(random), unit(random)).normalized(); };
  for (int i = 0; i < 30000; ++i) {
    const Vec3 n = direction(), near = i % 2 == 0 ? n : Vec3(-n);
    const Vec3 other = leaning(near, std::pow(10.0, decade(random)), direction());
    const double angle = std::pow(10.0, decade(random)), other_angle = std::pow(10.0, decade(random) - 3.0);
    const double both = coneOfBoth(n, angle, other, other_angle);
    const Real needed = angleBetween(n, other) + static_cast<Real>(other_angle);
    ASSERT_GE(both, angle);
    if (both < M_PI) {
      ASSERT_GE(static_cast<Real>(both), needed) << i;
    }
    ASSERT_LE(both, std::max(static_cast<Real>(angle), needed) * (1.0L + 1e-13L)) << i;
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

/// moving_polygon.h: the two proofs themselves, away from the proposals that usually keep them out of
/// trouble.
#include <gtest/gtest.h>

#include <limits>

#include "collision_node/impact/linear/moving_polygon.h"

namespace collision_node::impact {
namespace {

template <typename Real>
Corners<Real> allAt(double x, double y, double z) {
  Corners<Real> w;
  w.fill({Real(x), Real(y), Real(z)});
  return w;
}

/// Corners at x = gap, at rest, seen along x.
template <typename Real>
bool apartBy(double gap) {
  const Triple<Real> n{Real(1.0), Real(0.0), Real(0.0)};
  const Corners<Real> w = allAt<Real>(gap, 0.5, -0.5);
  return positiveThrough(n, n, w, w, 3);
}

TEST(MovingPolygon, AGapWithinTheRoundingBudgetProvesNothing) {
  EXPECT_FALSE(apartBy<double>(0x1p-52));
  EXPECT_TRUE(apartBy<double>(0x1p-48));
  EXPECT_TRUE(apartBy<DoubleDouble>(0x1p-52));
  EXPECT_FALSE(apartBy<DoubleDouble>(0x1p-102));
  EXPECT_FALSE(apartBy<double>(-0.5));
  EXPECT_FALSE(apartBy<double>(std::numeric_limits<double>::quiet_NaN()));
}

TEST(MovingPolygon, AnAxisThatSeparatesAtBothEndsOnlyProvesNothing) {
  // Corners and axis both turn over: the corners go through the origin half-way.
  const Triple<double> n0{1, 0, 0.125}, n1{-1, 0, 0.125};
  EXPECT_FALSE(positiveThrough(n0, n1, allAt<double>(1, 0, 0), allAt<double>(-1, 0, 0), 3));
  EXPECT_TRUE(positiveThrough(n0, n0, allAt<double>(1, 0, 0), allAt<double>(0.5, 0, 0), 3));
}

constexpr double kSize = 0.5;

/// A triangle around the z axis at height z.
Corners<double> around(double z, double size = kSize) {
  Corners<double> w;
  w[0] = {size, 0, z};
  w[1] = {-size, size, z};
  w[2] = {-size, -size, z};
  return w;
}

TEST(MovingPolygon, ACrossingNeedsTheOriginInsideThroughoutAndBothSidesOfThePlane) {
  const Triple<double> up{0, 0, 1};
  EXPECT_TRUE(crosses(up, around(0.5), around(-0.5), 3));
  EXPECT_FALSE(crosses(up, around(0.5), around(0.25), 3));      // one side only
  EXPECT_FALSE(crosses(up, around(0.5), around(-0x1p-50), 3));  // within the budget
  // Inside at both ends, but turned over between them.
  EXPECT_FALSE(crosses(up, around(0.5), around(-0.5, -kSize), 3));
}

TEST(MovingPolygon, ACrossingWithinTheRoundingBudgetOfASideProvesNothing) {
  const Triple<double> up{0, 0, 1};
  const auto beside = [&](double margin, double z) {
    Corners<double> w = around(z);
    for (auto& corner : w) corner.x = corner.x + kSize - margin;  // the side x = -margin
    return w;
  };
  EXPECT_FALSE(crosses(up, beside(0x1p-52, 0.5), beside(0x1p-52, -0.5), 3));
  EXPECT_FALSE(crosses(up, beside(-0x1p-10, 0.5), beside(-0x1p-10, -0.5), 3));
  EXPECT_TRUE(crosses(up, beside(0x1p-40, 0.5), beside(0x1p-40, -0.5), 3));
}

}  // namespace
}  // namespace collision_node::impact

/// Where the rim of a cylinder meets a plane: held to its lowest point in extended precision.
#include <gtest/gtest.h>

#include <cmath>

#include "collision_node/impact/solve.h"
#include "test/impact/moving_pair.h"

namespace moving {
namespace {

using collision_node::impact::PairEvent;
using collision_node::impact::PairOptions;
using collision_node::impact::Scope;
using collision_node::impact::Solution;
using collision_node::impact::Workspace;

/// A coin falls on a wide box and turns about the direction in which it leans: the lowest point of its rim
/// runs round the rim at the spin over the lean.
TEST(RimFacts, TheBallHoldsThePointOfARimThatRunsRoundWhileTheContactBegins) {
  constexpr collision_node::motion::Nanoseconds kFrame = 33'333'333;
  Random random(1, 0);
  PairOptions options;
  options.scope = Scope::kFirstContact;
  Workspace workspace;
  Solution solution;
  int checked = 0;
  for (int i = 0; i < 3000; ++i) {
    const double r = random.decade(-2, 1), length = r * random.decade(-2.5, -0.5),
                 lean = random.decade(-5, -1.5), speed = random.decade(-1, 1),
                 spin = random.decade(-0.5, 1) * speed / r;
    const double duration = kFrame * 1e-9;
    const double at = std::min(0.4 * duration, 0.3 * lean * speed / (spin * spin * r));
    if (speed * at < 1e-7) continue;
    const double azimuth = random.in(0, 6.28);
    const Vec3 about(std::cos(azimuth), std::sin(azimuth), 0), along = about.cross(Vec3::UnitZ());
    const Vec3 omega = (random.chance(0.5) ? spin : -spin) * along;
    const Quat back(Eigen::AngleAxisd(-spin * at, omega.normalized())), tilt(Eigen::AngleAxisd(lean, about));
    auto falls = flight(0, kFrame, Vec3::Zero(), Vec3(0, 0, -speed), omega);
    falls.q0 = (back * tilt).normalized();
    const auto lowest = [&](Real t) {
      const auto frame = oracle::Path(falls, 0, oracle::exact(Vec3::Zero())).at(t);
      const auto& row = frame.rotation.column;
      const Real across = std::sqrt(row[0].z * row[0].z + row[1].z * row[1].z);
      return frame.place({-r * row[0].z / across, -r * row[1].z / across,
                          row[2].z > 0 ? -static_cast<Real>(length) / 2 : static_cast<Real>(length) / 2});
    };
    const double half = 100 * r + 10, floor = static_cast<double>(lowest(at).z) - half;
    const Real level = static_cast<Real>(floor) + half;
    Real low = 0, high = at + 1e-6;
    if (!(lowest(low).z > level && lowest(high).z < level)) continue;
    for (int k = 0; k < 90; ++k) {
      const Real middle = (low + high) / 2;
      (lowest(middle).z > level ? low : high) = middle;
    }
    const Body ground({placed(collision_node::geometry::Box{Vec3::Constant(2 * half)})}),
        coin({placed(collision_node::geometry::Cylinder{r, length})});
    Piece piece;
    piece.end_ns = kFrame;
    piece.a = collision_node::motion::fixedAt({Vec3(0, 0, floor), Quat::Identity()});
    piece.b = falls;
    solve(ground, coin, piece, options, workspace, solution);
    ASSERT_EQ(solution.events.size(), 1U) << i;
    const PairEvent& event = solution.events[0];
    EXPECT_LE(event.toi_lower, high) << i;
    if (event.toi_upper < low) {  // the other side of the rim touched before
      EXPECT_LE(lowest(event.toi_upper).z, level) << i;
      continue;
    }
    const oracle::V3 point = lowest(high);
    const Vec3 off = event.position - Vec3(static_cast<double>(point.x), static_cast<double>(point.y),
                                           static_cast<double>(point.z));
    EXPECT_LE(off.norm(), event.position_error) << i;
    ++checked;
  }
  EXPECT_GT(checked, 1000);
}

}  // namespace
}  // namespace moving

/// Where a sphere touches a box or a cylinder, and along which normal: held to the closest point of the solid
/// in extended precision, over faces, edges, corners, sides and rims, and where one of them ends.
#include <gtest/gtest.h>

#include <cmath>

#include "collision_node/impact/solve.h"
#include "test/impact/moving_pair.h"

namespace moving {
namespace {

using collision_node::impact::Certificate;
using collision_node::impact::PairEvent;
using collision_node::impact::PairOptions;
using collision_node::impact::Scope;
using collision_node::impact::Solution;
using collision_node::impact::Workspace;

constexpr double kHalf = 0.5, kRadius = 0.25;

/// A cube or a cylinder about the origin that turns about x at a constant rate, and a sphere on a line.
struct Fall {
  bool round;
  double spin;  ///< [rad/s]
  Vec3 from, velocity;

  struct Vec {
    Real x, y, z;
  };
  /// Turned about x.
  static Vec turned(const Vec& v, Real angle) {
    const Real c = std::cos(angle), s = std::sin(angle);
    return {v.x, c * v.y - s * v.z, s * v.y + c * v.z};
  }
  Vec centreAt(Real t) const {
    return {from.x() + t * velocity.x(), from.y() + t * velocity.y(), from.z() + t * velocity.z()};
  }
  /// From the solid's nearest point to the sphere's centre.
  Vec offsetAt(Real t) const {
    const Vec x = turned(centreAt(t), -spin * t);
    const auto beyond = [](Real v) { return v - std::max<Real>(-kHalf, std::min<Real>(kHalf, v)); };
    Vec o{beyond(x.x), beyond(x.y), beyond(x.z)};
    if (round) {
      const Real distance = std::hypot(x.x, x.y), share = std::max<Real>(0, 1 - kHalf / distance);
      o.x = share * x.x;
      o.y = share * x.y;
    }
    return turned(o, spin * t);
  }
  static Real length(const Vec& v) { return std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z); }
};

/// Returns the cone's half angle, infinite where nothing touches.
double check(const Fall& fall, bool sphere_is_a) {
  const std::int64_t end_ns = 1'000'000'000;
  const PlacedShape solid = fall.round ? placed(collision_node::geometry::Cylinder{kHalf, 2.0 * kHalf})
                                       : placed(collision_node::geometry::Box{Vec3::Constant(2.0 * kHalf)});
  const PlacedShape sphere = placed(collision_node::geometry::Sphere{kRadius});
  const RigidMotion turns = flight(0, end_ns, Vec3::Zero(), Vec3::Zero(), Vec3(fall.spin, 0.0, 0.0)),
                    flies = flight(0, end_ns, fall.from, fall.velocity);
  const Piece piece = sphere_is_a ? Piece{0, end_ns, flies, turns} : Piece{0, end_ns, turns, flies};
  const Body a({sphere_is_a ? sphere : solid}), b({sphere_is_a ? solid : sphere});
  PairOptions options;
  options.scope = Scope::kFirstContact;
  Workspace workspace;
  Solution solution;
  solve(a, b, piece, options, workspace, solution);
  if (solution.events.size() != 1) return INFINITY;
  const PairEvent& event = solution.events[0];
  EXPECT_EQ(event.certificate, Certificate::kConfirmed);
  Real low = event.toi_lower, high = event.toi_upper;
  EXPECT_GT(Fall::length(fall.offsetAt(low)), kRadius);
  EXPECT_LE(Fall::length(fall.offsetAt(high)), kRadius);
  for (int i = 0; i < 64; ++i) {
    const Real middle = 0.5L * (low + high);
    (Fall::length(fall.offsetAt(middle)) > kRadius ? low : high) = middle;
  }
  const Fall::Vec offset = fall.offsetAt(high), centre = fall.centreAt(high);
  const Real length = Fall::length(offset), sign = sphere_is_a ? -1.0L : 1.0L;
  const Fall::Vec away{event.position.x() - (centre.x - offset.x), event.position.y() - (centre.y - offset.y),
                       event.position.z() - (centre.z - offset.z)};
  EXPECT_LE(Fall::length(away), event.position_error);
  const Fall::Vec lean{event.normal.x() - sign * offset.x / length,
                       event.normal.y() - sign * offset.y / length,
                       event.normal.z() - sign * offset.z / length};
  EXPECT_LE(2.0L * std::asin(0.5L * Fall::length(lean)), event.normal_error);
  return event.normal_error;
}

TEST(SphereFacts, HoldTheClosestPointAndItsNormal) {
  int touched = 0;
  for (int i = 0; i < 6000; ++i) {
    Random random(77, i);
    const double size = random.in(0.0, 1.0) < 0.3 ? 1.2 : kHalf + 0.02;
    const Vec3 goal = randomVec(random, size);
    Fall fall;
    fall.round = i % 2 == 1;
    fall.spin = i % 3 == 0 ? 0.0 : random.in(-3.0, 3.0);
    fall.from = 3.0 * randomVec(random, 1.0).normalized();
    fall.velocity = (goal - fall.from) * random.in(1.0, 2.0);
    SCOPED_TRACE("case " + std::to_string(i));
    touched += check(fall, i % 4 < 2) < 1e-3;
    if (HasFailure()) return;
  }
  EXPECT_GT(touched, 2500);
}

TEST(SphereFacts, AFaceEndsWhereItEnds) {
  // Along a face at 100 m/s, down at 1 m/s: while the bracket lasts, the centre comes over the border.
  for (const bool round : {false, true}) {
    for (int i = -300; i <= 300; ++i) {
      const double beside = 2e-10 * i * std::abs(i);
      const Fall fall{round, 0.0, Vec3(kHalf + beside - 100.0 * 0.25, 0.0, kHalf + kRadius + 0.25),
                      Vec3(100.0, 0.0, -1.0)};
      SCOPED_TRACE("beside " + std::to_string(1e9 * beside) + " nm");
      check(fall, i % 2 == 0);
      if (HasFailure()) return;
    }
  }
}

TEST(SphereFacts, OnAFaceTheNormalIsTheFaces) {
  for (const bool round : {false, true}) {
    for (const bool sphere_is_a : {false, true}) {
      for (const double spin : {0.0, 1.0}) {
        const Fall fall{round, spin, Vec3(0.1, 0.2, 1.5), Vec3(0.0, 0.0, -2.0)};
        EXPECT_LT(check(fall, sphere_is_a), 1e-9 * spin + 1e-13);
      }
    }
  }
}

/// Seen straight along a tilted axis, rounding may leave any direction as the way across it.
TEST(SphereFacts, ABallOnACapHoldsTheContactHoweverTheCylinderIsTilted) {
  const double height = 0.5, rim = 1.0, radius = 0.25, start = 1.0;
  const Body sphere({placed(collision_node::geometry::Sphere{radius})});
  PairOptions options;
  options.scope = Scope::kFirstContact;
  options.time_precision = 0.1;
  options.distance_precision = 10.0;
  Workspace workspace;
  Solution solution;
  for (int i = 0; i < 4000; ++i) {
    const Quat turn = Quat(std::cos(i), std::sin(i), std::cos(3.0 * i), std::sin(7.0 * i)).normalized(),
               tilt = turn * turn;
    PlacedShape shape = placed(collision_node::geometry::Cylinder{rim, 2.0 * height});
    shape.origin.orientation = turn;
    const Body cylinder({shape});
    Piece piece;
    piece.end_ns = 1'000'000'000;
    piece.a = collision_node::motion::fixedAt({Vec3::Zero(), turn});
    piece.b =
        flight(0, piece.end_ns, tilt * Vec3(0.9 * rim, 0.0, height + start), tilt * Vec3(0.0, 0.0, -start));
    solve(cylinder, sphere, piece, options, workspace, solution);
    ASSERT_EQ(solution.events.size(), 1U);
    const PairEvent& event = solution.events[0];
    EXPECT_LE((event.position - tilt * Vec3(0.9 * rim, 0.0, height)).norm(), event.position_error) << i;
  }
}

}  // namespace
}  // namespace moving

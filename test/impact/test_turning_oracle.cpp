/// The oracle for turning features against closed forms, against rational arithmetic, and against static
/// tests on both sides of its enclosures.
#include <gtest/gtest.h>

#include "test/impact/fuzz_shapes.h"
#include "test/oracle/exact_translation.h"
#include "test/oracle/turning_contact.h"

namespace {

using collision_node::geometry::Quat;
using collision_node::geometry::Vec3;
using collision_node::motion::StampedPose;
using fuzz::Random;
using oracle::I3;
using oracle::Interval;
using oracle::Mp;
using oracle::Polyhedron;
using oracle::Rational;
using oracle::StampedMotion;
using oracle::SurfaceTouch;
using oracle::TurningContact;
using Model = StampedMotion::Model;

constexpr std::uint64_t kSeed = 20261101;
constexpr std::int64_t kStart = 1'700'000'000'000'000'000, kSecond = 1'000'000'000;
constexpr double kTurn = 6.283185307179586;

/// The segment over [kStart, kStart + 1 s]: `angle` about `axis`, so many whole turns told by the twist.
StampedMotion turning(const Vec3& from, const Vec3& to, double angle, const Vec3& axis,
                      Model model = Model::kTurns) {
  StampedPose first, last;
  first.stamp_ns = kStart, last.stamp_ns = kStart + kSecond;
  first.pose.position = from, last.pose.position = to;
  last.pose.orientation = Quat(Eigen::AngleAxisd(std::remainder(angle, kTurn), axis));
  first.angular = last.angular = angle * axis;
  return {first, last, model};
}
StampedMotion still(const Vec3& position = Vec3::Zero()) {
  return StampedMotion(collision_node::geometry::Pose{position, Quat::Identity()});
}

SurfaceTouch solve(const Polyhedron& a, const StampedMotion& ma, const Polyhedron& b,
                   const StampedMotion& mb) {
  const TurningContact contact(a, ma, b, mb, kStart, kStart + kSecond);
  return contact.firstTouch(0, contact.duration());
}

Interval rateOf(const StampedMotion& m) { return m.rate().negative() ? -m.rate() : m.rate(); }

/// The enclosure holds the whole interval of the truth and is hardly wider.
void expectHolds(const SurfaceTouch& touch, const Interval& truth) {
  ASSERT_TRUE(touch.found && touch.proven);
  EXPECT_FALSE(truth.hi < touch.lo) << truth.hi.toDouble() << " before " << touch.lo.toDouble();
  EXPECT_FALSE(touch.hi < truth.lo) << truth.lo.toDouble() << " after " << touch.hi.toDouble();
  EXPECT_LE(oracle::widthOf(Interval(touch.lo, touch.hi)), 1e-25);
}

const Polyhedron kWall = {{{-50, 0, -50}, {50, 0, -50}, {0, 0, 90}}, {{0, 1, 2}}};  // the plane y = 0

TEST(TurningOracle, ATurningTipMeetsAPlaneWhereItsSineSaysSo) {
  // The tip at radius 3/4 about z, from angle 0 up; the plane is at y = 1/2: sine of the angle = 2/3.
  const Polyhedron tip = {{{0.75, 0, 0}}, {}};
  const Interval share = Interval(2) / Interval(3);
  const Interval angle = oracle::arctan(share / sqrt(Interval(1) - share * share));
  for (const double whole : {2.0, 100.0, 3333.0}) {
    const StampedMotion turn = turning(Vec3::Zero(), Vec3::Zero(), whole, Vec3::UnitZ());
    expectHolds(solve(tip, turn, kWall, still({0, 0.5, 0})), angle / rateOf(turn));
    expectHolds(solve(kWall, still({0, 0.5, 0}), tip, turn), angle / rateOf(turn));
    const StampedMotion back = turning(Vec3::Zero(), Vec3::Zero(), -whole, Vec3::UnitZ());
    // the other way round the sine is 2/3 half a turn later
    const Interval half = Interval(0.5) * oracle::wholeTurn();
    if (whole > 4) expectHolds(solve(tip, back, kWall, still({0, 0.5, 0})), (half + angle) / rateOf(back));
  }
  EXPECT_FALSE(
      solve(tip, turning(Vec3::Zero(), Vec3::Zero(), 3333, Vec3::UnitZ()), kWall, still({0, 0.75 + 1e-9, 0}))
          .found)
      << "a hair beyond its reach for 530 turns";
}

TEST(TurningOracle, ABladesEdgeMeetsAPostWhereItsArcTangentSaysSo) {
  const Polyhedron blade = {{{0, 0, 0}, {2, 0, 0}, {0, 0, -1}}, {{0, 1, 2}}};
  const Polyhedron post = {{{0, 0, -3}, {0, 0, 1}, {-9, 9, 5}}, {{0, 1, 2}}};  // its edge along z is met
  const double x = 0.5, y = 1.25;
  const StampedMotion turn = turning(Vec3::Zero(), Vec3::Zero(), 2.5, Vec3::UnitZ());
  const SurfaceTouch touch = solve(blade, turn, post, still({x, y, 0}));
  expectHolds(touch, oracle::arctan(Interval(y) / Interval(x)) / rateOf(turn));
  ASSERT_TRUE(touch.facts);
  EXPECT_NEAR(touch.point[0].lo.toDouble(), x, 1e-20);
  EXPECT_NEAR(touch.point[1].hi.toDouble(), y, 1e-20);
  EXPECT_GT((touch.normal[0].lo.toDouble() * -y + touch.normal[1].lo.toDouble() * x), 0)
      << "from the blade to the post";
}

TEST(TurningOracle, ADrillMeetsAPlaneAsIfItDidNotTurn) {
  // Along y, turning about y: the tip is on the axis, its corners are behind.
  const Polyhedron drill = {{{0, 1, 0}, {0.2, 0.5, 0}, {-0.1, 0.5, 0.2}, {-0.1, 0.5, -0.2}},
                            {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}}};
  const StampedMotion advance = turning({0, -7, 0}, {0, 3, 0}, 900, Vec3::UnitY());
  expectHolds(solve(drill, advance, kWall, still()), Interval(6) / Interval(10));
}

TEST(TurningOracle, ACubicMeetsAPlaneBetweenTwoSignsOfItsRationalValue) {
  int met = 0;
  for (int i = 0; i < 60; ++i) {
    Random random(kSeed, i);
    SCOPED_TRACE("seed " + std::to_string(kSeed) + " index " + std::to_string(i));
    const auto vec = [&](double s) { return Vec3(random.in(-s, s), random.in(-s, s), random.in(-s, s)); };
    StampedPose from, to;
    from.stamp_ns = kStart, to.stamp_ns = kStart + kSecond;
    from.pose.position = vec(3) + Vec3(0, 4, 0), to.pose.position = vec(3);
    from.linear = vec(20), to.linear = vec(20);
    const TurningContact contact({{{0, 0, 0}}, {}}, {from, to, Model::kCubic}, kWall, still(), kStart,
                                 kStart + kSecond);
    const SurfaceTouch touch = contact.firstTouch(0, 1);
    const auto height = [&](const Rational& t) {  // Hermite's basis, h = 1 s
      const Rational p(from.pose.position.y()), q(to.pose.position.y()), v(from.linear.y()), w(to.linear.y());
      return Rational((2 * t * t * t - 3 * t * t + 1) * p + (t * t * t - 2 * t * t + t) * v +
                      (3 * t * t - 2 * t * t * t) * q + (t * t * t - t * t) * w);
    };
    Rational last = touch.found ? Rational(touch.lo.toDouble(MPFR_RNDD)) : Rational(1);
    for (int k = 0; k <= 50; ++k)
      EXPECT_GT(sgn(height(last * k / 50)), touch.found && k == 50 ? -1 : 0) << "apart up to there";
    if (!touch.found) continue;
    ++met;
    EXPECT_TRUE(touch.proven);
    EXPECT_LE(sgn(height(Rational(touch.hi.toDouble(MPFR_RNDU)))), 0) << "through by then";
  }
  EXPECT_GE(met, 20);
}

TEST(TurningOracle, TranslationsAgreeWithRationalArithmetic) {
  int met = 0, apart = 0;
  for (int i = 0; i < 300; ++i) {
    Random random(kSeed + 1, i);
    SCOPED_TRACE("seed " + std::to_string(kSeed + 1) + " index " + std::to_string(i));
    const auto vec = [&](double s) { return Vec3(random.in(-s, s), random.in(-s, s), random.in(-s, s)); };
    Polyhedron shape[2];
    std::vector<oracle::R3> corners[2];
    for (int k = 0; k < 2; ++k) {
      for (int c = 0; c < 3; ++c) {
        const Vec3 v = vec(1);
        shape[k].vertices.push_back({v.x(), v.y(), v.z()});
        corners[k].push_back(oracle::rational(v));
      }
      shape[k].triangles.push_back({0, 1, 2});
    }
    const Vec3 start = vec(4), end = vec(1) - start;
    const SurfaceTouch touch = solve(shape[0], still(), shape[1], turning(start, end, 0, Vec3::UnitX()));
    const oracle::R3 offset = oracle::rational(start), velocity = oracle::rational(end) - offset;
    auto truth = oracle::contactTimes(corners[0], corners[1], offset, velocity);
    if (truth && truth->first < 0 && truth->last >= 0) continue;  // from the start
    if (truth && (truth->first < 0 || truth->first > 1)) truth.reset();
    ASSERT_EQ(touch.found, truth.has_value());
    (truth ? met : apart)++;
    if (!truth) continue;
    ASSERT_TRUE(touch.proven);
    EXPECT_LE(mpfr_cmp_q(touch.lo.raw(), truth->first.get_mpq_t()), 0);
    EXPECT_GE(mpfr_cmp_q(touch.hi.raw(), truth->first.get_mpq_t()), 0);
    EXPECT_LE(oracle::widthOf(Interval(touch.lo, touch.hi)), 1e-25);
  }
  EXPECT_GE(met, 60);
  EXPECT_GE(apart, 60);
}

TEST(TurningOracle, BothSidesOfAnEnclosureAreWhatItSays) {
  const Polyhedron tetra = {{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}},
                            {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}}};
  int met = 0, apart = 0;
  for (int i = 0; i < 120; ++i) {
    Random random(kSeed + 2, i);
    SCOPED_TRACE("seed " + std::to_string(kSeed + 2) + " index " + std::to_string(i));
    const auto motion = [&](const Vec3& from, const Vec3& to) {
      return turning(from, to, random.in(-40, 40), random.direction());
    };
    const StampedMotion a = motion(Vec3::Zero(), random.direction()),
                        b = motion(5 * random.direction(), 3 * random.direction());
    const TurningContact contact(tetra, a, tetra, b, kStart, kStart + kSecond);
    const SurfaceTouch touch = contact.firstTouch(0, contact.duration());
    ASSERT_FALSE(touch.gave_up);
    for (int k = 0; k < 40; ++k) {
      const double t = (touch.found ? touch.lo.toDouble(MPFR_RNDD) : contact.duration()) * k / 40;
      ASSERT_TRUE(contact.separated(Mp(t))) << t;
      ASSERT_FALSE(contact.pierces(Mp(t))) << t;
    }
    ++(touch.found ? met : apart);
    if (!touch.found) continue;
    ASSERT_TRUE(touch.proven);
    Mp inside, hair(1e-22);
    mpfr_add(inside.raw(), touch.hi.raw(), hair.raw(), MPFR_RNDU);
    EXPECT_TRUE(contact.pierces(inside));
    EXPECT_FALSE(contact.separated(inside));
    mpfr_sub(inside.raw(), touch.lo.raw(), hair.raw(), MPFR_RNDD);
    EXPECT_TRUE(contact.separated(inside));
  }
  EXPECT_GE(met, 30);
  EXPECT_GE(apart, 20);
}

}  // namespace

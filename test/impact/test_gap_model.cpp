/// gap_model.h: "the elements are farther than contact_distance apart, in exact arithmetic of the loaded
/// geometry and the motion model, at every time in [t, t + s]"; the model is a "lower bound of the gap along
/// n(s)": at s = x end at least (1 - x)^2 first + 2 x (1 - x) middle + x^2 last.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <limits>

#include "collision_node/impact/convex/gap_model.h"
#include "test/impact/moving_pair.h"

namespace collision_node::impact {
namespace {

using moving::Random;
using oracle::Real;
using oracle::V3;

constexpr std::uint64_t kSeed = 77001;

geometry::PlacedShape randomElement(Random& random, double size) {
  geometry::PlacedShape out;
  out.source = "random";
  out.origin = {moving::randomVec(random, size * random.decade(-1, 0.5)), random.orientation()};
  const auto length = [&] { return size * random.decade(-1.5, 0); };
  switch (random.below(7)) {
    case 0:
      out.shape = geometry::Point{};
      break;
    case 1:
      out.shape = geometry::Sphere{length()};
      break;
    case 2:
      out.shape = geometry::Capsule{random.chance(0.5) ? length() : 1e-9 * size, length()};
      break;
    case 3:
      out.shape = geometry::Box{{length(), length(), length()}};
      break;
    case 4:
      out.shape = geometry::Cylinder{length(), length()};
      break;
    default: {  // a triangle, now and then a needle
      const Vec3 p = moving::randomVec(random, size), q = moving::randomVec(random, size);
      Vec3 r = moving::randomVec(random, size);
      if (random.chance(0.2)) r = p + 0.5 * (q - p) + 1e-9 * r;
      out.shape = moving::mesh({p, q, r}, {{0, 1, 2}}).shape;
    }
  }
  return out;
}

/// max over the element, without its radius, of u . x; u in the element's frame.
Real supportOfCore(const Element& e, const V3& u) {
  if (e.vertices == nullptr) {
    const V3 axis = oracle::exact(e.axis);
    const Real along = oracle::dot(u, axis);
    return oracle::dot(u, oracle::exact(e.centre)) + e.half_length * std::abs(along) +
           e.rim_radius * oracle::norm(u - along * axis);
  }
  Real best = -std::numeric_limits<Real>::infinity();
  for (int i = 0; i < e.count; ++i) best = std::max(best, oracle::dot(u, oracle::exact(e.vertices[i])));
  return best;
}

/// R^T u
V3 turnedBack(const oracle::M3& r, const V3& u) {
  return {oracle::dot(r.column[0], u), oracle::dot(r.column[1], u), oracle::dot(r.column[2], u)};
}

struct Moving {
  const moving::Pair& pair;
  double t;
  Element a, b;

  /// The exact separation along n(s), s seconds after t: positive proves the elements apart.
  Real separation(const Axis& axis, Real s) const {
    const oracle::Frame fa = pair.exact.pathA().at(t + s), fb = pair.exact.pathB().at(t + s);
    const V3 n = oracle::exact(axis.direction) + s * oracle::exact(axis.rate);
    const Real radius = static_cast<Real>(a.radius) + b.radius + pair.solver.contact_distance;
    return oracle::dot(n, fb.position - fa.position) - supportOfCore(b, turnedBack(fb.rotation, -n)) -
           supportOfCore(a, turnedBack(fa.rotation, n)) - radius * oracle::norm(n);
  }
};

/// Proposals of the solver, the same bent out of shape, and any axis with any rate.
std::vector<Axis> axesFor(Random& random, const Moving& m, const Instant& now) {
  const Closest closest = closestPoints(Cores(now, m.a, m.b), Vec3::Zero());
  const Axes features = featureAxes(m.pair.solver, now, m.a, m.b);
  std::vector<Axis> axes(features.begin(), features.end());
  if (axes.size() > 6) axes.resize(6);
  for (const bool rounded : {false, true}) {
    const Axis axis = axisOf(m.pair.solver, now, closest, rounded);
    if (axis.valid) axes.push_back(axis);
    if (axis.valid && random.chance(0.5)) {
      axes.push_back(axis);
      axes.back().direction += random.decade(-6, -0.5) * random.direction();
      axes.back().rate += random.decade(-3, 3) * random.direction();
    }
  }
  const double duration = m.pair.solver.motion.duration();
  axes.push_back({random.direction(), random.decade(-3, 2) / duration * random.direction(), true});
  axes.push_back({random.direction(), Vec3::Zero(), true});
  return axes;
}

TEST(GapModel, StaysBelowTheExactSeparation) {
  Random random(kSeed, 0);
  Real worst = std::numeric_limits<Real>::infinity();
  int models = 0, proofs = 0;
  for (int i = 0; i < 10000; ++i) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + " case " + std::to_string(i));
    const double size = random.decade(-2, 2), at = random.in(0, 0.9);
    const moving::Shapes a = {randomElement(random, size)}, b = {randomElement(random, size)};
    const Vec3 offset = size * random.decade(-8, 0.7) * random.direction();
    const Piece piece = moving::randomPiece(random, size, fuzz::pointOf(random, a[0].shape),
                                            fuzz::pointOf(random, b[0].shape), at, offset);
    const double contact_distance = random.chance(0.3) ? size * random.decade(-9, -1) : 0.0;
    const moving::Pair pair(a, b, piece, contact_distance);
    Vec3 buffer_a[3], buffer_b[3];
    const double duration = pair.solver.motion.duration();
    const Moving m{pair, at * duration, pair.body_a.element(0, buffer_a), pair.body_b.element(0, buffer_b)};
    const Instant now = pair.solver.at(m.t);
    for (const Axis& axis : axesFor(random, m, now)) {
      const CorePair cores(m.a, m.b);
      const GapModel model(pair.solver, now, cores, axis);
      ++models;
      const double rest = duration - m.t;
      for (const double end : {0.0, rest * 1e-6, rest * 1e-3, rest * random.decade(-2, 0), rest}) {
        const GapModel::Bounds bounds = model.until(end);
        ASSERT_EQ(bounds.first, model.first());
        const double budget = axis.direction.norm() * pair.solver.point_error +
                              end * (axis.rate.norm() * pair.solver.point_error +
                                     axis.direction.norm() * pair.solver.rate_error);
        double least = std::numeric_limits<double>::infinity();
        for (int k = 0; k <= 8; ++k) {
          const Real x = static_cast<Real>(k) / 8, y = 1 - x;
          const Real bound = y * y * bounds.first + 2 * x * y * bounds.middle + x * x * bounds.last;
          const Real exact = m.separation(axis, x * end);
          least = std::min(least, static_cast<double>(bound));
          worst = std::min(worst, (exact - bound) / budget);
          ASSERT_LE(bound, exact) << "s " << static_cast<double>(x * end) << " of " << end << " axis "
                                  << axis.direction.transpose() << " rate " << axis.rate.transpose();
        }
        ASSERT_TRUE(!bounds.positive() || least > 0.0);
      }

      const double s = apartFor(model, rest).time;
      ASSERT_GE(s, 0.0);
      ASSERT_LE(s, rest);
      if (s == 0.0) continue;
      ++proofs;
      const bool one_part = m.a.count <= 3 && m.b.count <= 3 && !(m.a.count == 0 && m.b.count == 0);
      for (int k = 0; k <= 12; ++k) {
        const Real u = static_cast<Real>(s) * k / 12;
        ASSERT_GT(m.separation(axis, u), 0) << "apart for " << s << " but not at " << static_cast<double>(u);
        if (!one_part || k % 4 != 0) continue;
        const oracle::Gap distance =
            oracle::partGap(oracle::placed(moving::exactPart(m.a), pair.exact.pathA().at(m.t + u)),
                            oracle::placed(moving::exactPart(m.b), pair.exact.pathB().at(m.t + u)));
        ASSERT_GT(distance.upper, contact_distance);
      }
    }
  }
  std::printf("%d models, %d proofs of clearance; least slack %.3f budgets\n", models, proofs,
              static_cast<double>(worst));
  EXPECT_GT(proofs, models / 20);
}

TEST(GapModel, ProvesClearanceOfWhatIsClearlyApart) {
  // Not a guarantee, but without it the solver would answer nothing: the first proposal proves some time
  // wherever the elements are farther apart than 1e-6 of their size.
  Random random(kSeed, 1);
  int apart = 0, proved = 0;
  for (int i = 0; i < 4000; ++i) {
    const double size = random.decade(-2, 2);
    const moving::Shapes a = {randomElement(random, size)}, b = {randomElement(random, size)};
    const Piece piece = moving::randomPiece(random, size, Vec3::Zero(), Vec3::Zero(), 0.0,
                                            size * random.in(0, 5) * random.direction());
    const moving::Pair pair(a, b, piece);
    if (pair.exact.provedDistance(0) < 1e-6L * size) continue;
    Vec3 buffer_a[3], buffer_b[3];
    const Element ea = pair.body_a.element(0, buffer_a), eb = pair.body_b.element(0, buffer_b);
    const Instant now = pair.solver.at(0.0);
    const Axis axis = axisOf(pair.solver, now, closestPoints(Cores(now, ea, eb), Vec3::Zero()),
                             ea.radius + eb.radius > 0.0);
    ++apart;
    proved +=
        axis.valid &&
        apartFor(GapModel(pair.solver, now, CorePair(ea, eb), axis), pair.solver.motion.duration()).time >
            0.0;
  }
  std::printf("%d of %d pairs that are apart proved so\n", proved, apart);
  EXPECT_GT(apart, 1500);
  EXPECT_GT(proved, 0.999 * apart) << "seed " << kSeed;
}

TEST(GapModel, ApartForFindsMostOfTheTime) {
  // Not a guarantee, but a proof of no time for a gap far above the budget would halt every search behind it.
  Random random(kSeed, 2);
  int asked = 0;
  for (int i = 0; i < 20000; ++i) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + " case " + std::to_string(i));
    const double size = random.decade(-2, 2);
    const moving::Shapes a = {moving::placed(geometry::Box{{size, size, size}})};
    const moving::Shapes b = {moving::placed(geometry::Sphere{0.1 * size})};
    Piece piece{0, 33'333'333, moving::resting(),
                moving::flight(
                    0, 33'333'333, size * Vec3(random.in(-0.4, 0.4), random.in(-0.4, 0.4), random.in(0.7, 3)),
                    size * random.decade(0, 4) * (Vec3(0, 0, -1) + moving::randomVec(random, 0.2)))};
    if (random.chance(0.7)) piece.b.omega = random.decade(-3, 2) * random.direction();
    if (random.chance(0.3)) piece.a.omega = random.decade(-3, 2) * random.direction();
    const moving::Pair pair(a, b, piece);
    Vec3 buffer[3];
    const Element ea = pair.body_a.element(0, buffer), eb = pair.body_b.element(0, buffer);
    const CorePair cores(ea, eb);
    const GapModel model(pair.solver, pair.solver.at(0.0), cores, {Vec3::UnitZ(), Vec3::Zero(), true});
    const double span = pair.solver.motion.duration();
    const double s = apartFor(model, span).time;
    if (!(model.first() > 1e4 * pair.solver.point_error)) continue;
    ++asked;
    double zero = span, low = 0.0;  // of the computed model, by bisection
    for (int k = 0; k < 80 && !model.until(span).positive(); ++k) {
      const double mid = 0.5 * (low + zero);
      (model.until(mid).positive() ? low : zero) = mid;
    }
    ASSERT_GE(s, 0.5 * zero) << "gap " << model.first() << " slope " << model.trend().slope;
  }
  EXPECT_GT(asked, 15000);
}

TEST(GapModel, APureTranslationIsProvedInOneStep) {
  // A sphere 5 mm beside its path past a plate's edge: one evaluation proves the whole 67 m.
  const Piece piece{0, 33'333'333, moving::resting(),
                    moving::flight(0, 33'333'333, {-30, 0.505, 0}, {2000, 0, 0})};
  const moving::Pair pair({moving::placed(geometry::Box{{1, 1, 0.01}})}, {moving::placed(geometry::Point{})},
                          piece);
  Vec3 buffer[3];
  const Element a = pair.body_a.element(0, buffer), b = pair.body_b.element(0, buffer);
  const CorePair cores(a, b);
  const GapModel model(pair.solver, pair.solver.at(0.0), cores, {Vec3::UnitY(), Vec3::Zero(), true});
  EXPECT_EQ(apartFor(model, pair.solver.motion.duration()).time, pair.solver.motion.duration());
  EXPECT_NEAR(model.first(), 0.005, 1e-9);
}

/// The first guess of a step must not be of another sign than the gap: thousands of steps went by a millionth
/// of the time each where a cylinder and a box part within rounding.
TEST(GapModel, TheGuessBeginsNoLowerThanTheGapHoweverSmallThatIs) {
  moving::Random random(274, 0);
  int small = 0;
  for (int i = 0; i < 20000; ++i) {
    SCOPED_TRACE(i);
    const double length = random.in(0.2, 2.0);
    const geometry::Quat turn = random.orientation();
    const Vec3 up = turn * Vec3::UnitZ();
    const Vec3 at = (0.5 + 0.5 * length) * up + random.decade(-15, -9) * up;
    const Vec3 spin = random.decade(-6, 0) * random.direction();
    const moving::Pair pair({moving::placed(geometry::Box{{1.0, 1.0, 1.0}})},
                            {moving::placed(geometry::Cylinder{random.in(0.1, 1.0), length})},
                            {0, 1000000000, moving::resting(Vec3::Zero(), turn),
                             moving::flight(0, 1000000000, at, random.decade(-6, 0) * up, spin, turn)});
    Vec3 buffer[3];
    const Element a = pair.body_a.element(0, buffer), b = pair.body_b.element(0, buffer);
    const Instant now = pair.solver.at(0.0);
    const CorePair cores(a, b);
    const GapModel model(pair.solver, now, cores, {up, Vec3::Zero(), true});
    if (!(model.first() > 0.0)) continue;
    ++small;
    for (const double span : {1e-9, 1e-3, 1.0}) EXPECT_GE(model.trend(span).first, model.first());
  }
  EXPECT_GT(small, 5000);
}

}  // namespace
}  // namespace collision_node::impact

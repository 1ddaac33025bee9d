/// The rounding budget of docs/solver.md, against the same expressions in 240 bits from the same doubles.
/// Offsets to 1e8 m, sizes 1e-6 to 1e6 m, spins to 3333 rad per piece, straight and cubic paths. Prints the
/// largest share of each budget that was used.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "collision_node/impact/convex/gap_model.h"
#include "collision_node/impact/straight/straight_path.h"
#include "test/impact/exact_sweep.h"
#include "test/oracle/stamped_motion.h"

namespace collision_node::impact {
namespace {

using exact::bodyOf;
using exact::supportOf;
using exact::sweep;
using exact::upper;
using moving::Random;
using moving::RigidMotion;
using oracle::I3;
using oracle::Interval;
using oracle::interval3;
using oracle::IntervalPath;

constexpr std::uint64_t kSeed = 20240812;

double largest(const Interval& v) { return std::max(upper(v), upper(-v)); }

TEST(RoundingBudget, EveryPointDifferenceAndEveryGapValueIsWithinIt) {
  // "any computed point difference b - a is within point_error of the exact one at the same t; a computed
  // separation value along an axis n(s) is within |n(s)| (point_error + s rate_error) of the exact value."
  double worst_point = 0, worst_gap = 0, worst_distance = 0;
  int near_ones = 0;
  for (int i = 0; i < 2500; ++i) {
    Random random(kSeed, i);
    SCOPED_TRACE("seed " + std::to_string(kSeed) + " index " + std::to_string(i));
    const double size = random.decade(-6, 6);
    const Body a({bodyOf(random, size)}), b({bodyOf(random, size * random.decade(-6, 1))});
    const Piece piece = sweep(random, size);
    const PairPiece pair(a, b, piece, random.chance(0.3) ? 0.01 * size : 0.0);
    const IntervalPath path_a(piece.a, piece.start_ns), path_b(piece.b, piece.start_ns);
    const double duration = pair.motion.duration();
    const double t = random.chance(0.2) ? 0.0 : random.chance(0.2) ? duration : random.in(0, duration);
    // As a whole, or a short turn on from another instant.
    const double spin = std::max({pair.motion.spinA(), pair.motion.spinB(), 1e-300});
    const double other = std::clamp(t + random.in(-0x1p-28, 0x1p-28) / spin, 0.0, duration);
    const Instant beside = pair.at(other);
    const bool from_other = random.chance(0.5) && pair.isNear(t, beside);
    near_ones += from_other && other != t;
    const Instant now = from_other ? pair.at(t, beside) : pair.at(t);
    const auto turn_a = path_a.turn(t), turn_b = path_b.turn(t);
    const I3 d = minus(path_b.position(t), path_a.position(t)),
             d_rate = minus(path_b.velocity(t), path_a.velocity(t)),
             d_bend = minus(path_b.acceleration(t), path_a.acceleration(t));

    Vec3 buffer_a[3], buffer_b[3];
    const Element ea = a.element(0, buffer_a), eb = b.element(0, buffer_b);
    const auto someCorner = [&](const Element& e) {
      return e.vertices != nullptr ? e.vertices[random.below(e.count)]
                                   : Vec3(e.centre + e.half_length * e.axis + Vec3(e.rim_radius, 0, 0));
    };
    const Vec3 x = someCorner(ea), y = someCorner(eb);
    const Vec3 computed = (now.d + now.rb * y) - now.ra * x;
    const I3 exact =
        minus(plus(d, path_b.rotated(turn_b, interval3(y))), path_a.rotated(turn_a, interval3(x)));
    const double off = upper(lengthOf(minus(interval3(computed), exact)));
    worst_point = std::max(worst_point, off / pair.point_error);
    ASSERT_LE(off, pair.point_error);
    const double off_d = upper(lengthOf(minus(interval3(now.d), d)));
    worst_distance = std::max(worst_distance, off_d / pair.motion.translationError());
    ASSERT_LE(off_d, pair.motion.translationError());

    // The gap model along an axis that turns up to a few times per piece, at an s of any size.
    Axis axis;
    axis.direction = random.direction();
    axis.rate = random.chance(0.3)
                    ? Vec3(Vec3::Zero())
                    : Vec3((random.decade(-2, 1) / duration + pair.motion.spinA()) * random.direction());
    axis.valid = true;
    const double s = random.chance(0.2) ? 0.0 : (duration - t) * random.decade(-12, 0);
    const CorePair cores(ea, eb);
    const GapModel model(pair, now, cores, axis);
    const I3 n0 = interval3(axis.direction), n1 = interval3(axis.rate);
    // The control points of the gap over [0, s], without its remainder: a support in the direction
    // u = R^T (n0 + x (n1 + n0 x omega) + y (omega x (omega x n0)/2 - omega x n1)), component by component.
    const auto support = [&](const Element& e, const IntervalPath& path, const IntervalPath::Turn& turn,
                             double x, double y, bool minimum) {
      const I3 omega = path.omega();
      const I3 second = minus(times(0.5, crossOf(omega, crossOf(omega, n0))), crossOf(omega, n1));
      I3 world = plus(plus(n0, times(x, plus(n1, crossOf(n0, omega)))), times(y, second));
      if (minimum) world = times(-1, world);
      I3 u;
      for (int k = 0; k < 3; ++k) {
        const Vec3 unit = Vec3::Unit(k);
        u[static_cast<std::size_t>(k)] = dotOf(path.rotated(turn, interval3(unit)), world);
      }
      return supportOf(e, u);
    };
    const Interval grown = Interval(ea.radius) + Interval(eb.radius) + Interval(pair.contact_distance);
    const GapModel::Bounds bounds = model.until(s);
    const auto check = [&](double x, double y, double said) {
      const I3 axis_there = plus(n0, times(x, n1));
      const Interval exact_value = dotOf(n0, d) + Interval(x) * (dotOf(n1, d) + dotOf(n0, d_rate)) +
                                   Interval(y) * (dotOf(n1, d_rate) + Interval(0.5) * dotOf(n0, d_bend)) -
                                   support(ea, path_a, turn_a, x, y, false) -
                                   support(eb, path_b, turn_b, x, y, true) - grown * lengthOf(axis_there);
      const double length = axis.direction.norm() + x * axis.rate.norm();
      const double budget = length * (pair.point_error + x * pair.rate_error);
      // Budget and remainder are already subtracted: it may be lower, never higher.
      const double excess = upper(Interval(said) + Interval(budget) - exact_value);
      worst_gap = std::max(worst_gap, excess / budget);
      EXPECT_LE(excess, budget) << "x " << x << " y " << y << " of " << duration;
      // At s = 0 there is no remainder: the value is off by no more than the budget either way.
      if (x == 0.0) {
        EXPECT_LE(largest(Interval(said) + Interval(budget) - exact_value), budget);
      }
    };
    check(0.0, 0.0, bounds.first);
    check(0.5 * s, 0.0, bounds.middle);
    check(s, s * s, bounds.last);
    if (testing::Test::HasFailure()) return;
  }
  std::printf("largest share used: displacement %.3f, point difference %.3f, gap value %.3f\n",
              worst_distance, worst_point, worst_gap);
  EXPECT_GT(near_ones, 700);
  EXPECT_GT(worst_point, 1e-3) << "a budget that is never used would hide a solver that is needlessly unsure";
}

TEST(RoundingBudget, AStraightPathIsWithinItAndItIsNoLargerThanThatOfThePair) {
  // "the exact path stays within error() of at(t) for every t of the piece"
  double worst = 0, largest_share = 0;
  for (int i = 0; i < 4000; ++i) {
    Random random(kSeed + 2, i);
    SCOPED_TRACE("seed " + std::to_string(kSeed + 2) + " index " + std::to_string(i));
    const double size = random.decade(-6, 6);
    Piece piece = sweep(random, size);
    const bool point_is_a = random.chance(0.5), spins = random.chance(0.3);
    for (RigidMotion* m : {&piece.a, &piece.b}) {
      m->c[2] = m->c[3] = Vec3::Zero();
      if (!spins || (m == &piece.a) != point_is_a) m->omega = Vec3::Zero();
    }
    const Body mesh({moving::mesh(
        {moving::randomVec(random, size), moving::randomVec(random, size), moving::randomVec(random, size)},
        {{0, 1, 2}})});
    const Vec3 centre = spins ? Vec3(Vec3::Zero()) : moving::randomVec(random, size);
    const Body point({moving::placed(geometry::Sphere{random.chance(0.5) ? 0.0 : size}, centre)});
    const Body &a = point_is_a ? point : mesh, &b = point_is_a ? mesh : point;
    const auto path = StraightPath::of(a, b, piece, 0.0);
    if (!path) continue;  // neither moves past the other
    const double duration = path->duration(), t = random.chance(0.2) ? duration : random.in(0, duration);
    const IntervalPath of_point(point_is_a ? piece.a : piece.b, piece.start_ns),
        of_mesh(point_is_a ? piece.b : piece.a, piece.start_ns);
    const I3 exact = plus(minus(of_point.position(t), of_mesh.position(t)),
                          of_point.rotated(of_point.turn(t), interval3(centre)));
    const I3 computed = of_mesh.rotated(of_mesh.turn(t), interval3(path->at(t)));
    const double off = upper(lengthOf(minus(computed, exact)));
    worst = std::max(worst, off / path->error());
    ASSERT_LE(off, path->error());
    // solver.md: brackets are stated in the pair's budget, so a larger one of its own would widen them.
    const double share = path->pointError() / PairPiece(a, b, piece, 0.0).point_error;
    largest_share = std::max(largest_share, share);
    ASSERT_LE(share, 1.0 + 1e-12);
  }
  std::printf("largest share used %.3f; largest budget %.3f of the pair's\n", worst, largest_share);
}

TEST(RoundingBudget, TheMotionsThatPosesMeanAreWithinItToo) {
  // Positions: the line, or the cubic, through the poses as they were told. Orientations: the slerp arc
  // between the two quaternions plus k whole turns, at constant rate. Whatever rounding made of coefficients
  // and rate is in the budget.
  double worst_d = 0, worst_r[2] = {0, 0};
  for (int i = 0; i < 4000; ++i) {
    Random random(kSeed + 1, i);
    SCOPED_TRACE("seed " + std::to_string(kSeed + 1) + " index " + std::to_string(i));
    const Vec3 world = moving::randomVec(random, random.decade(0, 8));
    const auto span = static_cast<motion::Nanoseconds>(random.decade(3, 9.5));
    const double h = 1e-9 * static_cast<double>(span);
    const Vec3 common = moving::randomVec(random, random.chance(0.3) ? 0.0 : random.decade(0, 4.5));
    const bool cubic = random.chance(0.5), several = random.chance(0.5);
    motion::StampedPose from[2], to[2];
    RigidMotion m[2];
    int turns[2] = {0, 0};
    for (int k = 0; k < 2; ++k) {
      from[k].stamp_ns = 1'700'000'000'000'000'000 - (random.chance(0.5) ? 0 : random.below(1000));
      to[k].stamp_ns = from[k].stamp_ns + span;
      from[k].has_twist = to[k].has_twist = true;
      from[k].pose.position = world + moving::randomVec(random, random.decade(-3, 2));
      to[k].pose.position =
          from[k].pose.position + h * common + moving::randomVec(random, random.decade(-6, 2));
      const Vec3 own = moving::randomVec(random, random.decade(-6, 2) / h);
      from[k].linear = common + own;
      to[k].linear = common + moving::randomVec(random, random.decade(-6, 2) / h);
      from[k].pose.orientation = random.orientation();
      const double angle = random.decade(-12, 0.4);
      const Vec3 about = random.direction();
      to[k].pose.orientation =
          (geometry::Quat(Eigen::AngleAxisd(angle, about)) * from[k].pose.orientation).normalized();
      if (several) turns[k] = random.below(1061) - 530;
      from[k].angular = to[k].angular = (angle + 6.283185307179586 * turns[k]) / h * about;
      m[k] = cubic ? hermite(from[k], to[k]) : several ? spin(from[k], to[k]) : straightSlerp(from[k], to[k]);
      if (cubic) turns[k] = 0;
    }
    const motion::Nanoseconds start = std::max(from[0].stamp_ns, from[1].stamp_ns);
    const motion::Nanoseconds end = std::min(to[0].stamp_ns, to[1].stamp_ns);
    if (end <= start) continue;
    const motion::RelativeMotion relative(m[0], m[1], start, end);
    const double t = random.chance(0.2) ? relative.duration() : random.in(0, relative.duration());
    I3 position[2];
    for (int k = 0; k < 2; ++k) {
      using Model = oracle::StampedMotion::Model;
      const oracle::StampedMotion motion(from[k], to[k],
                                         cubic     ? Model::kCubic
                                         : several ? Model::kTurns
                                                   : Model::kLine);
      const auto c = motion.positionFrom(start);
      position[k] = plus(c[0], times(t, plus(c[1], times(t, plus(c[2], times(t, c[3]))))));
      const Vec3 y = random.direction();
      const I3 exact = motion.rotated(start, t, interval3(y));
      const Mat3 r = k == 0 ? relative.rotationA(t) : relative.rotationB(t);
      I3 computed;
      for (int row = 0; row < 3; ++row)
        computed[static_cast<std::size_t>(row)] = dotOf(interval3(Vec3(r.row(row))), interval3(y));
      const double error = k == 0 ? relative.rotationErrorA() : relative.rotationErrorB();
      const double off = upper(lengthOf(minus(computed, exact))) / (error * y.norm());
      worst_r[several && !cubic] = std::max(worst_r[several && !cubic], off);
      EXPECT_LE(off, 1.0) << "turns " << turns[k];
    }
    const double off =
        upper(lengthOf(minus(interval3(relative.displacement(t)), minus(position[1], position[0]))));
    worst_d = std::max(worst_d, off / relative.translationError());
    EXPECT_LE(off, relative.translationError()) << (cubic ? "cubic" : "line");
    if (HasFailure()) return;
  }
  std::printf("largest share used: displacement %.3f, slerp %.3f, several turns %.3f\n", worst_d, worst_r[0],
              worst_r[1]);
}

}  // namespace
}  // namespace collision_node::impact

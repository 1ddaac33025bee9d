/// docs/solver.md, "The gap model": at every time in between, the three numbers stay below the exact gap,
/// with nothing but the remainder and the budget of a point and of its rate subtracted. In 240 bits, and for
/// axes whose remainder is as small as it can be while the bodies turn far: there rounding is all that is
/// left.
#include <gtest/gtest.h>

#include <cstdio>

#include "collision_node/impact/convex/gap_model.h"
#include "test/impact/exact_sweep.h"

namespace collision_node::impact {
namespace {

using exact::Random;
using exact::upper;
using oracle::I3;
using oracle::Interval;
using oracle::interval3;
using oracle::IntervalPath;

constexpr std::uint64_t kSeed = 20261126;

/// Exact max over the core of n . (R x), at an instant.
Interval supportAlong(const Element& e, const IntervalPath& path, const IntervalPath::Turn& turn,
                      const I3& n) {
  I3 u;
  for (int k = 0; k < 3; ++k)
    u[static_cast<std::size_t>(k)] = dotOf(path.rotated(turn, interval3(Vec3(Vec3::Unit(k)))), n);
  return exact::supportOf(e, u);
}

/// Along a body's spin, or nearly; with the rate at which the third derivative vanishes; turning with the
/// body; slowly enough for a remainder of about the budget's size.
Axis axisOfLittleRemainder(Random& random, const Vec3& omega, double s) {
  Axis axis;
  axis.valid = true;
  const double spin = omega.norm();
  Vec3 along = spin > 0.0 && random.chance(0.8) ? Vec3(omega / spin) : Vec3(random.direction());
  if (random.chance(0.6)) along += random.decade(-17, -3) * random.direction();
  axis.direction = random.chance(0.5) ? along : Vec3(along.normalized());
  const Vec3 turning = omega.cross(axis.direction);
  switch (random.below(4)) {
    case 0:
      axis.rate.setZero();
      break;
    case 1:
      axis.rate = turning / 3.0;
      break;
    case 2:
      axis.rate = turning;
      break;
    default:
      axis.rate = turning / 3.0 + random.decade(-17, -3) / s * random.direction();
  }
  return axis;
}

TEST(GapRemainder, RoundingNeedsNothingBeyondTheBudgetHoweverFarABodyTurns) {
  double worst = 0.0;
  int tight = 0;
  for (int i = 0; i < 3000; ++i) {
    Random random(kSeed, i);
    SCOPED_TRACE("seed " + std::to_string(kSeed) + " index " + std::to_string(i));
    const double size = random.decade(-3, 3);
    const Body a({exact::bodyOf(random, size)}), b({exact::bodyOf(random, size * random.decade(-6, 0.5))});
    Piece piece = exact::sweep(random, size);
    motion::RigidMotion& turner = random.chance(0.5) ? piece.a : piece.b;
    if (turner.fixed) continue;
    // One body turns far: up to a million radians in the piece; half of the others do not turn at all.
    const double seconds = motion::secondsBetween(piece.start_ns, piece.end_ns);
    turner.omega = random.decade(-1, 6) / seconds * random.direction();
    motion::RigidMotion& other = &turner == &piece.a ? piece.b : piece.a;
    if (random.chance(0.5)) other.omega.setZero();
    const PairPiece pair(a, b, piece, 0.0);
    const IntervalPath path_a(piece.a, piece.start_ns), path_b(piece.b, piece.start_ns);
    const double duration = pair.motion.duration();
    const double t = random.chance(0.5) ? 0.0 : random.in(0, duration);
    const double end = (duration - t) * random.decade(-6, 0);
    if (!(end > 0.0)) continue;
    Vec3 buffer_a[3], buffer_b[3];
    const Element ea = a.element(0, buffer_a), eb = b.element(0, buffer_b);
    const Instant now = pair.at(t);
    const Axis axis = axisOfLittleRemainder(random, turner.omega, end);
    const GapModel::Bounds bounds = GapModel(pair, now, CorePair(ea, eb), axis).until(end);
    for (const double x : {0.0, 0.3, 0.7, 1.0}) {
      const double y = 1.0 - x,
                   bound = y * y * bounds.first + 2.0 * x * y * bounds.middle + x * x * bounds.last;
      // Of the sum itself, which only tests form.
      const double own =
          8.0 * kUnit * (std::abs(bounds.first) + std::abs(bounds.middle) + std::abs(bounds.last));
      const Interval s = Interval(x) * Interval(end), then = Interval(t) + s;
      const I3 n = plus(interval3(axis.direction), times(s, interval3(axis.rate)));
      const Interval gap = dotOf(n, minus(path_b.position(then), path_a.position(then))) -
                           supportAlong(eb, path_b, path_b.turn(then), times(-1, n)) -
                           supportAlong(ea, path_a, path_a.turn(then), n) -
                           (Interval(ea.radius) + Interval(eb.radius)) * lengthOf(n);
      const double length = axis.direction.norm() + x * end * axis.rate.norm();
      const double budget = length * (pair.point_error + x * end * pair.rate_error);
      const double above = upper(Interval(bound) - gap);
      // Would the bound without its budget be wrong? By which share of it?
      worst = std::max(worst, (above + budget) / budget);
      tight += x == 1.0 && above > -3.0 * budget;
      ASSERT_LE(above, own) << "x " << x << " turned by " << x * end * turner.omega.norm() << " of "
                            << seconds * turner.omega.norm();
    }
  }
  std::printf("largest share used %.3f; %d bounds within three budgets\n", worst, tight);
  EXPECT_GT(tight, 500) << "remainders hide what rounding does";
}

}  // namespace
}  // namespace collision_node::impact

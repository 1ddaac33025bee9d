#include "test/impact/fuzz_truth.h"

namespace fuzz {

using oracle::Pair;
using oracle::Real;
using oracle::V3;

Real angleBetween(const V3& a, const V3& b) { return std::atan2(norm(cross(a, b)), dot(a, b)); }

namespace {

void describeContact(const Pair& pair, Truth& truth) {
  const oracle::FirstTouch& touch = truth.first;
  const auto near = pair.within(touch.lo, 1e-10L * pair.scale());
  if (near.empty()) return;
  truth.point = 0.5L * (near[0].gap.a + near[0].gap.b);
  Real spread = 0;
  for (const auto& n : near) {
    spread = std::max({spread, norm(n.gap.a - truth.point), norm(n.gap.b - truth.point)});
  }
  truth.point_known = spread <= 1e-9L * pair.scale();

  // The direction between the parts while they are still a hair apart, at several widths of that hair.
  const bool round = pair.hasTwoCylinders();
  const Real before = (round ? 1e-5L : 1e-8L) * pair.scale() / std::max(pair.maxSpeed(), 1e-300L);
  Real drift = 0;
  for (Real factor : {1.0L, 10.0L, 1e-3L}) {
    if (round && factor < 1) continue;  // their nearest points are too rough there
    const Real t = touch.lo - factor * before;
    if (t < 0) return;
    const oracle::Gap gap = pair.partGapAt(touch.part_a, touch.part_b, t);
    if (!(gap.upper > 0)) return;
    const V3 normal = (1 / norm(gap.b - gap.a)) * (gap.b - gap.a);
    if (factor == 1) truth.normal = normal, truth.normal_spread = 1e-9L, drift = norm(gap.a - truth.point);
    truth.normal_spread += 3 * angleBetween(truth.normal, normal);
  }
  truth.normal_known = truth.normal_spread < 1e-3L;
  truth.point_sharp = truth.point_known && truth.normal_known && !round && drift < 1e-5L * pair.scale();
  const oracle::Frame fa = pair.pathA().at(touch.lo), fb = pair.pathB().at(touch.lo);
  truth.closing_speed = -dot(fb.velocityAt(truth.point) - fa.velocityAt(truth.point), truth.normal);
}

}  // namespace

Truth truthOf(const Case& c, const Pair& pair) {
  Truth truth;
  truth.budget = 1e-12L * pair.scale();
  const Real start = pair.distance(0);
  truth.overlaps_at_start = start == 0;
  truth.apart_at_start = pair.provedDistance(0) > truth.budget;
  if (!truth.apart_at_start) return truth;

  Real smaller = std::min(pair.a().reach, pair.b().reach);
  if (smaller == 0) smaller = pair.size();
  const Real margin = std::max(1e-6L * smaller, 1e3L * truth.budget);
  const oracle::FirstTouch near = pair.firstTouch(0, pair.duration(), margin, kMarchSteps);
  truth.well_apart = !near.found && !near.gave_up;
  if (truth.well_apart) return truth;
  truth.first = pair.firstTouch(near.lo, pair.duration(), 0, kMarchSteps);
  if (!truth.first.found || !truth.first.verified || truth.first.part_a < 0) return truth;

  describeContact(pair, truth);
  const Real v = truth.closing_speed;
  if (!truth.normal_known || !(v > 0)) return truth;
  truth.width = std::max<Real>(c.options.time_precision, 8 * truth.budget / v);
  const bool steep = v * v >= 100 * pair.maxAcceleration() * truth.budget && v >= 1e-6L * pair.maxSpeed();
  const bool inner = truth.first.lo > truth.width && truth.first.hi + 2 * truth.width < pair.duration();
  const bool lasts = pair.crossesInNoTime() || (inner && pair.touching(truth.first.hi + truth.width));
  const bool two_points = pair.a().only_points && pair.b().only_points;  // meet only by rounding
  truth.transversal = steep && inner && lasts && !two_points;
  return truth;
}

}  // namespace fuzz

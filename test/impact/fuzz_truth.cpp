#include "test/impact/fuzz_truth.h"

namespace fuzz {

using oracle::Pair;
using oracle::Real;
using oracle::V3;

Real angleBetween(const V3& a, const V3& b) { return std::atan2(norm(cross(a, b)), dot(a, b)); }

namespace {

void describeContact(const Pair& pair, Truth& truth) {
  const oracle::FirstTouch& touch = truth.first;
  const Real smaller = pair.smaller();
  const oracle::Frame fa = pair.pathA().at(touch.lo), fb = pair.pathB().at(touch.lo);
  const auto near = pair.within(touch.lo, std::max(1e-10L * smaller, 20 * pair.touchDistance()));
  if (near.empty()) return;
  truth.point = 0.5L * (near[0].gap.a + near[0].gap.b);
  for (const auto& n : near) {
    truth.point_spread =
        std::max({truth.point_spread, norm(n.gap.a - truth.point), norm(n.gap.b - truth.point)});
  }
  const V3 local = truth.point;
  truth.point = local + fa.position;
  truth.point_known = truth.point_spread <= 1e-6L * smaller;

  // The direction between the parts while they are still a hair apart, at several widths of that hair.
  const bool round = pair.hasTwoCylinders();
  const Real hair = std::max((round ? 1e-5L : 1e-8L) * smaller, 1e6L * pair.touchDistance());
  const Real before = hair / std::max(pair.maxSpeed(), 1e-300L);
  Real drift = 0, hair_gap = 0;
  for (Real factor : {1.0L, 10.0L, 1e-3L}) {
    if (round && factor < 1) continue;  // their nearest points are too rough there
    const Real t = touch.lo - factor * before;
    if (t < 0) return;
    const oracle::Gap gap = pair.partGapAt(touch.part_a, touch.part_b, t);
    if (!(gap.upper > 0)) return;
    const V3 normal = (1 / norm(gap.b - gap.a)) * (gap.b - gap.a);
    if (factor == 1)
      truth.normal = normal, truth.normal_spread = 1e-9L, drift = norm(gap.a - local), hair_gap = gap.upper;
    truth.normal_spread += 3 * angleBetween(truth.normal, normal);
  }
  truth.normal_known = truth.normal_spread < 1e-3L;
  truth.point_sharp = truth.point_known && truth.normal_known && !round && drift < 1e-5L * smaller;
  truth.closing_speed = -dot(fb.velocityAt(truth.point) - fa.velocityAt(truth.point), truth.normal);
  // Along the touch's own normal the gap closes with that speed. Else other features come first in the end,
  // within the hair, which is a wide one for cylinders.
  constexpr Real kSame = 1e-3L;
  if (round && !(std::abs(truth.closing_speed * before - hair_gap) <= kSame * hair_gap))
    truth.normal_known = truth.point_sharp = false;
}

/// Whether the first contact outlives b's being held back by 1e3 budget; for a point through a surface, which
/// touches for no time: being put aside by as much.
bool getsDeep(const Pair& pair, const Truth& truth) {
  const Real depth = 1e3L * truth.budget, moment = depth / truth.closing_speed;
  if (pair.crossesInNoTime()) {
    const V3 other = std::abs(truth.normal.x) < 0.6L ? V3{1, 0, 0} : V3{0, 1, 0};
    const V3 u = cross(truth.normal, other), w = cross(truth.normal, u);
    const Real from = std::max<Real>(0, truth.first.lo - 10 * moment);
    const Real to = std::min(pair.duration(), truth.first.hi + 10 * moment);
    for (const V3& side : {u, -u, w, -w}) {
      const oracle::FirstTouch touch = pair.shifted(depth / norm(side) * side).firstTouch(from, to, 0, 20000);
      if (!touch.found || !touch.verified) return false;
    }
    return true;
  }
  const Pair held_back = pair.shifted(depth * truth.normal);
  for (Real wait = 1.5L; wait < 1e7L; wait *= 3) {
    const Real t = truth.first.hi + wait * moment;
    if (t > pair.duration() || !pair.touching(t)) return false;  // over; a later contact may be deep
    if (held_back.touching(t)) return true;
  }
  return false;
}

bool overlapsDeeply(const Pair& pair, Real depth) {
  for (const V3& way : {V3{1, 0, 0}, V3{-1, 0, 0}, V3{0, 1, 0}, V3{0, -1, 0}, V3{0, 0, 1}, V3{0, 0, -1}}) {
    if (!pair.shifted(depth * way).touching(0)) return false;
  }
  return true;
}

}  // namespace

Truth truthOf(const Case& c, const Pair& pair) {
  Truth truth;
  truth.budget = c.budget();
  const Real start = pair.distance(0);
  truth.overlaps_at_start = start == 0;
  truth.overlaps_deeply = truth.overlaps_at_start && overlapsDeeply(pair, 1e3L * truth.budget);
  truth.apart_at_start = pair.provedDistance(0) > truth.budget;
  if (!truth.apart_at_start) return truth;

  const oracle::FirstTouch near = pair.firstTouch(0, pair.duration(), 1e3L * truth.budget, kMarchSteps);
  truth.well_apart = !near.found && !near.gave_up;
  if (truth.well_apart) return truth;
  truth.first = near.gave_up ? near : pair.firstTouch(near.lo, pair.duration(), 0, kMarchSteps);
  if (!truth.first.found || !truth.first.verified || truth.first.part_a < 0) return truth;

  describeContact(pair, truth);
  const Real v = truth.closing_speed;
  // What spins fast has a speed along a normal that is a little off, however slowly it comes.
  const bool speed_known = v > 2 * pair.maxSpeed() * truth.normal_spread;
  if (!truth.normal_known || !speed_known || !(v > 0)) return truth;
  truth.width = std::max<Real>(c.options.time_precision, 8 * truth.budget / v);
  const bool inner = truth.first.lo > truth.width && truth.first.hi + 2 * truth.width < pair.duration();
  const bool two_points = pair.a().only_points && pair.b().only_points;  // meet only by rounding
  truth.transversal =
      v * pair.duration() >= 1e6L * truth.budget && inner && !two_points && getsDeep(pair, truth);
  return truth;
}

}  // namespace fuzz

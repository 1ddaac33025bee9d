#include "collision_node/report/truth/marched_truth.h"

#include <algorithm>
#include <queue>
#include <tuple>

#include "collision_node/geometry/body.h"
#include "collision_node/report/truth/ball_tree.h"
#include "test/oracle/pair.h"

namespace collision_node::report {
namespace {

using oracle::Gap;
using oracle::Pair;
using oracle::Real;
using oracle::V3;

/// Two models, their trees, and the pair that moves them.
struct March {
  const BallTree& tree_a;
  const BallTree& tree_b;
  const Pair& pair;
  oracle::Path near_a, near_b;  ///< without what a's origin does
  Real origin_speed;
  V3 origin;  ///< world, left out of all paths

  Real spheres(const oracle::Frame& fa, const oracle::Frame& fb, int i, int j) const {
    const Ball &a = tree_a.balls[i], &b = tree_b.balls[j];
    return norm(fb.place(b.centre) - fa.place(a.centre)) - a.radius - b.radius;
  }
  Real speed(int i, int j) const {
    const Real spins = near_a.spin() * tree_a.balls[i].reach + near_b.spin() * tree_b.balls[j].reach;
    return (origin_speed + spins) * (1 + 1e-12L);
  }
};

struct Clock {
  Real t;
  int i, j;  ///< balls of the two trees
};
struct Later {
  bool operator()(const Clock& x, const Clock& y) const {
    return std::tie(x.t, x.i, x.j) > std::tie(y.t, y.i, y.j);
  }
};

/// Every two balls that are nearest in time are moved on by what their distance grants, or opened. What is
/// found is never late: all others are apart until then.
oracle::FirstTouch firstTouch(const March& march, std::int64_t max_steps) {
  oracle::FirstTouch out;
  std::priority_queue<Clock, std::vector<Clock>, Later> queue;
  queue.push({0, 0, 0});
  const Real end = march.pair.duration(), slack = 4e-18L * march.pair.scale();
  oracle::Frame fa = march.near_a.at(0), fb = march.near_b.at(0);
  for (Real at = 0; !queue.empty();) {
    const Clock clock = queue.top();
    queue.pop();
    if (--max_steps < 0) {
      out.gave_up = true, out.lo = clock.t;
      return out;
    }
    if (clock.t != at) fa = march.near_a.at(clock.t), fb = march.near_b.at(clock.t), at = clock.t;
    const Ball &a = march.tree_a.balls[clock.i], &b = march.tree_b.balls[clock.j];
    Real free = march.spheres(fa, fb, clock.i, clock.j);
    if (a.isLeaf() && b.isLeaf()) {
      if (free < a.radius + b.radius || free < 1e-3L * march.pair.scale()) {
        const Gap gap = oracle::partGap(oracle::placed(march.pair.a().parts[a.part], fa),
                                        oracle::placed(march.pair.b().parts[b.part], fb), 0.1L);
        free = gap.lower;
        if (free <= march.pair.marchEnd()) {
          out.found = true, out.lo = out.hi = clock.t, out.part_a = a.part, out.part_b = b.part;
          return out;
        }
      }
    } else if (free < 0.03L * (a.radius + b.radius)) {
      const bool open_a = b.isLeaf() || (!a.isLeaf() && a.radius >= b.radius);
      for (const int child : {open_a ? a.left : b.left, open_a ? a.right : b.right}) {
        queue.push({clock.t, open_a ? child : clock.i, open_a ? clock.j : child});
      }
      continue;
    }
    // At their own speed; or, whatever turning does to them about their origins, at the origins'.
    const Real v = march.speed(clock.i, clock.j);
    if (!(v > 0)) continue;  // both rest: apart for ever
    const Real origins = norm(fb.position - fa.position) - a.reach - b.reach - slack;
    Real step = (free - slack) / v;
    if (march.origin_speed > 0) step = std::max(step, origins / march.origin_speed);
    if (clock.t + step <= end) queue.push({clock.t + step, clock.i, clock.j});
  }
  return out;
}

/// Parts that are at most `limit` apart at one instant.
std::vector<Gap> within(const March& march, Real t, Real limit) {
  const oracle::Frame fa = march.near_a.at(t), fb = march.near_b.at(t);
  std::vector<Gap> gaps;
  std::vector<std::pair<int, int>> stack = {{0, 0}};
  while (!stack.empty()) {
    const auto [i, j] = stack.back();
    stack.pop_back();
    if (march.spheres(fa, fb, i, j) > limit) continue;
    const Ball &a = march.tree_a.balls[i], &b = march.tree_b.balls[j];
    if (a.isLeaf() && b.isLeaf()) {
      const Gap gap = oracle::partGap(oracle::placed(march.pair.a().parts[a.part], fa),
                                      oracle::placed(march.pair.b().parts[b.part], fb));
      if (gap.upper <= limit) gaps.push_back(gap);
    } else if (b.isLeaf() || (!a.isLeaf() && a.radius >= b.radius)) {
      stack.push_back({a.left, j}), stack.push_back({a.right, j});
    } else {
      stack.push_back({i, b.left}), stack.push_back({i, b.right});
    }
  }
  return gaps;
}

/// An instant of contact at or just behind touch.lo, or none.
bool findContact(const Pair& pair, oracle::FirstTouch& touch) {
  const auto touches = [&](Real t) {
    return pair.partGapAt(touch.part_a, touch.part_b, t).upper <= pair.touchDistance();
  };
  if (touches(touch.lo)) return true;
  const Real far = 1e-7L * pair.duration();
  Real before = touch.lo;
  for (Real step = 1e-19L * pair.duration(); step < far && touch.lo + step <= pair.duration(); step *= 1.5L) {
    Real after = touch.lo + step;
    if (!touches(after)) {
      before = after;
      continue;
    }
    for (int k = 0; k < 80; ++k) {
      const Real middle = (before + after) / 2;
      (touches(middle) ? after : before) = middle;
    }
    touch.hi = after;
    return true;
  }
  return false;
}

/// Fills in the point where there is one: nearby parts name it too, and it was there a moment before.
void describePoint(const March& march, const oracle::FirstTouch& touch, Real moment, Truth& truth) {
  const Pair& pair = march.pair;
  const Real limit = std::max(1e-10L * pair.smaller(), 20 * pair.touchDistance());
  const std::vector<Gap> gaps = within(march, touch.lo, limit);
  if (gaps.empty()) return;
  const V3 here = 0.5L * (gaps[0].a + gaps[0].b);
  Real spread = 0;
  for (const Gap& gap : gaps) spread = std::max({spread, norm(gap.a - here), norm(gap.b - here)});
  const Gap earlier = pair.partGapAt(touch.part_a, touch.part_b, touch.lo - moment);
  if (spread > 1e-6L * pair.smaller() || norm(earlier.a - here) > 1e-4L * pair.smaller()) return;
  const oracle::Frame frame = pair.pathA().at(touch.lo);
  const V3 world = here + frame.position + march.origin;
  truth.point = {static_cast<double>(world.x), static_cast<double>(world.y), static_cast<double>(world.z)};
  const Real moved = (pair.maxSpeed() + norm(frame.velocity)) * truth.toi_error;
  truth.point_error =
      static_cast<double>(spread + moved + 4 * pair.touchDistance()) + 4e-16 * truth.point.norm();
}

Truth truthOf(const March& march, std::int64_t max_steps) {
  const Pair& pair = march.pair;
  Truth truth;
  oracle::FirstTouch touch = firstTouch(march, max_steps);
  const auto inside = [](const oracle::Model& outer, const oracle::Path& at, const oracle::Model& inner,
                         const oracle::Path& by) {
    return Pair::anyInside(outer, at.at(0), inner, by.at(0));
  };
  const bool starts_inside = inside(pair.a(), march.near_a, pair.b(), march.near_b) ||
                             inside(pair.b(), march.near_b, pair.a(), march.near_a);
  if (starts_inside || (touch.found && touch.lo == 0)) {
    truth.verdict = Verdict::kHit, truth.toi = 0.0, truth.toi_error = 0.0;
    return truth;
  }
  if (touch.gave_up) return truth;
  if (!touch.found) {
    truth.verdict = Verdict::kClear;
    return truth;
  }
  const Real moment = std::min(touch.lo, 1e-8L * pair.smaller() / pair.maxSpeed());
  if (!findContact(pair, touch)) return truth;
  const Real closing = pair.partGapAt(touch.part_a, touch.part_b, touch.lo - moment).lower / moment;
  if (!(closing > 0)) return truth;
  truth.verdict = Verdict::kHit;
  truth.toi = static_cast<double>((touch.lo + touch.hi) / 2);
  truth.toi_error =
      static_cast<double>((touch.hi - touch.lo) / 2 + 2 * pair.marchEnd() / closing) + 0x1p-53 * truth.toi;
  describePoint(march, touch, moment, truth);
  return truth;
}

}  // namespace

std::vector<Truth> marchedTruths(const QuerySet& set, std::int64_t max_steps) {
  std::vector<oracle::Model> models;
  for (const auto& body : set.bodies) models.push_back(oracle::makeModel(body->shapes()));
  std::vector<BallTree> trees;
  for (const oracle::Model& model : models) trees.emplace_back(model.parts);
  std::vector<Truth> truths;
  for (const Query& query : set.queries) {
    const impact::Piece& piece = query.piece;
    const V3 origin = oracle::exact(piece.a.c[0]);
    const oracle::Path a(piece.a, piece.start_ns, origin), b(piece.b, piece.start_ns, origin);
    const Real duration = static_cast<Real>(piece.end_ns - piece.start_ns) / 1e9L;
    const Pair pair(models[query.a], models[query.b], a, b, duration);
    truths.push_back(truthOf({trees[query.a], trees[query.b], pair, a.relativeTo(a), b.relativeTo(a),
                              oracle::speedBound(a, b, duration), origin},
                             max_steps));
  }
  return truths;
}

}  // namespace collision_node::report

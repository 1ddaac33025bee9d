#include "collision_node/report/stability/promise.h"

#include <algorithm>
#include <map>

#include "collision_node/report/methods/peer_models.h"

namespace collision_node::report {
namespace {

/// What closes as fast as `Group::closing` says may need so much longer: that is an average.
constexpr double kSlower = 2.0;

/// Method by name. Paper B's time is that at which the particle enters the bounding sphere: early by design.
/// Bullet stops at a gap of 1 mm, and its iteration and FCL's may stop a few percent of the piece early;
/// FCL's shape advancement takes a hundred-thousandth of the piece for none.
const std::map<std::string, Promise>& promises() {
  static const std::map<std::string, Promise> all = {
      {"paper A", {}},
      {"paper B", {0.0, 0.0, 0.0, 1.0}},
      {"subdivision 1000", {0.0, 0.0, 1e-3, 0.0}},
      {"4D intersection, 1000 samples", {0.0, 0.0, 1e-3, 0.0}},
      {"FCL naive 1000", {0.0, 0.0, 1e-3, 0.0}},
      {"fcl::distance advancement, 1e-5 m", {1e-5, 0.0, 0.0, 0.0}},
      {"FCL shape advancement", {1e-6, 1e-5, 1e-3, 0.05}},
      {"Bullet convexSweepTest", {1e-3, 0.0, 1e-3, 0.05}},
      {"btContinuousConvexCollision", {1e-3, 0.0, 1e-3, 0.05}},
      {"Embree ray", {0.0, 0.0, 1e-5, 1e-5}},
  };
  return all;
}

/// The paper's methods are stated for a particle B and an A that does not turn; method A for straight paths.
ContestantPtr forParticles(const Method& method, const QuerySet& set) {
  const bool straight = method.family != "paper A" || translates(set);
  const auto holds = [](const Query& query) { return query.piece.a.omega.isZero(0.0); };
  if (!only<geometry::Point>(*set.bodies[1]) || !straight || !all(set, holds)) return nullptr;
  return method.make(set);
}

/// How far a point of one body moves past one of the other, at most [m].
double pathOf(const QuerySet& set, const Query& query) {
  const impact::Piece& piece = query.piece;
  const double speed = (piece.b.c[1] - piece.a.c[1]).norm() +
                       piece.a.omega.norm() * set.bodies[query.a]->reach() +
                       piece.b.omega.norm() * set.bodies[query.b]->reach();
  return speed * durationOf(piece);
}

Mark markOfCertified(const Answer& answer, const Truth& truth) {
  if (truth.verdict == Verdict::kClear) {
    return answer.verdict == Verdict::kHit     ? Mark::kFalse
           : answer.verdict == Verdict::kClear ? Mark::kKept
                                               : Mark::kUndecided;
  }
  if (answer.verdict == Verdict::kClear) return Mark::kMissed;
  if (answer.toi_lower > truth.toi + truth.toi_error) return Mark::kLate;
  if (answer.verdict == Verdict::kUndecided) return Mark::kUndecided;
  if (!(answer.toi_upper >= truth.toi - truth.toi_error)) return Mark::kEarly;
  if (!truth.point.allFinite()) return Mark::kKept;
  const double off = (answer.point - truth.point).norm();
  return off <= answer.position_error + truth.point_error ? Mark::kKept : Mark::kBound;
}

}  // namespace

std::vector<Walker> allWalkers() {
  std::vector<Walker> walkers;
  walkers.push_back(
      {{"ours", "ours", "anything", "", true, [](const QuerySet& set) { return makeOurs(set); }}, {}});
  for (Method& method : allMethods()) {
    const auto promise = promises().find(method.name);
    if (promise == promises().end() || !method.installed) continue;
    if (method.family.rfind("paper", 0) == 0) {
      const Method as_printed = method;
      method.make = [as_printed](const QuerySet& set) { return forParticles(as_printed, set); };
    }
    walkers.push_back({std::move(method), promise->second});
  }
  return walkers;
}

Mark markOf(const Answer& answer, const Group& group, std::size_t trial, const Promise& promise) {
  const Truth& truth = group.trials.truths[trial];
  const Query& query = group.trials.set.queries[trial];
  if (answer.certified) return markOfCertified(answer, truth);
  const double gap = std::max(promise.gap, promise.path_gap * pathOf(group.trials.set, query));
  if (answer.verdict == Verdict::kUndecided) return Mark::kUndecided;
  if (truth.verdict == Verdict::kClear) {
    if (answer.verdict == Verdict::kClear) return Mark::kKept;
    return group.nearest[trial] <= gap ? Mark::kUndecided : Mark::kFalse;
  }
  if (answer.verdict == Verdict::kClear) return Mark::kMissed;
  const double duration = durationOf(query.piece);
  const double gap_time = gap > 0.0 ? kSlower * gap / group.closing[trial] : 0.0;
  if (answer.toi_lower > truth.toi + promise.late * duration + kPrecision) return Mark::kLate;
  if (answer.toi_lower < truth.toi - promise.early * duration - gap_time - kPrecision) return Mark::kEarly;
  return Mark::kKept;
}

}  // namespace collision_node::report

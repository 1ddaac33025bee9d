#include "collision_node/report/stability/promise.h"

#include <algorithm>
#include <map>

#include "collision_node/report/peer_models.h"

namespace collision_node::report {
namespace {

/// What an oblique approach makes of a gap, at most, beside head on.
constexpr double kOblique = 2.0;

Mark markOfCertified(const Answer& answer, const Truth& truth) {
  if (truth.verdict == Verdict::kClear) {
    return answer.verdict == Verdict::kHit ? Mark::kFalse
           : answer.verdict == Verdict::kClear ? Mark::kKept : Mark::kUndecided;
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

Promise promiseOf(const Method& method) {
  static const std::map<std::string, Promise> kPromises = {
      {"ours", {Course::kAccelerated, 0.0, 0.0, 0.0}},
      {"fcl::distance advancement", {Course::kManyTurns, 1e-5, 0.0, 0.0}},
      {"FCL sampling", {Course::kTurning, 0.0, 1e-3, 0.0}},
      {"FCL advancement", {Course::kTurning, 0.0, 1e-3, 0.05}},
      {"Embree ray", {Course::kStraight, 0.0, 1e-6, 1e-6}},
      {"Bullet sweep", {Course::kStraight, 0.0, 1e-3, 0.05}},
  };
  const auto found = kPromises.find(method.family);
  return found == kPromises.end() ? Promise{Course::kAccelerated, 0.0, 0.0, 0.0} : found->second;
}

Mark markOf(const Answer& answer, const Group& group, std::size_t trial, const Promise& promise) {
  const Truth& truth = group.trials.truths[trial];
  if (answer.certified) return markOfCertified(answer, truth);
  if (answer.verdict == Verdict::kUndecided) return Mark::kUndecided;
  if (truth.verdict == Verdict::kClear) {
    if (answer.verdict == Verdict::kClear) return Mark::kKept;
    return group.nearest[trial] <= promise.gap ? Mark::kUndecided : Mark::kFalse;
  }
  if (answer.verdict == Verdict::kClear) return Mark::kMissed;
  const double duration = durationOf(group.trials.set.queries[trial].piece);
  const double gap_time = promise.gap > 0.0 ? kOblique * promise.gap / group.closing[trial] : 0.0;
  if (answer.toi_lower > truth.toi + promise.late * duration + kPrecision) return Mark::kLate;
  if (answer.toi_lower < truth.toi - promise.early * duration - gap_time - kPrecision) return Mark::kEarly;
  return Mark::kKept;
}

}  // namespace collision_node::report

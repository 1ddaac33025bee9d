#include "collision_node/report/comparison.h"

#include <algorithm>
#include <cmath>

namespace collision_node::report {
namespace {

void addLate(Faults& side, double by, double allowed) {
  if (by > allowed) ++side.late;
  if (by > allowed) side.worst_late = std::max(side.worst_late, by);
}

}  // namespace

Comparison compare(const std::vector<Answer>& ours, const std::vector<Answer>& reference, double precision,
                   double gap, double rounding) {
  Comparison result;
  for (std::size_t i = 0; i < ours.size(); ++i) {
    const Answer& a = ours[i];
    if (a.verdict == Verdict::kHit) ++result.hits;
    if (a.verdict == Verdict::kUndecided) ++result.ours.undecided;
    if (i >= reference.size()) continue;
    const Answer& b = reference[i];
    if (b.verdict == Verdict::kUndecided) ++result.reference.undecided;
    if (a.verdict == Verdict::kUndecided || b.verdict == Verdict::kUndecided) continue;
    const bool here = a.verdict == Verdict::kHit, there = b.verdict == Verdict::kHit;
    if (there && !here) ++result.ours.missed, ++result.reference.false_hits;
    if (here && !there) ++result.ours.false_hits, ++result.reference.missed;
    if (!here || !there) continue;
    result.worst_error = std::max(result.worst_error, std::abs(a.toi_lower - b.toi_lower));
    const double early = gap > 0.0 ? 2.0 * gap / std::max(a.closing_speed, 1e-300) : 0.0;
    addLate(result.ours, a.toi_lower - b.toi_upper, precision + early + rounding);
    addLate(result.reference, b.toi_lower - a.toi_upper, precision);
  }
  return result;
}

}  // namespace collision_node::report

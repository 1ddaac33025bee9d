/// Contact that is too shallow to be proved for a while: faces that slide flush on each other, a vertex that
/// all but leaves. Nobody can prove that nothing parts by less than the rounding; what can be proved is that
/// nothing parts by more than kFlush budgets for longer than a bracket's width, or where it does.
#include <algorithm>

#include "collision_node/impact/piece_run.h"

namespace collision_node::impact {

/// The pair touches at a contact distance that is wider by kFlush budgets, and is followed like any contact
/// (of a tube, or a turn told badly, by 8, else the true motion might be far away). Where that ends, the gap
/// is wide enough to be proved: clearance is looked for at instants that grow up to a bracket's width.
PieceRun::Stretch PieceRun::between(double from, double to) {
  if (!(to - from > longest_gap_)) return {Stretch::kClose};
  constexpr double kUntold = 8.0, kShareOfBudget = 0.25;
  const double more = kUntold * pair_.untold + kFlush * std::max(0.0, pair_.point_error - pair_.untold);
  const PairPiece wider(pair_.a, pair_.b, pair_.motion, pair_.contact_distance + more, pair_.tube);
  PairOptions options = options_;
  options.node_budget -= std::min(options.node_budget, search_.nodeTests());
  options.node_budget = static_cast<std::uint64_t>(kShareOfBudget * static_cast<double>(options.node_budget));
  PairState state;
  std::vector<PairEvent> no_events;
  PieceRun grown(wider, piece_, options, workspace_.buffers().forFlush(), state, no_events);

  const auto stretch = [&]() -> Stretch {
    ContactWitness witness;
    double t = from, look = 0.0;
    while (t < to) {
      if (grown.search_.exhausted() || search_.exhausted()) return {Stretch::kUnknown};
      const double at = std::min(to, t + look);
      double reached = t;
      if (grown.search_.classify(at, &witness, to - at) == Proved::kContact) {
        reached = at;
        grown.persist(reached, witness, to);
      } else if (search_.classify(at, &witness) == Proved::kApart) {
        const Search::First next = search_.firstPossible(at, end_, width_);
        if (!next.found || next.time - t > longest_gap_) return {Stretch::kApart, at};
        reached = next.time;
      }
      look = reached > t ? 0.0 : std::max(floor_, look * kGrow);
      t = std::max(t, reached);
      if (look > longest_gap_) return {Stretch::kUnknown};
    }
    return {Stretch::kClose};
  }();
  search_.countTests(grown.search_.nodeTests());
  return stretch;
}

void PieceRun::contactAfterUnknown(double at, const ContactWitness& witness) {
  publishSeparation(at, false);
  beginOverlap(at, witness);
}

}  // namespace collision_node::impact

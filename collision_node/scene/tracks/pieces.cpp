#include "collision_node/scene/tracks/pieces.h"

#include <algorithm>

namespace collision_node::scene {

namespace {

using What = Reach::What;

/// True when what the track does from `index` on is over by `ns`.
bool isOver(const Reach& reach, Nanoseconds ns) {
  return reach.what == What::kBreak || (reach.what != What::kWait && reach.until_ns <= ns);
}

/// At rest until a known end that has come: the run breaks there.
bool breaksAt(const Reach& reach, Nanoseconds ns) {
  return reach.what == What::kBreak || (reach.what == What::kStill && reach.until_ns <= ns);
}

motion::RigidMotion motionOf(const Track& track, std::size_t index, const Reach& reach) {
  return reach.what == What::kMoves ? *reach.motion : track.restAt(index);
}

/// What the track did right before `ns`, in the segment that begins with `index` or ends with it; nothing
/// when its run begins there.
std::optional<Reach> reachBefore(const Track& track, std::size_t index, Nanoseconds ns) {
  if (track.stamp(index) < ns) return track.reach(index);
  if (track.isFixed() || track.sample(index).join != Join::kJoined) return std::nullopt;
  Reach reach;
  reach.doubt = track.sample(index).segment.doubt;
  reach.error = track.sample(index).segment.error;
  return reach;
}

Trust trustOf(const Reach& a, const Reach& b) { return {worseDoubt(a.doubt, b.doubt), a.error, b.error}; }

}  // namespace

void PieceCursor::restart(const Track& a, const Track& b) {
  *this = PieceCursor();
  a_ = a.firstIndex();
  b_ = b.firstIndex();
}

/// Moves both sides up to the first instant that both tracks know and go on from.
bool PieceCursor::findStart(const Track& a, const Track& b) {
  for (;;) {
    if (!a.has(a_) || !b.has(b_)) return false;
    const Nanoseconds start = std::max({a.stamp(a_), b.stamp(b_), at_ns_});
    const Reach reach_a = a.reach(a_);
    const Reach reach_b = b.reach(b_);
    const bool a_over = isOver(reach_a, start);
    const bool b_over = isOver(reach_b, start);
    if (!a_over && !b_over) {
      if (reach_a.what == What::kWait || reach_b.what == What::kWait) return false;
      begun_ = is_first_ = true;
      at_ns_ = start;
      return true;
    }
    const bool a_moves = a_over && !a.isFixed() && a.has(a_ + 1);
    const bool b_moves = b_over && !b.isFixed() && b.has(b_ + 1);
    if (a_moves) ++a_;
    if (b_moves) ++b_;
    if (!a_moves && !b_moves) return false;
  }
}

Step PieceCursor::next(const Track& a, const Track& b, Nanoseconds rest_known_ns) {
  Step step;
  if (!begun_ && !findStart(a, b)) return step;
  const Reach reach_a = a.reach(a_);
  const Reach reach_b = b.reach(b_);
  const bool a_breaks = breaksAt(reach_a, at_ns_);
  const bool b_breaks = breaksAt(reach_b, at_ns_);
  if (a_breaks || b_breaks) {
    begun_ = false;
    step.what = Step::What::kBreak;
    step.a_broke = a_breaks;
    step.b_broke = b_breaks;
    step.reason = a_breaks ? reach_a.reason : reach_b.reason;
    return step;
  }
  if (reach_a.what == What::kWait || reach_b.what == What::kWait) return step;
  Nanoseconds end = std::min(reach_a.until_ns, reach_b.until_ns);
  if (end == std::numeric_limits<Nanoseconds>::max()) {
    // A silent object rests beside another for as long as anybody knows: whether they touch is asked once, on
    // the shortest piece there is.
    if (!is_first_ || !(reach_a.guess_of_rest || reach_b.guess_of_rest)) return step;
    end = at_ns_ + 1;
  }
  if ((reach_a.guess_of_rest || reach_b.guess_of_rest) && end > rest_known_ns) return step;

  step.what = Step::What::kPiece;
  step.trust = trustOf(reach_a, reach_b);
  if (is_first_) {
    const std::optional<Reach> before_a = reachBefore(a, a_, at_ns_), before_b = reachBefore(b, b_, at_ns_);
    if (before_a && before_b) step.skipped = trustOf(*before_a, *before_b);
  }
  step.piece = {at_ns_, end, motionOf(a, a_, reach_a), motionOf(b, b_, reach_b)};
  at_ns_ = end;
  is_first_ = false;
  if (reach_a.what == What::kMoves && reach_a.until_ns == end) ++a_;
  if (reach_b.what == What::kMoves && reach_b.until_ns == end) ++b_;
  return step;
}

void PieceCursor::jumpTo(std::size_t index_a, std::size_t index_b) {
  a_ = index_a;
  b_ = index_b;
  begun_ = false;
}

void PieceCursor::skipTo(const Track& a, const Track& b, Nanoseconds ns) {
  if (begun_) return;
  while (!a.isFixed() && a.has(a_ + 1) && a.stamp(a_ + 1) <= ns) ++a_;
  while (!b.isFixed() && b.has(b_ + 1) && b.stamp(b_ + 1) <= ns) ++b_;
}

}  // namespace collision_node::scene

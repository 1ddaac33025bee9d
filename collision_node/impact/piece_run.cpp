/// Brackets: how one opens, what is proved behind its start, and what is published of it.
#include "collision_node/impact/piece_run.h"

#include <algorithm>
#include <cmath>

namespace collision_node::impact {
namespace {

using Phase = PairState::Phase;

}  // namespace

PieceRun::PieceRun(const PairPiece& pair, const Piece& piece, const PairOptions& options,
                   Workspace& workspace, PairState& state, std::vector<PairEvent>& events)
    : pair_(pair),
      piece_(piece),
      options_(options),
      workspace_(workspace),
      search_(pair, options.node_budget, workspace,
              StraightPath::of(pair.a, pair.b, piece, pair.contact_distance)),
      writer_(pair, piece, options, search_, workspace),
      state_(state),
      events_(events),
      end_(pair.motion.duration()) {
  const Widths widths(options, pair.point_error, pair.speed, end_);
  floor_ = widths.floor;
  width_ = widths.wanted;
  longest_gap_ = std::max(width_, kBracket * floor_);
  const Widths sharp(options, std::max(0.0, pair.point_error - pair.tube), pair.speed, end_);
  least_rest_ = std::max(sharp.wanted, kBracket * sharp.floor);  // a tube may be as wide as the contact lasts
  is_parting_ = state.phase == Phase::kUndecided && state.was_touching;
}

PieceOutcome PieceRun::run() {
  const std::size_t before = events_.size();
  const bool begins_open = state_.phase == Phase::kUndecided && state_.published;
  PieceOutcome outcome;
  if (search_.withinReach().empty()) {
    outcome.answer = Answer::kCulled;
    if (state_.phase == Phase::kNew) state_.phase = Phase::kApart;
    if (state_.phase == Phase::kApart) return outcome;
  }
  double t = 0.0;
  if (state_.phase == Phase::kNew) {
    start();
  } else if (state_.phase != Phase::kApart) {
    state_.pending_speed = std::max(state_.pending_speed, pair_.any_speed);
    state_.pending_spin = std::max(state_.pending_spin, pair_.motion.spinA() + pair_.motion.spinB());
  }
  while (true) {
    if (options_.scope == Scope::kFirstContact && events_.size() > before) break;
    if (search_.exhausted()) {
      stopForBudget(t);
      break;
    }
    if (state_.phase == Phase::kApart) {
      if (t >= end_) break;  // just proved
      const Search::First first = search_.firstPossible(t, end_, width_, kWindow * width_);
      if (!first.found) break;
      free_since_ = t;
      open(Kind::kImpact, first.time, first.pair);
      t = first.time;
    } else if (state_.phase == Phase::kUndecided && !state_.was_touching) {
      if (!resolve(t)) break;
    } else {
      if (!follow(t)) break;
    }
  }
  outcome.node_tests = search_.nodeTests();
  outcome.subdivisions = search_.subdivisions();
  outcome.budget_met = search_.exhausted();
  outcome.answer = state_.phase == Phase::kUndecided                             ? Answer::kUndecided
                   : state_.phase == Phase::kTouching || events_.size() > before ? Answer::kImpact
                                                                                 : Answer::kClear;
  for (std::size_t i = before; i < events_.size(); ++i) {
    if (events_[i].certificate == Certificate::kPossible) outcome.answer = Answer::kUndecided;
  }
  if (begins_open) outcome.answer = Answer::kUndecided;  // up to the instant at which something was proved
  return outcome;
}

void PieceRun::start() {
  if (search_.withinReach().low > 0.0) {
    state_.phase = Phase::kApart;
    return;
  }
  ContactWitness witness;
  switch (search_.classify(0.0, &witness, end_)) {
    case Proved::kApart:
      state_.phase = Phase::kApart;
      return;
    case Proved::kContact:
      beginOverlap(0.0, witness);
      witness_ = std::move(witness);
      return;
    case Proved::kNothing:
      open(Kind::kInitialOverlap, 0.0, writer_.anyNear(0.0, 0.0));
      return;
  }
}

void PieceRun::beginOverlap(double t, const ContactWitness& witness) {
  const Instant now = search_.at(t);
  PairEvent event = writer_.stamped(Kind::kInitialOverlap, now);
  writer_.fill(event, describeOverlap(pair_, now, witness), t, t);
  event.certificate = Certificate::kConfirmed;
  event.reason = Reason::kNone;
  events_.push_back(event);
  state_.phase = Phase::kTouching;
  state_.contact = event;
}

void PieceRun::open(Kind kind, double t, ElementPair pair) {
  state_.phase = Phase::kUndecided;
  state_.was_touching = kind == Kind::kSeparation;
  state_.published = false;
  state_.pending = writer_.stamped(kind, search_.at(t));
  state_.pending_speed = pair_.any_speed;
  state_.pending_spin = pair_.motion.spinA() + pair_.motion.spinB();
  opened_ = pair;
}

bool PieceRun::resolve(double& t) {
  const bool carried = state_.pending.interval_start_ns != piece_.start_ns;
  const PathContact* met = carried ? nullptr : search_.provedAt(t);
  if (met != nullptr && closeStraight(*met)) {
    t = met->upper;
    return true;
  }
  // Of a carried bracket something may be decided at once.
  Onset onset{t, t, carried ? floor_ : 0.5 * width_, carried, carried, false};
  ContactWitness found;
  while (!search_.exhausted()) {
    const double at = std::min(end_, onset.from + onset.step);
    const Proved proved = lookAt(at, found);
    if (proved == Proved::kContact) {
      t = soonestContact(onset.from, onset.nothing, at, found);
      confirm(onset.from, t, found);
      return true;
    }
    if (proved == Proved::kApart && onset.from < end_) {
      if (closesApart(onset, at, found, t)) return true;
      continue;
    }
    if (at >= end_) {
      waitForMore();
      return false;
    }
    onset.nothing = at;
    onset.step *= kGrow;
  }
  return true;
}

Proved PieceRun::lookAt(double at, ContactWitness& found) {
  // Most often the pair that could not be proved apart is the one that touches.
  Proved proved = Proved::kNothing;
  if (opened_.a >= 0) proved = search_.classifyPair(at, opened_, &found);
  if (proved != Proved::kContact) proved = search_.classify(at, &found, end_);
  if (proved == Proved::kNothing && search_.holdsHidden(at, &found)) proved = Proved::kContact;
  return proved;
}

bool PieceRun::closesApart(Onset& onset, double at, ContactWitness& found, double& t) {
  const double from = onset.from;
  if (passed(from, at, t)) return true;
  if (!onset.small && floor_ < 0.5 * onset.step) {  // too far at once: look into what was skipped
    onset.small = true;
    const bool goes_on = from - free_end_ <= width_;  // the bracket before this one was free, too
    onset.bold = goes_on && free_step_ > 0.0;
    onset.step = onset.bold ? std::min(kBolder * free_step_, onset.step) : floor_;
    return false;
  }
  if (state_.published) {  // until now nobody knows: since when?
    const Stretch stretch = between(from, at);
    if (stretch.kind == Stretch::kApart && stretch.apart < at) {
      publishPossible(stretch.apart);
      state_.phase = Phase::kApart;
      t = stretch.apart;
      return true;
    }
  }
  if (inBetween(onset.nothing, at, found)) {
    confirm(from, found_at_, found);
    t = found_at_;
    return true;
  }
  if (search_.provesApart(from, at) && !onset.carried) {  // a second look proves the bracket free
    state_.phase = Phase::kApart;
    free_step_ = at - from;
    free_end_ = t = at;
    return true;
  }
  if (onset.bold) {  // too bold
    onset.bold = false;
    onset.step = floor_;
    return false;
  }
  const Search::First next = search_.firstPossible(at, end_, width_);
  if (next.found && next.time < end_ && belongsTogether(from, at, next)) {
    onset.step = std::max(next.time - from, onset.step * kGrow);
    onset.nothing = next.time;
    return false;
  }
  publishPossible(at);
  state_.phase = Phase::kApart;
  t = at;
  return true;
}

bool PieceRun::belongsTogether(double from, double at, const Search::First& next) {
  if (next.time - at <= std::max(at - from, width_)) return true;
  // Of a slow approach the last budgets before the contact take longer, and their start may be free by a
  // hair.
  const double closing = search_.closingSpeed(next);
  return closing > 0.0 && (next.time - from) * closing <= kBelongs * pair_.point_error;
}

double PieceRun::soonestContact(double from, double nothing, double at, ContactWitness& found) {
  for (int i = 0; i < kHalvings && at - from > options_.time_precision && found.element_a >= 0; ++i) {
    const double middle = 0.5 * (nothing + at);
    if (!(middle > nothing && middle < at)) break;
    ContactWitness sooner;
    if (search_.classifyPair(middle, {found.element_a, found.element_b}, &sooner) == Proved::kContact) {
      at = middle;
      found = std::move(sooner);
    } else {
      nothing = middle;
    }
  }
  return at;
}

void PieceRun::waitForMore() {
  const bool carried = state_.pending.interval_start_ns != piece_.start_ns;
  if (carried && !state_.published) giveUp();
}

void PieceRun::confirm(double from, double at, const ContactWitness& found) {
  if (options_.scope == Scope::kWholePiece) witness_ = found;
  if (state_.published) {  // the onset is an open question already published: what is proved is contact, here
    beginOverlap(at, found);
    return;
  }
  ElementPair pair{found.element_a, found.element_b};
  const bool sure_of_pair = pair.a >= 0;
  if (!sure_of_pair) pair = opened_.a >= 0 ? opened_ : writer_.anyNear(from, at);
  events_.push_back(state_.pending);
  PairEvent& event = events_.back();
  event.kind = Kind::kImpact;
  writer_.finishImpact(event, from, at, pair, state_, sure_of_pair);
  event.certificate = Certificate::kConfirmed;
  event.reason =
      event.toi_upper - event.toi_lower > options_.time_precision ? Reason::kPrecision : Reason::kNone;
  if (options_.scope == Scope::kWholePiece) state_.contact = event;
  state_.phase = Phase::kTouching;
}

bool PieceRun::inBetween(double low, double high, ContactWitness& found) {
  constexpr int kLooks = 7;
  for (int i = 1; i <= kLooks; ++i) {
    const double at = low + (high - low) * i / (kLooks + 1);
    if (at <= low || at >= high) continue;
    if (search_.classify(at, &found, end_) == Proved::kContact) {
      found_at_ = at;
      return true;
    }
  }
  return false;
}

void PieceRun::publishPossible(double at) {
  if (state_.was_touching) {
    publishSeparation(at, false);
    return;
  }
  if (state_.published) {  // up to an earlier piece's end; what is open of this one is another bracket
    if (!(at > least_rest_)) return;
    open(Kind::kImpact, 0.0, {});
  }
  PairEvent event = state_.pending;
  const double from = std::max(0.0, writer_.localStart(event));
  const ElementPair pair = opened_.a >= 0 ? opened_ : writer_.anyNear(from, at);
  writer_.finishImpact(event, from, at, pair, state_, opened_.a >= 0);
  event.certificate = Certificate::kPossible;
  event.reason = search_.exhausted() ? Reason::kBudget : Reason::kGrazing;
  events_.push_back(event);
}

void PieceRun::stopForBudget(double t) {
  if (state_.phase == Phase::kApart) open(Kind::kImpact, t, {});
  if (state_.phase == Phase::kTouching) openSeparation(t);
  if (state_.pending.kind == Kind::kInitialOverlap) state_.pending.kind = Kind::kImpact;  // all of it is open
  if (!state_.published) giveUp();
}

void PieceRun::giveUp() {
  publishPossible(end_);
  state_.phase = Phase::kUndecided;
  state_.was_touching = false;
  state_.published = true;
}
}  // namespace collision_node::impact

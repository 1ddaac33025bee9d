/// A contact from its proof to its end: followed as long as it can be proved, then parted, or an open
/// question.
#include <algorithm>

#include "collision_node/impact/piece_run.h"

namespace collision_node::impact {
namespace {

using Phase = PairState::Phase;

}  // namespace

double PieceRun::soonestApart(double contact, double nothing, double at) {
  ContactWitness witness;
  for (int i = 0; i < kHalvings && at - contact > options_.time_precision; ++i) {
    const double middle = 0.5 * (nothing + at);
    if (!(middle > nothing && middle < at)) break;
    const bool apart =
        search_.classify(middle, &witness) == Proved::kApart && search_.provesApart(middle, at);
    (apart ? at : nothing) = middle;
  }
  return at;
}

std::optional<double> PieceRun::lastContact(double contact, double apart, ContactWitness& found) {
  for (double back = width_; apart - back > contact + width_ && !search_.exhausted(); back *= 2.0) {
    if (search_.classify(apart - back, &found, back) == Proved::kContact) return apart - back;
  }
  return std::nullopt;
}

bool PieceRun::part(double proved, double nothing, double apart, double& t) {
  t = soonestApart(proved, nothing, apart);
  ContactWitness found;
  if (const auto last = lastContact(proved, t, found)) {
    t = *last;
    witness_ = std::move(found);
    return false;
  }
  openSeparation(proved);
  publishSeparation(t);
  return true;
}

bool PieceRun::endedBefore(double t) {
  ContactWitness found;
  const Proved now = search_.classify(t, &found, end_);
  if (now == Proved::kContact) witness_ = std::move(found);
  if (now != Proved::kApart) return false;
  openSeparation(t);
  publishSeparation(t);
  return true;
}

bool PieceRun::follow(double& t) {
  if (!witness_ && endedBefore(t)) return true;
  double look = floor_;
  double proved = t;   // contact is proved up to here
  double nothing = t;  // the last instant at which nothing was
  while (t < end_ || witness_) {
    if (search_.exhausted()) {  // all since the last proof is one open question
      t = proved;
      witness_.reset();
      return true;
    }
    if (witness_) {
      const Stretch since = between(proved, t);
      if (search_.exhausted()) continue;
      if (since.kind == Stretch::kApart) {
        witness_.reset();
        if (part(proved, proved, since.apart, t)) return true;
        continue;
      }
      holdOn(since, proved, t);
      proved = nothing = t;
      look = floor_;
      if (t >= end_) break;
    }
    const double at = std::min(end_, proved + look);
    ContactWitness found;
    const Proved now = search_.classify(at, &found, end_ - at);
    if (now == Proved::kContact) {
      t = at;
      witness_ = std::move(found);
      continue;
    }
    if (now == Proved::kApart) {
      const Search::First next = search_.firstPossible(at, end_, width_);
      if (!next.found || next.time - at > width_) {  // a separation is owed; and not before?
        const Stretch since = between(proved, at);
        if (search_.exhausted()) continue;
        const bool sooner = since.kind == Stretch::kApart && since.apart < at;
        if (part(proved, sooner ? proved : nothing, sooner ? since.apart : at, t)) return true;
        continue;
      }
      look = std::max(next.time - proved, look * kGrow);
    } else {
      nothing = at;
      look *= kGrow;
    }
    if (at < end_) continue;
    const Stretch since = between(proved, end_);
    if (since.kind != Stretch::kApart) {
      leaveOpen(since, proved);
      return false;
    }
    if (part(proved, proved, since.apart, t)) return true;
  }
  if (is_parting_) return false;
  openSeparation(proved);  // where the next piece would begin to look
  state_.phase = Phase::kTouching;
  return false;
}

void PieceRun::holdOn(const Stretch& since, double proved, double& t) {
  if (since.kind == Stretch::kUnknown) {
    openSeparation(proved);
    contactAfterUnknown(t, *witness_);
  }
  is_parting_ = false;
  persist(t, *witness_, end_);
  last_contact_ = {witness_->element_a, witness_->element_b};
  witness_.reset();
}

void PieceRun::leaveOpen(const Stretch& since, double proved) {
  openSeparation(proved);
  if (since.kind == Stretch::kUnknown) {
    giveUp();
    return;
  }
  state_.phase = Phase::kUndecided;
  waitForMore();
}

void PieceRun::persist(double& t, ContactWitness& witness, double until) {
  if (witness.element_a < 0) {  // one body inside the other: until surfaces can meet
    const Search::First first = search_.firstPossible(t, until, width_);
    t = first.found ? std::max(t, first.time) : until;
    return;
  }
  Vec3 buffer_a[3], buffer_b[3];
  const Element a = pair_.a.element(witness.element_a, buffer_a),
                b = pair_.b.element(witness.element_b, buffer_b);
  constexpr double kOfGuess = 0.9, kLeastShare = 0x1p-5, kMostShare = 0.5;  // of a step that was too long
  double step = until - t;
  Instant now = pair_.at(t);
  // Cores without a radius touch or do not: points a few budgets apart tell as much as closer ones.
  const bool has_radius = a.radius + b.radius + pair_.contact_distance > 0.0;
  const GoodEnough enough{has_radius ? 0.0 : 8.0 * pair_.point_error};
  const auto renew = [&](double from_depth) {
    ContactWitness fresh;
    fresh.shrunk = from_depth;
    const Closest closest = closestPoints(Cores(now, a, b), Vec3::Zero(), enough);
    if (!(has_radius && touchesDeep(pair_, now, a, b, closest, fresh)) &&
        !touchesAt(pair_, now, a, b, closest, fresh))
      return;
    fresh.element_a = witness.element_a;
    fresh.element_b = witness.element_b;
    witness = std::move(fresh);
  };
  if (witness.momentary) {
    renew(std::numeric_limits<double>::infinity());
    if (witness.momentary) return;
  } else if (witness.rounded) {
    renew(witness.shrunk > 0.0 ? std::numeric_limits<double>::infinity() : 0.0);
  }
  bool is_new = true;  // no other proof of this instant may last longer
  while (t < until && !search_.exhausted()) {
    const double next = std::min(until, t + step);
    const Instant later = pair_.at(next);
    search_.countTests(1);
    double share = kMostShare;
    if (next > t && touchesThrough(pair_, now, later, a, b, witness, share)) {
      t = next;
      now = later;
      step *= 2.0;
      is_new = false;
    } else if (!is_new) {
      renew(witness.shrunk);
      is_new = true;
    } else {
      step *= std::clamp(kOfGuess * share, kLeastShare, kMostShare);
      if (step < floor_) return;
    }
  }
}

void PieceRun::openSeparation(double t) {
  if (is_parting_) return;
  const PairEvent contact = state_.contact;
  open(Kind::kSeparation, t, last_contact_);
  state_.contact = contact;
}

void PieceRun::publishSeparation(double at, bool apart) {
  PairEvent event = state_.pending;
  const double from = std::max(0.0, writer_.localStart(event));
  ElementPair pair = opened_;
  if (pair.a < 0) pair = writer_.anyNear(from, at);
  writer_.finishSeparation(event, from, at, pair, state_, opened_.a >= 0);
  const bool sure = apart && state_.contact.certificate == Certificate::kConfirmed;
  event.certificate = sure ? Certificate::kConfirmed : Certificate::kPossible;
  event.reason = search_.exhausted()                                           ? Reason::kBudget
                 : !sure                                                       ? Reason::kGrazing
                 : event.toi_upper - event.toi_lower > options_.time_precision ? Reason::kPrecision
                                                                               : Reason::kNone;
  events_.push_back(event);
  state_.phase = Phase::kApart;
  state_.was_touching = false;
}
}  // namespace collision_node::impact

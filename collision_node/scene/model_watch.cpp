#include "collision_node/scene/model_watch.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "collision_node/motion/seconds_from.h"

namespace collision_node::scene {

namespace {

using Phase = impact::PairState::Phase;

constexpr double kNoBound = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kUp = 1.0 + 1e-12;

double originSpeed(const motion::RigidMotion& motion) {
  if (motion.fixed) return 0.0;
  const double h = motion::secondsBetween(motion.start_ns, motion.end_ns);
  return (motion.c[1].norm() + 2.0 * h * motion.c[2].norm() + 3.0 * h * h * motion.c[3].norm()) * kUp;
}

/// Of any point of the body. NaN: no bound.
double tubeOf(const motion::ModelError& error, double reach) {
  return error.angle == 0.0 ? error.position : error.position + error.angle * reach;
}

}  // namespace

double ModelWatch::tubeOn(const Trust& trust) const {
  return (tubeOf(trust.error_a, reach_a_) + tubeOf(trust.error_b, reach_b_)) * kUp;
}

bool ModelWatch::canRunOn(const Trust& trust) const {
  return method_.knowsTubes() && (trust.error_a.asked || trust.error_b.asked) &&
         std::isfinite(tubeOn(trust)) && trust.doubt == impact::Reason::kNone;
}

void ModelWatch::skip(const Trust& trust) {
  startOver();
  if (!canRunOn(trust)) return;
  state_ = std::make_unique<impact::PairState>();
  state_->phase = Phase::kApart;
}

impact::PieceOutcome ModelWatch::advance(const Step& step) {
  if (!canRunOn(step.trust)) {
    interrupt();
    return {};
  }
  impact::Piece piece = step.piece;
  piece.tube = tubeOn(step.trust);
  if (!isUndecided()) speed_a_ = speed_b_ = error_a_ = error_b_ = tube_ = 0.0;
  speed_a_ = std::max(speed_a_, originSpeed(piece.a));
  speed_b_ = std::max(speed_b_, originSpeed(piece.b));
  error_a_ = std::max(error_a_, step.trust.error_a.position);
  error_b_ = std::max(error_b_, step.trust.error_b.position);
  tube_ = std::max(tube_, piece.tube);
  if (!state_) state_ = std::make_unique<impact::PairState>();
  std::vector<impact::PairEvent> events;
  const impact::PieceOutcome outcome = method_.advance(piece, *state_, events);
  take(events);
  return outcome;
}

void ModelWatch::finish() {
  if (!state_) return;
  std::vector<impact::PairEvent> events;
  method_.finish(*state_, events);
  take(events);
}

void ModelWatch::interrupt() {
  if (!state_) return;
  finish();
  state_.reset();
  if (!approaches_.empty()) approaches_.back().has_ended = true;
}

void ModelWatch::startOver() {
  state_.reset();
  approaches_.clear();
  contacts_.clear();
}

void ModelWatch::take(const std::vector<impact::PairEvent>& events) {
  for (const impact::PairEvent& event : events) {
    const bool goes_on = !approaches_.empty() && !approaches_.back().has_ended;
    if (event.kind == impact::Kind::kSeparation) {
      if (goes_on) approaches_.back().has_ended = event.certificate != impact::Certificate::kPossible;
      continue;
    }
    const bool confirmed = event.certificate == impact::Certificate::kConfirmed;
    const Instant upper = instantAt(event.interval_start_ns, event.toi_upper);
    if (goes_on && approaches_.back().has_given_up) {
      // The question that was left open goes on, and may now be answered: a contact, by now.
      Approach& last = approaches_.back();
      if (confirmed && !last.confirmed) {
        last.confirmed = true;
        last.upper = upper;
        last.event.toi_upper = motion::secondsFrom(last.event.interval_start_ns, event.interval_start_ns,
                                                   event.toi_upper, kInfinity);
        last.ball = kNoBound;
      }
      continue;
    }
    if (goes_on) approaches_.back().has_ended = true;
    Approach approach;
    approach.event = event;
    approach.lower = instantAt(event.interval_start_ns, event.toi_lower);
    approach.upper = upper;
    approach.confirmed = confirmed;
    approach.ball = event.kind == impact::Kind::kImpact ? ballOf(event) : kNoBound;
    approaches_.push_back(approach);
  }
  if (approaches_.empty()) return;
  Approach& last = approaches_.back();
  if (state_->phase == Phase::kApart) last.has_ended = true;
  if (isUndecided() && state_->published) last.has_given_up = true;
}

/// Where a true contact in the bracket can be: on either body, and the solver's own ball if it holds all that
/// may touch.
double ModelWatch::ballOf(const impact::PairEvent& event) const {
  const double width = event.toi_upper - event.toi_lower;
  const double round_a =
      (event.position - event.a.pose.position).norm() + reach_a_ + width * speed_a_ + error_a_;
  const double round_b =
      (event.position - event.b.pose.position).norm() + reach_b_ + width * speed_b_ + error_b_;
  const double of_features = event.multiple ? kInfinity : event.position_error + tube_;
  return std::min(std::min(round_a, round_b) + contact_distance_, of_features) * kUp;
}

void ModelWatch::note(const impact::PairEvent& event) {
  const Instant lower = instantAt(event.interval_start_ns, event.toi_lower);
  const Instant upper = instantAt(event.interval_start_ns, event.toi_upper);
  if (event.kind == impact::Kind::kSeparation) {
    if (contacts_.empty() || contacts_.back().to) {
      contacts_.push_back({lower, upper});
    } else {
      contacts_.back().to = upper;
    }
  } else if (event.certificate == impact::Certificate::kPossible) {
    contacts_.push_back({lower, upper});
  } else {
    contacts_.push_back({lower, std::nullopt});
  }
}

std::optional<ModelWatch::Answer> ModelWatch::answer(const impact::PairEvent& event) const {
  Answer answer{kNoBound, kNoBound, kNoBound};
  const Instant lower = instantAt(event.interval_start_ns, event.toi_lower);
  const Instant upper = instantAt(event.interval_start_ns, event.toi_upper);
  if (openSince() && !(upper < *openSince())) return std::nullopt;
  const Approach* last = nullptr;
  for (const Approach& approach : approaches_)
    if (!(upper < approach.lower)) last = &approach;
  const bool reaches =
      last && (last->confirmed || last->has_given_up || !last->has_ended || !(last->upper < lower));
  if (!reaches) return answer;
  const double begin = motion::secondsFrom(event.interval_start_ns, last->event.interval_start_ns,
                                           last->event.toi_lower, -kInfinity);
  answer.toi_lower = std::min(begin, event.toi_lower);
  if (last->upper < lower) return answer;  // the approach began with an earlier impact
  const bool is_closed = last->confirmed || (last->has_ended && !last->has_given_up);
  if (last->confirmed) {
    const double end = motion::secondsFrom(event.interval_start_ns, last->event.interval_start_ns,
                                           last->event.toi_upper, kInfinity);
    answer.toi_upper = std::max(end, event.toi_upper);
  }
  if (is_closed) answer.position_error = (last->ball + (last->event.position - event.position).norm()) * kUp;
  return answer;
}

std::vector<impact::PairEvent> ModelWatch::takeNearMisses() {
  std::vector<impact::PairEvent> out;
  for (Approach& approach : approaches_) {
    if (approach.is_told || !(approach.has_ended || approach.has_given_up)) continue;
    approach.is_told = true;
    const bool is_known = std::any_of(contacts_.begin(), contacts_.end(), [&](const Contact& contact) {
      return !(approach.upper < contact.from) && !(contact.to && *contact.to < approach.lower);
    });
    if (approach.confirmed || is_known) continue;
    out.push_back(approach.event);
    if (!std::isnan(approach.ball)) out.back().position_error = approach.ball;
  }
  return out;
}

std::optional<Instant> ModelWatch::openSince() const {
  if (!isUndecided() || state_->published || state_->was_touching) return std::nullopt;
  return instantAt(state_->pending.interval_start_ns, state_->pending.toi_lower);
}

void ModelWatch::forgetEnded() {
  approaches_.erase(std::remove_if(approaches_.begin(), approaches_.end(),
                                   [](const Approach& approach) { return approach.has_ended; }),
                    approaches_.end());
  contacts_.erase(
      std::remove_if(contacts_.begin(), contacts_.end(), [](const Contact& contact) { return contact.to; }),
      contacts_.end());
}

}  // namespace collision_node::scene

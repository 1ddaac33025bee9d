#include "collision_node/scene/pair_watch.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "collision_node/scene/zones.h"

namespace collision_node::scene {

namespace {

using Phase = impact::PairState::Phase;

/// Upper bound of the speed of any point of the link on the segment. [m/s]
double speedBound(const motion::RigidMotion& motion, const geometry::Body& body) {
  if (motion.fixed) return 0.0;
  const double h = motion::secondsBetween(motion.start_ns, motion.end_ns);
  return motion.c[1].norm() + 2.0 * h * motion.c[2].norm() + 3.0 * h * h * motion.c[3].norm() +
         motion.omega.norm() * body.reach();
}

EventSide makeSide(const Object& object, const Link& link, const impact::Side& from, const Vec3& position,
                   double ball) {
  EventSide side;
  side.object = object.name;
  side.link = link.name;
  side.shape = from.shape;
  side.feature = from.feature;
  side.triangle = from.triangle;
  side.point = link.T_o_l.inverse() * from.point;
  side.pose = from.pose * link.T_o_l;
  side.sample_before_ns = from.sample_before_ns;
  side.sample_after_ns = from.sample_after_ns;
  // Taking the ball's centre into the link's frame rounds like the coordinates it comes from.
  const double rounding = 16.0 * std::numeric_limits<double>::epsilon() *
                          (position.cwiseAbs().sum() + side.pose.position.cwiseAbs().sum());
  const ZoneAnswer zone =
      findZone(object, link.name, side.point, side.pose.inverse() * position, ball + rounding);
  side.zone = zone.name;
  side.zone_certain = zone.certain;
  return side;
}

}  // namespace

PairWatch::PairWatch(const Scene& scene, const LinkPair& pair, PairRank rank,
                     std::unique_ptr<impact::PairMethod> method)
    : scene_(scene),
      pair_(pair),
      rank_(rank),
      method_(std::move(method)),
      model_(*method_, scene.objects[pair.object_a].links[pair.link_a].body->reach(),
             scene.objects[pair.object_b].links[pair.link_b].body->reach(), pair.contact_distance) {}

void PairWatch::advance(const Step& step, Outbox& outbox, Costs& costs) {
  if (!state_) state_ = std::make_unique<impact::PairState>();
  if (step.skipped && state_->phase == Phase::kNew) {  // apart, as proved from afar
    state_->phase = Phase::kApart;
    model_.skip(*step.skipped);
  }
  std::vector<impact::PairEvent> events;
  const impact::PieceOutcome outcome = method_->advance(step.piece, *state_, events);
  const impact::PieceOutcome with_error = model_.advance(step);
  costs.node_tests += outcome.node_tests + with_error.node_tests;
  costs.subdivisions += outcome.subdivisions + with_error.subdivisions;
  if (outcome.budget_met || with_error.budget_met) ++costs.budget_met;
  // What is clear of contact as modelled, but not certainly so, is not clear.
  last_ = outcome.answer;
  const bool seems_clear = last_ == impact::Answer::kCulled || last_ == impact::Answer::kClear;
  const bool is_doubtful = model_.isUndecided() || with_error.answer == impact::Answer::kUndecided;
  const impact::Answer answer = seems_clear && is_doubtful ? impact::Answer::kUndecided : last_;
  worst_ = worst_ ? std::max(*worst_, answer) : answer;

  has_advanced_ = true;
  if (state_->phase == Phase::kApart && model_.isApart()) knows_origin_ = true;

  // An event whose bracket opened on an earlier piece carries what was wrong there too.
  const Context here = contextOf(step);
  const Context carried{worseDoubt(bracket_.doubt, here.doubt), std::max(bracket_.speed_a, here.speed_a),
                        std::max(bracket_.speed_b, here.speed_b)};
  for (const impact::PairEvent& event : events)
    publish(event, event.interval_start_ns < step.piece.start_ns ? carried : here);
  letGo(carried, outbox);
  bracket_ = state_->phase == Phase::kUndecided || model_.isUndecided() ? carried : Context();
}

void PairWatch::interrupt(impact::Reason reason, Outbox& outbox) {
  std::vector<impact::PairEvent> events;
  if (state_) method_->interrupt(*state_, reason, events);
  model_.interrupt();
  for (const impact::PairEvent& event : events) publish(event, bracket_);
  letGo(bracket_, outbox);
  forgetContact();
}

void PairWatch::finish(Outbox& outbox) {
  std::vector<impact::PairEvent> events;
  if (state_) method_->finish(*state_, events);
  model_.finish();
  for (const impact::PairEvent& event : events) publish(event, bracket_);
  letGo(bracket_, outbox);
}

void PairWatch::startOver() {
  forgetContact();
  worst_.reset();
  last_ = impact::Answer::kCulled;
}

void PairWatch::skip() {
  forgetContact();
  knows_origin_ = true;
  last_ = impact::Answer::kCulled;
  if (!worst_) worst_ = last_;
}

bool PairWatch::isQuiet() const {
  const bool is_apart = phase() == Phase::kApart || phase() == Phase::kNew;
  return is_apart && waiting_.empty() && !model_.isUndecided() && !model_.openSince();
}

bool PairWatch::isPlain() const { return isQuiet() && !contact_ && model_.isApart(); }

bool PairWatch::isSettled() const {
  return knows_origin_ || (phase() != Phase::kUndecided && model_.isApart());
}

void PairWatch::forgetContact() {
  knows_origin_ = has_advanced_;
  state_.reset();
  bracket_ = Context();
  contact_.reset();
  model_.startOver();
}

std::optional<Instant> PairWatch::openSince() const {
  std::optional<Instant> first = model_.openSince();
  const auto take = [&](const Instant& other) {
    if (!first || other < *first) first = other;
  };
  if (phase() == Phase::kUndecided && !state_->published)
    take(instantAt(state_->pending.interval_start_ns, state_->pending.toi_lower));
  if (!waiting_.empty())
    take(instantAt(waiting_.front().event.interval_start_ns, waiting_.front().event.toi_lower));
  return first;
}

impact::Answer PairWatch::worstAnswer() const {
  if (worst_) return *worst_;
  if (phase() == Phase::kTouching) return impact::Answer::kImpact;
  if (phase() == Phase::kUndecided || model_.isUndecided()) return impact::Answer::kUndecided;
  return std::min(last_, impact::Answer::kClear);
}

PairWatch::Context PairWatch::contextOf(const Step& step) const {
  const Link& a = scene_.objects[pair_.object_a].links[pair_.link_a];
  const Link& b = scene_.objects[pair_.object_b].links[pair_.link_b];
  return {step.trust.doubt, speedBound(step.piece.a, *a.body), speedBound(step.piece.b, *b.body)};
}

void PairWatch::publish(const impact::PairEvent& event, const Context& context) {
  waiting_.push_back({event, makeEvent(event, context), contactOf(event)});
  waiting_.back().event.opens_contact = contact_ == waiting_.back().contact;
  model_.note(event);
}

/// To the queue: all that need not wait for the model's error, and what the error alone makes possible.
void PairWatch::letGo(const Context& context, Outbox& outbox) {
  auto first = waiting_.begin();
  for (; first != waiting_.end(); ++first) {
    if (first->from.kind == impact::Kind::kImpact) {
      const std::optional<ModelWatch::Answer> answer = model_.answer(first->from);
      if (!answer) break;
      fillModel(first->event, *answer);
    }
    outbox.push(rank_, first->event, first->contact);
  }
  waiting_.erase(waiting_.begin(), first);
  for (const impact::PairEvent& miss : model_.takeNearMisses()) {
    Event event = makeEvent(miss, context);
    if (miss.kind == impact::Kind::kImpact) {
      if (const auto answer = model_.answer(miss)) fillModel(event, *answer);
    }
    outbox.push(rank_, event, std::make_shared<ContactNumber>());
  }
  if (waiting_.empty()) model_.forgetEnded();
}

void PairWatch::fillModel(Event& event, const ModelWatch::Answer& answer) const {
  if (event.certificate == impact::Certificate::kUncertified) return;
  event.model_toi_lower = answer.toi_lower;
  event.model_toi_upper = answer.toi_upper;
  event.model_position_error = answer.position_error;
}

Event PairWatch::makeEvent(const impact::PairEvent& from, const Context& context) const {
  constexpr double kNotAsked = std::numeric_limits<double>::quiet_NaN();
  const Object& a = scene_.objects[pair_.object_a];
  const Object& b = scene_.objects[pair_.object_b];
  Event event;
  event.stamp_ns = instantAt(from.interval_start_ns, from.toi_lower).ns;
  event.kind = from.kind;
  event.certificate = from.certificate;
  event.reason = from.reason;
  if (context.doubt != impact::Reason::kNone && from.certificate != impact::Certificate::kUncertified) {
    event.certificate = impact::Certificate::kUncertified;
    event.reason = context.doubt;
  }
  event.interval_start_ns = from.interval_start_ns;
  event.interval_end_ns = from.interval_end_ns;
  event.toi_lower = from.toi_lower;
  event.toi_upper = from.toi_upper;
  event.position = from.position;
  event.position_error = from.position_error;
  event.multiple = from.multiple;
  event.normal = from.normal;
  event.normal_error = from.normal_error;
  event.relative_velocity = from.relative_velocity;
  event.closing_speed = from.closing_speed;
  event.model_toi_lower = event.model_toi_upper = event.model_position_error = kNotAsked;
  // A link moves on while the bracket lasts: in its frame the ball grows by as much.
  const double width = from.toi_upper - from.toi_lower;
  event.a = makeSide(a, a.links[pair_.link_a], from.a, from.position,
                     from.position_error + width * context.speed_a);
  event.b = makeSide(b, b.links[pair_.link_b], from.b, from.position,
                     from.position_error + width * context.speed_b);
  // Parts of one object are in URDF order, their links need not be in that of their names.
  if (a.name == b.name && event.b.link < event.a.link) {
    std::swap(event.a, event.b);
    event.normal = -event.normal;
    event.relative_velocity = -event.relative_velocity;
  }
  return event;
}

/// A POSSIBLE impact is published alone: it neither opens a contact nor ends one. Those of a comparison
/// method have no separations.
std::shared_ptr<ContactNumber> PairWatch::contactOf(const impact::PairEvent& event) {
  if (event.kind == impact::Kind::kSeparation) {
    if (contact_) return std::exchange(contact_, nullptr);
    return std::make_shared<ContactNumber>();
  }
  auto opened = std::make_shared<ContactNumber>();
  if (event.certificate == impact::Certificate::kConfirmed) contact_ = opened;
  return opened;
}

}  // namespace collision_node::scene

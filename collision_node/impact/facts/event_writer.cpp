#include "collision_node/impact/facts/event_writer.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "collision_node/geometry/normal_cone.h"
#include "collision_node/motion/seconds_from.h"

namespace collision_node::impact {

PairEvent EventWriter::stamped(Kind kind, const Instant& now) const {
  PairEvent event;
  event.kind = kind;
  event.interval_start_ns = piece_.start_ns;
  event.interval_end_ns = piece_.end_ns;
  event.toi_lower = event.toi_upper = now.t;
  event.a.pose = pair_.motion.poseA(now.t, now.turn_a);
  event.b.pose = pair_.motion.poseB(now.t, now.turn_b);
  event.a.sample_before_ns = piece_.a.start_ns;
  event.a.sample_after_ns = piece_.a.end_ns;
  event.b.sample_before_ns = piece_.b.start_ns;
  event.b.sample_after_ns = piece_.b.end_ns;
  return event;
}

double EventWriter::localStart(const PairEvent& event) const {
  return event.toi_lower - motion::secondsBetween(event.interval_start_ns, piece_.start_ns);
}

Earlier EventWriter::earlierThan(const PairEvent& event, const PairState& state) const {
  const double seconds = std::max(0.0, -localStart(event));
  return {seconds * state.pending_speed, seconds * state.pending_spin};
}

void EventWriter::finishImpact(PairEvent& event, double lower, double upper, ElementPair pair,
                               const PairState& state, bool sure_of_pair) {
  const Piece* before =
      event.interval_start_ns < piece_.start_ns && state.last_piece.end_ns == piece_.start_ns
          ? &state.last_piece
          : nullptr;
  finish(event, {lower, upper, lower, 0.0, earlierThan(event, state), sure_of_pair, before}, pair);
}

void EventWriter::finishSeparation(PairEvent& event, double lower, double upper, ElementPair pair,
                                   const PairState& state, bool sure_of_pair) {
  finish(event,
         {lower, upper, upper, pair_.motion.duration(), earlierThan(event, state), sure_of_pair, nullptr},
         pair);
}

void EventWriter::finish(PairEvent& event, const Bracket& bracket, ElementPair pair) {
  const Instant& now = search_.at(bracket.reference);
  event.multiple = false;
  ContactFacts facts;
  if (pair.a >= 0) {
    const Proposal proposal{search_.partingAt(bracket.reference, pair),
                            search_.closestAt(bracket.reference, pair)};
    facts = describeContact(pair_, now, pair, bracket.when(), proposal, views_);
    joinNeighbours(event, facts, bracket, pair);
  } else {
    facts = describeUnknown(pair_, now, bracket.when().span);
    facts.position_error += 2.0 * bracket.earlier.distance;
  }
  if (bracket.incoming != nullptr) takeVelocities(facts, *bracket.incoming);
  fill(event, facts, bracket.reference, bracket.upper);
  // Who was near on earlier pieces is not asked.
  const bool has_others = pair_.a.elementCount() > 1 || pair_.b.elementCount() > 1;
  if (has_others && -localStart(event) > options_.time_precision) event.multiple = true;
  if (event.kind == Kind::kInitialOverlap) {  // it tells when a contact begins, not how
    event.normal = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
    event.normal_error = M_PI;
    event.closing_speed = event.normal.x();
  }
}

/// Of the material points at the contact as `incoming` ends: a cut belongs to the piece before it.
void EventWriter::takeVelocities(ContactFacts& facts, const Piece& incoming) {
  const RelativeMotion motion(incoming.a, incoming.b, incoming.start_ns, incoming.end_ns);
  const double end = motion.duration();
  facts.relative_velocity = motion.velocity(end) +
                            motion.omegaB().cross(facts.position - motion.displacement(end)) -
                            motion.omegaA().cross(facts.position);
  facts.closing_speed = -facts.relative_velocity.dot(facts.normal);
}

/// Other element pairs that may touch in the bracket, perhaps first: at the same place they widen ball and
/// cone, elsewhere they are said.
void EventWriter::joinNeighbours(PairEvent& event, ContactFacts& facts, const Bracket& bracket,
                                 ElementPair pair) {
  if (pair_.a.elementCount() == 1 && pair_.b.elementCount() == 1) return;
  constexpr std::size_t kLimit = 48;
  const Instant& now = search_.at(bracket.reference);
  const NearPairs near_pairs = search_.nearPairs(bracket.lower, bracket.upper, kLimit, pair);
  if (near_pairs.size() >= kLimit || search_.exhausted()) event.multiple = true;  // not all were looked at
  for (const ElementPair& other : near_pairs) {
    const Proposal proposal{search_.partingAt(bracket.reference, other), {}};
    const ContactFacts its = describeContact(pair_, now, other, bracket.when(), proposal, views_);
    const double needed = (its.position - facts.position).norm() + its.position_error;
    const bool same_place = needed <= std::max(2.0 * facts.position_error, 0.5 * options_.distance_precision);
    if (same_place || !bracket.sure_of_pair) {
      facts.position_error = std::max(facts.position_error, needed * (1.0 + 16.0 * kUnit));
      facts.normal_error =
          geometry::coneOfBoth(facts.normal, facts.normal_error, its.normal, its.normal_error);
    }
    if (!same_place) event.multiple = true;
  }
}

void EventWriter::fill(PairEvent& event, const ContactFacts& facts, double reference, double upper) const {
  event.toi_upper = motion::secondsFrom(event.interval_start_ns, piece_.start_ns, upper,
                                        std::numeric_limits<double>::infinity());
  event.toi_upper = std::max(event.toi_upper, event.toi_lower);
  event.position = pair_.motion.originOfA(reference) + facts.position;
  event.position_error = facts.position_error;
  event.normal = facts.normal;
  event.normal_error = facts.normal_error;
  event.relative_velocity = facts.relative_velocity;
  event.closing_speed = facts.closing_speed;
  const auto copySide = [](Side& to, const Side& from) {
    to.shape = from.shape;
    to.feature = from.feature;
    to.triangle = from.triangle;
    to.point = from.point;
  };
  copySide(event.a, facts.a);
  copySide(event.b, facts.b);
}

ElementPair EventWriter::anyNear(double from, double to) {
  const NearPairs pairs = search_.nearPairs(from, to, 1);
  return pairs.empty() ? ElementPair{} : pairs.front();
}

}  // namespace collision_node::impact

#include "collision_node/impact/straight/straight_shot.h"

#include "collision_node/impact/straight/straight_facts.h"

namespace collision_node::impact {

std::optional<PieceOutcome> shoot(const Body& a, const Body& b, const Piece& piece,
                                  const PairOptions& options, bool known_apart,
                                  std::vector<PairEvent>* events) {
  const std::optional<StraightPath> path = StraightPath::of(a, b, piece, options.contact_distance);
  if (!path || !(known_apart || path->startsOutside())) return std::nullopt;
  const Widths widths(options, path->pointError(), path->speed(), path->duration());
  PathContact contact;
  path->first(0.0, path->duration(), widths.wanted, contact);
  if (contact.tests > options.node_budget) return std::nullopt;
  PieceOutcome outcome;
  outcome.node_tests = contact.tests;
  if (contact.kind == PathContact::Kind::kClear) {
    outcome.answer = contact.tests == 0 ? Answer::kCulled : Answer::kClear;
    return outcome;
  }
  if (contact.kind != PathContact::Kind::kContact || events == nullptr) return std::nullopt;
  const PairState::Phase next = phaseBehind(*path, contact);
  if (next == PairState::Phase::kUndecided) return std::nullopt;
  outcome.answer = Answer::kImpact;
  events->emplace_back();
  writeStraight(piece, options, *path, contact, events->back());
  if (next == PairState::Phase::kApart) {
    events->push_back(separationBehind(events->back()));
  }
  return outcome;
}

}  // namespace collision_node::impact

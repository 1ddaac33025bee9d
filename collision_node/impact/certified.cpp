/// The certified solver as a PairMethod: what happens on a piece is piece_run.h's; here are the ends of a
/// pair's data.
#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include "collision_node/impact/facts/event_writer.h"
#include "collision_node/impact/out_of_reach.h"
#include "collision_node/impact/pair_method.h"
#include "collision_node/impact/piece_run.h"
#include "collision_node/impact/solve.h"
#include "collision_node/impact/straight/straight_shot.h"

namespace collision_node::impact {
namespace {

using Phase = PairState::Phase;

/// Of the calling thread, for the methods of a stream, whose callers have none.
Workspace& ownWorkspace() {
  static thread_local Workspace workspace;
  return workspace;
}

/// What needs no search: a straight shot, or paths out of reach.
std::optional<PieceOutcome> withoutSearch(const Body& a, const Body& b, const Piece& piece,
                                          const PairOptions& options, bool known_apart,
                                          std::vector<PairEvent>* events) {
  a.prefetch();
  b.prefetch();
  if (a.triangleCount() + b.triangleCount() > 0) {
    if (auto outcome = shoot(a, b, piece, options, known_apart, events)) return outcome;
  }
  if (!outOfReach(a, b, piece, options.contact_distance)) return std::nullopt;
  PieceOutcome outcome;
  outcome.answer = Answer::kCulled;
  return outcome;
}

[[noreturn]] void refuse(const char* what, double value, const char* right) {
  std::ostringstream text;
  text << "impact: " << what << " is " << value << "; it must be " << right;
  throw std::invalid_argument(text.str());
}

/// With a negative length, or a piece that ends before it begins, all would seem proved.
void check(const PairOptions& options) {
  const auto length = [](const char* what, double value) {
    if (!(value >= 0.0 && std::isfinite(value))) refuse(what, value, "0 or more, and finite");
  };
  length("PairOptions::contact_distance [m]", options.contact_distance);
  length("PairOptions::time_precision [s]", options.time_precision);
  length("PairOptions::distance_precision [m]", options.distance_precision);
}

void check(const Piece& piece) {
  if (!(piece.tube >= 0.0)) refuse("Piece::tube [m]", piece.tube, "0 or more");
  if (piece.end_ns < piece.start_ns)
    refuse("Piece::end_ns - start_ns [s]", motion::secondsBetween(piece.start_ns, piece.end_ns), "0 or more");
}

/// PairMethod::finish().
void finishPair(const Body& a, const Body& b, const PairOptions& options, Workspace& workspace,
                PairState& state, std::vector<PairEvent>& events) {
  if (state.phase != Phase::kUndecided || state.was_touching || state.published) return;
  const Piece& piece = state.last_piece;
  const PairPiece pair(a, b, piece, options.contact_distance);
  Search search(pair, options.node_budget, workspace);
  EventWriter writer(pair, piece, options, search, workspace);
  PairEvent event = state.pending;
  const double end = pair.motion.duration(), from = std::clamp(writer.localStart(event), 0.0, end);
  writer.finishImpact(event, from, end, writer.anyNear(from, end), state, false);
  event.certificate = Certificate::kPossible;
  event.reason = Reason::kGrazing;
  events.push_back(event);
  state.published = true;
}

class Certified : public PairMethod {
 public:
  Certified(const Body& a, const Body& b, const PairOptions& options) : a_(a), b_(b), options_(options) {
    check(options);
  }

  PieceOutcome advance(const Piece& piece, PairState& state, std::vector<PairEvent>& events) const override {
    check(piece);
    if (state.phase == Phase::kNew || state.phase == Phase::kApart) {
      const bool known_apart = state.phase == Phase::kApart;
      if (const auto outcome = withoutSearch(a_, b_, piece, options_, known_apart, nullptr)) {
        state.phase = Phase::kApart;
        state.last_piece = piece;
        return *outcome;
      }
    }
    const PairPiece pair(a_, b_, piece, options_.contact_distance);
    const PieceOutcome outcome = PieceRun(pair, piece, options_, ownWorkspace(), state, events).run();
    state.last_piece = piece;
    return outcome;
  }

  bool knowsTubes() const override { return true; }

  void finish(PairState& state, std::vector<PairEvent>& events) const override {
    finishPair(a_, b_, options_, ownWorkspace(), state, events);
  }

  void interrupt(PairState& state, Reason reason, std::vector<PairEvent>& events) const override {
    finish(state, events);
    const bool may_have_ended = state.phase == Phase::kUndecided && state.was_touching;
    if (state.phase == Phase::kTouching || may_have_ended) {
      const Piece& piece = state.last_piece;
      const PairPiece pair(a_, b_, piece, options_.contact_distance);
      Search search(pair, options_.node_budget, ownWorkspace());
      const EventWriter writer(pair, piece, options_, search, ownWorkspace());
      const double end = pair.motion.duration();
      const Instant last = pair.at(end);
      PairEvent event = may_have_ended ? state.pending : writer.stamped(Kind::kSeparation, last);
      const double from = std::clamp(writer.localStart(event), 0.0, end);
      ContactFacts facts = describeUnknown(pair, last, end - from);
      facts.position_error += 2.0 * writer.earlierThan(event, state).distance;
      writer.fill(event, facts, end, end);
      event.certificate = Certificate::kUncertified;
      event.reason = reason;
      events.push_back(event);
    }
    state = PairState();
  }

 private:
  const Body& a_;
  const Body& b_;
  const PairOptions options_;
};

}  // namespace

Workspace::Workspace() : buffers_(std::make_unique<Buffers>()) {}
Workspace::~Workspace() = default;
Workspace::Workspace(Workspace&&) noexcept = default;
Workspace& Workspace::operator=(Workspace&&) noexcept = default;

void solve(const Body& a, const Body& b, const Piece& piece, const PairOptions& options, Workspace& workspace,
           Solution& solution) {
  check(options);
  check(piece);
  solution.events.clear();
  const bool first_only = options.scope == Scope::kFirstContact;
  if (const auto outcome =
          withoutSearch(a, b, piece, options, false, first_only ? &solution.events : nullptr)) {
    solution.verdict = outcome->answer;
    solution.budget_met = false;
    solution.node_tests = outcome->node_tests;
    solution.subdivisions = 0;
    return;
  }
  const PairPiece pair(a, b, piece, options.contact_distance);
  PairState state;
  const PieceOutcome outcome = PieceRun(pair, piece, options, workspace, state, solution.events).run();
  if (state.phase == Phase::kUndecided) {
    state.last_piece = piece;
    finishPair(a, b, options, workspace, state, solution.events);
  }
  solution.verdict = outcome.answer;
  solution.budget_met = outcome.budget_met;
  solution.node_tests = outcome.node_tests;
  solution.subdivisions = outcome.subdivisions;
}

std::unique_ptr<PairMethod> makeCertified(const Body& a, const Body& b, const PairOptions& options) {
  return std::make_unique<Certified>(a, b, options);
}

}  // namespace collision_node::impact

/// The certified solver as a PairMethod: what happens on a piece is piece_run.h's; here are the ends of a
/// pair's data.
#include "collision_node/impact/contact_facts.h"
#include "collision_node/impact/pair_method.h"
#include "collision_node/impact/piece_run.h"

namespace collision_node::impact {
namespace {

using Phase = PairState::Phase;

class Certified : public PairMethod {
 public:
  Certified(const Body& a, const Body& b, const PairOptions& options) : a_(a), b_(b), options_(options) {}

  PieceOutcome advance(const Piece& piece, PairState& state, std::vector<PairEvent>& events) const override {
    const PairPiece pair(a_, b_, piece, options_.contact_distance);
    const PieceOutcome outcome = runPiece(pair, piece, options_, state, events);
    state.decided_ns = piece.end_ns;
    state.last_piece = piece;
    return outcome;
  }

  void finish(PairState& state, std::vector<PairEvent>& events) const override {
    if (state.phase == Phase::kUndecided && !state.was_touching && !state.published) {
      PairEvent event = state.pending;
      const Piece& piece = state.last_piece;
      const PairPiece pair(a_, b_, piece, options_.contact_distance);
      const double duration = pair.motion.duration();
      const ContactFacts facts = describeUnknown(pair, pair.at(duration), duration);
      event.toi_upper = motion::secondsBetween(event.interval_start_ns, piece.end_ns);
      if (event.kind == Kind::kInitialOverlap) event.toi_upper = event.toi_lower;
      event.position = pair.motion.poseA(duration).position + facts.position;
      event.position_error = facts.position_error;
      event.normal = facts.normal;
      event.normal_error = facts.normal_error;
      event.relative_velocity = facts.relative_velocity;
      event.closing_speed = facts.closing_speed;
      event.a.point = facts.a.point;
      event.b.point = facts.b.point;
      event.certificate = Certificate::kPossible;
      event.reason = Reason::kGrazing;
      events.push_back(event);
      state.published = true;
    }
  }

  void interrupt(PairState& state, Reason reason, std::vector<PairEvent>& events) const override {
    finish(state, events);
    const bool in_contact =
        state.phase == Phase::kTouching || (state.phase == Phase::kUndecided && state.was_touching);
    if (in_contact) {
      PairEvent event = state.contact;
      const Piece& piece = state.last_piece;
      event.kind = Kind::kSeparation;
      event.certificate = Certificate::kUncertified;
      event.reason = reason;
      event.interval_start_ns = piece.start_ns;
      event.interval_end_ns = piece.end_ns;
      event.toi_lower = event.toi_upper = motion::secondsBetween(piece.start_ns, piece.end_ns);
      const RelativeMotion m(piece.a, piece.b, piece.start_ns, piece.end_ns);
      event.a.pose = m.poseA(event.toi_lower);
      event.b.pose = m.poseB(event.toi_lower);
      event.a.sample_before_ns = piece.a.start_ns;
      event.a.sample_after_ns = piece.a.end_ns;
      event.b.sample_before_ns = piece.b.start_ns;
      event.b.sample_after_ns = piece.b.end_ns;
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

std::unique_ptr<PairMethod> makeCertified(const Body& a, const Body& b, const PairOptions& options) {
  return std::make_unique<Certified>(a, b, options);
}

}  // namespace collision_node::impact

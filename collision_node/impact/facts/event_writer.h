/// Brackets into events: stamps, poses, and the facts of the contact with everything that may touch beside
/// it.
#pragma once

#include "collision_node/impact/facts/contact_facts.h"

namespace collision_node::impact {

/// Writes the events of one piece. Times are seconds from the piece's start.
class EventWriter {
 public:
  EventWriter(const PairPiece& pair, const Piece& piece, const PairOptions& options, Search& search,
              Workspace& workspace)
      : pair_(pair), piece_(piece), options_(options), search_(search), views_(workspace.buffers().views) {}

  /// An event at an instant without facts: stamps, samples, poses; toi_lower = toi_upper = its time.
  PairEvent stamped(Kind kind, const Instant& now) const;

  /// The bracket's start on this piece's clock; negative when it opened earlier.
  double localStart(const PairEvent& event) const;

  /// How far things may have moved from the bracket's start to this piece's.
  Earlier earlierThan(const PairEvent& event, const PairState& state) const;

  /// Closes an impact's bracket at `upper`; facts are taken at `lower`, before which the pair is apart.
  /// `state` knows how fast things moved since a bracket that opened on an earlier piece. `sure_of_pair`: the
  /// pair is known to touch; else the ball holds every pair that may. A bracket that opened on the piece
  /// before has the velocities with which that piece ends.
  void finishImpact(PairEvent& event, double lower, double upper, ElementPair pair, const PairState& state,
                    bool sure_of_pair = true);

  /// Closes a separation's bracket at `upper`, where the facts are taken: the pair is apart from there on.
  void finishSeparation(PairEvent& event, double lower, double upper, ElementPair pair,
                        const PairState& state, bool sure_of_pair = true);

  /// The bracket's end, and the facts, which hold at `reference`.
  void fill(PairEvent& event, const ContactFacts& facts, double reference, double upper) const;

  /// Some pair that is not proved apart throughout the time; -1 when all are.
  ElementPair anyNear(double from, double to);

 private:
  struct Bracket {
    double lower, upper, reference;
    double apart_at;  ///< on which side in time the pair is apart
    Earlier earlier;
    bool sure_of_pair;
    const Piece* incoming;  ///< whose velocities at its end are reported; null: this piece's

    Bracketed when() const { return {upper - lower, apart_at, earlier}; }
  };

  void finish(PairEvent& event, const Bracket& bracket, ElementPair pair);
  void joinNeighbours(PairEvent& event, ContactFacts& facts, const Bracket& bracket, ElementPair pair);
  static void takeVelocities(ContactFacts& facts, const Piece& incoming);

  const PairPiece& pair_;
  const Piece& piece_;
  const PairOptions& options_;
  Search& search_;
  ViewBuffers& views_;
};

}  // namespace collision_node::impact

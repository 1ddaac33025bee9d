/// The certified solver on one piece: a small state machine over what is proved.
///
/// Guarantees (docs/solver.md; each has a test that quotes it):
///   - Time outside events and brackets is proved free of contact, or proved contact but for gaps no longer
///     than a bracket or no wider than kFlush rounding budgets; except where a piece is answered undecided.
///   - CONFIRMED: apart before toi_lower, contact proved at or before toi_upper.
///   - What cannot be decided is published as POSSIBLE, never as clear.
#pragma once

#include <array>
#include <limits>
#include <optional>
#include <vector>

#include "collision_node/impact/facts/event_writer.h"
#include "collision_node/impact/proof/passage_proof.h"
#include "collision_node/impact/workspace.h"

namespace collision_node::impact {

/// One piece of one pair, from the state at its start to the state at its end. Times are seconds from the
/// piece's start. Its brackets are in piece_run.cpp, contacts and how they end in piece_contact.cpp, those
/// too shallow to be proved in piece_flush.cpp, points that pass through surfaces and straight paths in
/// piece_passage.cpp.
class PieceRun {
 public:
  PieceRun(const PairPiece& pair, const Piece& piece, const PairOptions& options, Workspace& workspace,
           PairState& state, std::vector<PairEvent>& events);

  PieceOutcome run();

 private:
  /// What is known of a time, between two proofs of contact or up to the end, in which nothing was proved.
  struct Stretch {
    enum Kind { kClose, kApart, kUnknown } kind;
    double apart = 0.0;  ///< kApart: from this instant on, for longer than a bracket may be wide
  };

  /// Successive instants of a search behind the end of a proof grow by this. What rounding hides is up to six
  /// budgets wide; with this overshoot a bracket stays within eight.
  static constexpr double kGrow = 1.3;
  static constexpr double kBracket = 8.0;
  static constexpr double kBelongs = 4.0;  ///< [budgets] of these, before what is not proved begins again
  /// Where one bracket after the other turns out to be free, each next one is looked at in longer steps.
  static constexpr double kBolder = 2.0;
  /// [budgets] The widest gap between two proofs of contact that counts as contact: wide enough for being
  /// within it to be proved, over times that are not too short.
  static constexpr double kFlush = 256.0;
  static constexpr int kHalvings = 3;  ///< of the last step of such a search
  /// [widths] Behind the instant at which a bracket opens: who is near is known without another walk.
  static constexpr double kWindow = 2.0;

  /// A pair's first instant: overlapping, apart, or not known.
  void start();
  /// Contact is proved at `t`, and nothing is known of how it began.
  void beginOverlap(double t, const ContactWitness& witness);
  /// Opens a bracket at `t`: contact is possible from here on.
  void open(Kind kind, double t, ElementPair pair);
  /// Behind the start of an open bracket: finds what is proved first, contact or clearance. Returns false at
  /// the end.
  bool resolve(double& t);
  /// An open bracket that begins at `from`, and how far its search has come.
  struct Onset {
    double from;
    double nothing;  ///< the last instant at which nothing was proved
    double step;     ///< from the start to the instant looked at next
    bool carried;    ///< the bracket was opened by an earlier piece
    bool small;      ///< steps have begun at the smallest: what was skipped may hold a contact
    bool bold;       ///< or at what the bracket before, found free, had taken
  };
  /// Contact or clearance at `at`, by whatever proves it.
  Proved lookAt(double at, ContactWitness& found);
  /// The pair is apart at `at`, behind an open bracket: true where that closes it and moves t, else the onset
  /// says where to look next.
  bool closesApart(Onset& onset, double at, ContactWitness& found, double& t);
  /// A bracket that began at `from` is free at `at`, and the next one would begin soon: in less time than the
  /// bracket has taken, or than a bracket may take, or than the last budgets before a slow contact do?
  bool belongsTogether(double from, double at, const Search::First& next);
  /// Steps behind a bracket's start grow, so the last one may go too far: halves it where the bracket is
  /// wider than was asked for. Nothing is proved at `nothing`, contact is proved at `at`, and at the time
  /// returned.
  double soonestContact(double from, double nothing, double at, ContactWitness& found);
  /// The same at the other end of a contact, proved at `contact`: the pair is apart at `at`, and at the time
  /// returned.
  double soonestApart(double contact, double nothing, double at);
  /// A contact too shallow to be proved for a while may be deep again shortly before it ends: the last
  /// instant looked at before `apart` at which contact is proved, where that narrows the bracket from
  /// `contact`.
  std::optional<double> lastContact(double contact, double apart, ContactWitness& found);
  /// The bracket's search has proved the contact itself. False where it is not known what comes behind it.
  bool closeStraight(const PathContact& met);
  /// The piece ends inside an open bracket. One that has been open for a whole piece is published and holds
  /// up nothing.
  void waitForMore();
  /// Contact is proved at `at`: closes the open bracket as CONFIRMED.
  void confirm(double from, double at, const ContactWitness& found);
  /// Contact at a few instants strictly between two?
  bool inBetween(double low, double high, ContactWitness& found);
  /// A point went through a surface between the two instants: an impact and its separation in one bracket.
  /// Seen from a little earlier and, where it fails, a little later: what is proved apart around the bracket
  /// holds no contact, so a passage of all that time is one of the bracket.
  bool passed(double from, double at, double& t);
  /// Whether the pair is a point that passes through the other's triangle, or through those around it.
  bool passesBetween(const Instant& first, const Instant& last, const NearPairs& near,
                     ElementPair pair) const;
  /// The triangles of one mesh among the near pairs of the same point.
  TrianglePatch patchAround(const NearPairs& near, ElementPair pair, bool point_is_a, int shape) const;
  /// In contact at `t`: follows the proof forward, and where it ends looks for the next one or for clearance.
  bool follow(double& t);
  /// A piece begins in contact: finds it there, or publishes that it ended and is true.
  bool endedBefore(double t);
  /// Contact is proved at t: follows that proof to its end. Where nothing is known of the time since the last
  /// one, at `proved`, that is published first.
  void holdOn(const Stretch& since, double proved, double& t);
  /// Moves t forward, up to `until`, as long as this witness proves contact.
  void persist(double& t, ContactWitness& witness, double until);
  /// Contact is proved at `proved` and the pair is apart at `apart`: publishes the separation and is true, or
  /// finds contact again shortly before it.
  bool part(double proved, double nothing, double apart, double& t);
  /// Contact is proved at `proved`, and the piece ends without another proof: the next one goes on from here.
  void leaveOpen(const Stretch& since, double proved);

  /// Is the pair close enough to contact throughout, up to gaps no longer than a bracket's width? Of a time
  /// as short as that nothing is asked.
  Stretch between(double from, double to);
  /// Contact is proved at `at`, and of the time since the open separation's bracket began nothing is known:
  /// it is an open question, and what begins at `at` a contact of which nobody knows how.
  void contactAfterUnknown(double at, const ContactWitness& witness);
  void openSeparation(double t);
  /// Closes a separation's bracket at `at`. `apart`: proved there, else the question stays open.
  void publishSeparation(double at, bool apart = true);
  /// Closes the open bracket at `at`, where the pair is proved apart again or the data end, without a proof
  /// of contact.
  void publishPossible(double at);
  /// The node budget is spent: everything from `t` on is one open question.
  void stopForBudget(double t);
  /// Publishes the open bracket as POSSIBLE up to the piece's end. It holds nothing up any more; the pair is
  /// neither in contact nor apart until one of them is proved.
  void giveUp();

  const PairPiece& pair_;
  const Piece& piece_;
  const PairOptions& options_;
  Workspace& workspace_;
  Search search_;
  EventWriter writer_;
  PairState& state_;
  std::vector<PairEvent>& events_;
  const double end_;
  double floor_, width_;
  double free_step_ = 0.0, free_end_ = 0.0;  ///< of the last bracket that a second look proved free
  bool is_parting_;     ///< an earlier piece has opened the separation, and no contact was proved since
  double longest_gap_;  ///< [s] that may be passed over between two proofs of contact
  double least_rest_;   ///< [s] of an open question that ends in clearance and is an event of its own
  ElementPair opened_;
  ElementPair last_contact_;
  std::optional<ContactWitness> witness_;  ///< of the latest proof of contact
  double found_at_ = 0.0;
  double free_since_ = std::numeric_limits<double>::infinity();  ///< the search that opened the bracket
                                                                 ///< proved the time since then free
};

}  // namespace collision_node::impact

/// One watched pair of links: its method, what is known of it, and its events on their way to the queue.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "collision_node/scene/event_queue.h"
#include "collision_node/scene/model_watch.h"
#include "collision_node/scene/scene.h"
#include "collision_node/scene/tracks/pieces.h"

namespace collision_node::scene {

/// What the solving cost, since the engine began.
struct Costs {
  std::uint64_t node_tests = 0, subdivisions = 0, budget_met = 0;

  void add(const Costs& more) {
    node_tests += more.node_tests;
    subdivisions += more.subdivisions;
    budget_met += more.budget_met;
  }
};

class PairWatch {
 public:
  /// The scene must outlive the watch.
  PairWatch(const Scene& scene, const LinkPair& pair, PairRank rank,
            std::unique_ptr<impact::PairMethod> method);

  /// Advances over a piece that follows the last one.
  void advance(const Step& step, Outbox& outbox, Costs& costs);
  /// Nothing is swept from here on; an open contact ends with `reason`.
  void interrupt(impact::Reason reason, Outbox& outbox);
  /// The end, for now: an undecided bracket is published. A contact stays open.
  void finish(Outbox& outbox);
  /// A new epoch: as if never advanced.
  void startOver();
  /// The two were apart for a while that was not advanced over. Requires isQuiet().
  void skip();
  /// Nothing is open: the pair is apart or was never advanced, and all its events are on their way.
  bool isQuiet() const;

  bool isTouching() const { return phase() == impact::PairState::Phase::kTouching; }
  /// Lower end of what is still being searched and not published yet.
  std::optional<Instant> openSince() const;

  /// The worst answer since clearAnswer(); without a piece since then, what the last pieces left.
  impact::Answer worstAnswer() const;
  void clearAnswer() { worst_.reset(); }

  PairRank rank() const { return rank_; }
  const LinkPair& pair() const { return pair_; }

  /// Apart or new, and nothing more is to be known of it.
  bool isPlain() const;
  /// Nothing it says later depends on what was before its first piece: it has been apart since, or begun
  /// anew; or is in a contact, of which only the fact counts.
  bool isSettled() const;
  /// All that what it says later depends on (cut.cpp).
  void describe(Fingerprint& to) const;

 private:
  /// Why a bracket may not be certified, and how fast the two links may move while it lasts.
  struct Context {
    impact::Reason doubt = impact::Reason::kNone;
    double speed_a = 0.0, speed_b = 0.0;  ///< [m/s] upper bounds over the link
  };

  /// An event that waits for what the motion model's error makes of it, and those of the pair behind it.
  struct Waiting {
    impact::PairEvent from;
    Event event;
    std::shared_ptr<ContactNumber> contact;
  };

  impact::PairState::Phase phase() const { return state_ ? state_->phase : impact::PairState::Phase::kNew; }
  void forgetContact();
  void letGo(const Context& context, Outbox& outbox);
  void fillModel(Event& event, const ModelWatch::Answer& answer) const;
  Context contextOf(const Step& step) const;
  void publish(const impact::PairEvent& event, const Context& context);
  Event makeEvent(const impact::PairEvent& from, const Context& context) const;
  std::shared_ptr<ContactNumber> contactOf(const impact::PairEvent& event);

  const Scene& scene_;
  LinkPair pair_;
  PairRank rank_;
  std::unique_ptr<impact::PairMethod> method_;
  std::unique_ptr<impact::PairState> state_;  ///< null: new. Large, and most pairs rest
  Context bracket_;                           ///< over all pieces that an open bracket has seen
  std::shared_ptr<ContactNumber> contact_;
  ModelWatch model_;
  std::vector<Waiting> waiting_;
  bool has_advanced_ = false;
  bool knows_origin_ = false;  ///< has been apart, or begun anew, since the first piece
  std::optional<impact::Answer> worst_;
  impact::Answer last_ = impact::Answer::kCulled;
};

}  // namespace collision_node::scene

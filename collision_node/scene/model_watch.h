/// A pair solved a second time, for every true motion within the tubes of the motion model's error at once.
///
/// Guarantee (docs/model_error.md): while tubes are known, two bodies whose true motions stay in them touch
/// only during an approach that is recorded here, never before its `lower`. A confirmed approach has a true
/// contact at or before its `upper`.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "collision_node/impact/pair_method.h"
#include "collision_node/scene/tracks/instant.h"
#include "collision_node/scene/tracks/pieces.h"

namespace collision_node::scene {

class Fingerprint;

class ModelWatch {
 public:
  /// What the model's error makes of one event; NaN where there is no bound.
  struct Answer {
    double toi_lower, toi_upper;  ///< [s] from the event's interval_start
    double position_error;        ///< [m] round the event's position
  };

  /// `method` must outlive the watch. Reaches: of the bodies, from their objects' origins [m].
  ModelWatch(const impact::PairMethod& method, double reach_a, double reach_b, double contact_distance)
      : method_(method), reach_a_(reach_a), reach_b_(reach_b), contact_distance_(contact_distance) {}

  /// Solves a piece that follows the last one; does nothing, and forgets, where no bound is asked or known.
  impact::PieceOutcome advance(const Step& step);
  void interrupt();
  void finish();
  /// A new epoch, or behind a hole: as if never advanced.
  void startOver();
  /// As if advanced over a piece of such trust on which the two were apart.
  void skip(const Trust& trust);
  /// Forgets what is over. Call when every event has had its answer.
  void forgetEnded();

  /// An event of the same pair as the model has it: what it covers is no near miss.
  void note(const impact::PairEvent& event);

  /// The bounds of an impact; nothing while its approach is still being searched.
  std::optional<Answer> answer(const impact::PairEvent& event) const;

  /// Approaches that the model passes without contact, but the true motions may not: each once, as a POSSIBLE
  /// event. Call after all of the model's own events of these pieces are noted.
  std::vector<impact::PairEvent> takeNearMisses();

  /// Lower end of a bracket that is still being searched.
  std::optional<Instant> openSince() const;
  bool isUndecided() const { return state_ && state_->phase == impact::PairState::Phase::kUndecided; }
  /// No approach is under way.
  bool isApart() const {
    return approaches_.empty() && contacts_.empty() &&
           (!state_ || state_->phase == impact::PairState::Phase::kApart);
  }
  /// All that what it says later depends on (cut.cpp).
  void describe(Fingerprint& to) const;

 private:
  struct Approach {
    impact::PairEvent event;  ///< of the second solving
    Instant lower, upper;
    double ball = 0.0;  ///< [m] round event.position, for a true contact in the bracket
    bool confirmed = false, has_ended = false, has_given_up = false, is_told = false;
  };
  struct Contact {
    Instant from;
    std::optional<Instant> to;
  };

  double tubeOn(const Trust& trust) const;
  bool canRunOn(const Trust& trust) const;
  void take(const std::vector<impact::PairEvent>& events);
  double ballOf(const impact::PairEvent& event) const;

  const impact::PairMethod& method_;
  double reach_a_, reach_b_, contact_distance_;
  std::unique_ptr<impact::PairState> state_;  ///< while tubes are known: most pairs never need it
  std::vector<Approach> approaches_;          ///< in time order; only the last may still go on
  std::vector<Contact> contacts_;             ///< of the model
  // Over all pieces since the bracket opened.
  double speed_a_ = 0.0, speed_b_ = 0.0;  ///< [m/s] of the origins
  double error_a_ = 0.0, error_b_ = 0.0;  ///< [m] of the origins
  double tube_ = 0.0;
};

}  // namespace collision_node::scene

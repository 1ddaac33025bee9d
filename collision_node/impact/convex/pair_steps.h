/// How long do two convex elements stay apart? Steps in time, each proved by the gap along an axis that turns
/// with what is closest.
///
/// Guarantee: that of gap_model.h, for every step.
#pragma once

#include <optional>

#include "collision_node/impact/convex/closest_points.h"

namespace collision_node::impact {

class PairSteps {
 public:
  /// The elements must outlive the steps.
  PairSteps(const PairPiece& piece, const Element& a, const Element& b);

  /// Steps from `from` as long as a gap is proved; returns the time up to which, infinity when up to `to`.
  /// Steps shorter than `stop` end the search, and so does more than `most` in `tests`, to which all but the
  /// first are added.
  double advance(double from, double to, double stop, std::uint64_t& tests, std::uint64_t most);

  /// The longest time from `now`, at most `span`, that any proposed axis proves, and that axis. `closest` are
  /// the cores' closest points.
  double apartFor(const Instant& now, const Closest& closest, double span, Axis* proved);

  /// What proved the last step of advance(); an invalid axis: there was none.
  const Parting& parting() const { return parting_; }
  /// The closest points of its last step, where a search for others may begin; none where none is needed.
  const Closest& closest() const { return closest_; }

 private:
  /// Finds the closest points and the axis through them. A distance that is too large by the share `loss`
  /// will do.
  Axis closestAt(const Instant& now, double loss);
  /// Makes the gap model along the axis.
  void modelAlong(const Axis& axis, const Instant& now);
  /// Takes over the points, found for a part of the pair, if no other point of it shows itself closer.
  bool takeOver(const SlidingPoints& points, const Cores& part, double radius, const Instant& now,
                double loss, Axis* axis);
  /// The best of the axis through the closest points and, where it does badly, of others.
  double longest(const Instant& now, Axis axis, double span, Axis* proved);

  const PairPiece& piece_;
  const Element &a_, &b_;
  const double radius_;                   ///< of both, with the contact distance
  std::optional<SlidingPoints> sliding_;  ///< for a pair that has closed forms
  std::optional<CorePair> cores_;         ///< where a model was asked for
  std::optional<GapModel> through_;       ///< of the axis that longest() is to try first, where it is made
  Parting parting_;
  Closest closest_;
  double distance_ = 0.0;  ///< of the cores at the closest points
  double first_ = 0.0;     ///< [m] the gap at the start of what longest() proved last
  Apart last_;             ///< and that
};

}  // namespace collision_node::impact

/// Two tracks -> the pieces their pairs are solved on: the times between consecutive stamps of either track.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>

#include "collision_node/impact/pair_method.h"
#include "collision_node/scene/tracks/track.h"

namespace collision_node::scene {

/// How good what is known of two tracks' motions is.
struct Trust {
  impact::Reason doubt = impact::Reason::kNone;  ///< why events may not be certified
  motion::ModelError error_a, error_b;           ///< of each side's motion
};

/// What comes next for a pair of tracks.
struct Step {
  enum class What : std::uint8_t { kWait, kPiece, kBreak } what = What::kWait;
  impact::Piece piece;  ///< kPiece; adjoins the piece before, or is the first after a kBreak
  Trust trust;          ///< kPiece
  /// kPiece behind a jump: that of the piece before it. The first piece of a run has none before it.
  std::optional<Trust> skipped;
  impact::Reason reason = impact::Reason::kNone;  ///< kBreak: nothing is swept from the last piece on
  bool a_broke = false, b_broke = false;          ///< kBreak: whose poses broke off
};

/// Walks two tracks at once. The pieces do not depend on when the poses arrived, only on which were released.
class PieceCursor {
 public:
  /// Starts over at the tracks' first samples of the scene's epoch.
  void restart(const Track& a, const Track& b);

  /// The next step, or kWait when it is not known yet. A frozen object's rest is known up to `rest_known_ns`.
  Step next(const Track& a, const Track& b, Nanoseconds rest_known_ns);

  /// Lets go of samples that end by `ns`, while the pair shares no time: whoever joins later joins after
  /// `ns`.
  void skipTo(const Track& a, const Track& b, Nanoseconds ns);

  /// Goes on where both segments that begin with these samples have begun, or with later ones, behind the
  /// last piece: nothing in between is looked at.
  void jumpTo(std::size_t index_a, std::size_t index_b);

  /// The oldest samples still needed.
  std::size_t indexA() const { return a_; }
  std::size_t indexB() const { return b_; }

 private:
  bool findStart(const Track& a, const Track& b);

  std::size_t a_ = 0, b_ = 0;  ///< the samples that begin the current segments
  bool begun_ = false;
  bool is_first_ = false;                                        ///< no piece since it began
  Nanoseconds at_ns_ = std::numeric_limits<Nanoseconds>::min();  ///< where the last piece ended
};

}  // namespace collision_node::scene

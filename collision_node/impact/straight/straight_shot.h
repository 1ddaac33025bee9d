/// A point or a sphere on a straight path that starts apart and needs no search: most shots, most of the
/// time.
///
/// Guarantee: an answer is what the whole solver (piece_run.h) would prove; no answer says nothing. Allocates
/// nothing, builds nothing but the path.
#pragma once

#include <optional>
#include <vector>

#include "collision_node/impact/straight/straight_path.h"

namespace collision_node::impact {

/// `known_apart`: the pair is known to be apart at the piece's start. With `events`, the first contact is an
/// answer too: it is appended, with its separation where it has one in the same bracket. Without, only
/// kCulled and kClear are.
std::optional<PieceOutcome> shoot(const Body& a, const Body& b, const Piece& piece,
                                  const PairOptions& options, bool known_apart,
                                  std::vector<PairEvent>* events);

}  // namespace collision_node::impact

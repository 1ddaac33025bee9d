/// The certified solver on one piece: a small state machine over what is proved.
///
/// Guarantees (docs/solver.md; each has a test that quotes it):
///   - Time that no event and no bracket covers is proved free of contact, or proved to be contact throughout
///   up to
///     gaps no longer than the bracket's width.
///   - CONFIRMED: apart before toi_lower, contact proved at or before toi_upper.
///   - What cannot be decided is published as POSSIBLE, never as clear.
#pragma once

#include <vector>

#include "collision_node/impact/pair_piece.h"
#include "collision_node/impact/workspace.h"

namespace collision_node::impact {

/// Appends the changes of contact on the piece in time order and brings `state` to its end, all but
/// PairState::decided_ns and last_piece.
PieceOutcome runPiece(const PairPiece& pair, const Piece& piece, const PairOptions& options,
                      Workspace& workspace, PairState& state, std::vector<PairEvent>& events);

}  // namespace collision_node::impact

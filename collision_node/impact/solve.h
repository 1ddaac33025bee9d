/// The solver's one entry point for a pair on a piece of time of its own: no stream, no state before or
/// after.
///
/// Guarantee: docs/solver.md, first section. `verdict` says what holds:
///   kCulled, kClear   the two are proved apart throughout; no events.
///   kImpact           every change of contact is an event, each CONFIRMED (with Scope::kFirstContact the
///                     first).
///   kUndecided        at least one event is POSSIBLE; its reason says why (GRAZING, BUDGET). Or all that is
///                     open is whether the last contact ends before the piece does: it has no SEPARATION.
/// In events, NaN marks a field that its kind does not define. Streams go through pair_method.h, which
/// carries contacts from piece to piece.
#pragma once

#include "collision_node/impact/pair_method.h"
#include "collision_node/impact/workspace.h"

namespace collision_node::impact {

struct Solution {
  Answer verdict = Answer::kUndecided;
  bool budget_met = false;       ///< the node budget ran out: the last event covers what was not looked at
  std::uint64_t node_tests = 0;  ///< what it cost
  std::uint64_t subdivisions = 0;
  std::vector<PairEvent> events;  ///< in time order
};

/// Solves one piece: stamps [ns] with start <= end, lengths and precisions >= 0 [m], [s]; else throws
/// std::invalid_argument, which names the number. For no other number it throws. Thread-safe for distinct
/// workspaces. Allocates nothing after a workspace's and a solution's first calls of a kind.
void solve(const geometry::Body& a, const geometry::Body& b, const Piece& piece, const PairOptions& options,
           Workspace& workspace, Solution& solution);

}  // namespace collision_node::impact

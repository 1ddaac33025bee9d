/// Proof of a passage: a point goes through a patch of triangles at some time of an interval. For pairs
/// without radius or volume, which share a point only for an instant.
///
/// Guarantee: `true` only if it does, in exact arithmetic of the loaded geometry and the motion model.
/// `false` says nothing. Derivation: docs/solver.md, "Proofs of contact".
#pragma once

#include <array>
#include <boost/container/static_vector.hpp>

#include "collision_node/impact/pair_piece.h"

namespace collision_node::impact {

using TrianglePatch = boost::container::static_vector<std::array<Vec3, 3>, 64>;

/// Does a point pass through a patch of triangles at some time in [from.t, to.t]? For pairs without radius or
/// volume. `patch` are triangles of one body (b when `point_is_a`), `point` is a vertex of the other, in its
/// frame. A patch of several triangles proves a passage through their common edge or vertex, which none of
/// them proves alone.
bool passesThrough(const PairPiece& piece, const Instant& from, const Instant& to, bool point_is_a,
                   const Vec3& point, const TrianglePatch& patch);

}  // namespace collision_node::impact

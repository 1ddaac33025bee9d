/// Straight paths that keep two bodies out of each other's reach: asked before anything is made for the pair.
#pragma once

#include "collision_node/geometry/body.h"
#include "collision_node/impact/pair_method.h"

namespace collision_node::impact {

/// Are the two farther than `contact_distance` apart throughout the piece, however they turn? False says
/// nothing. Derivation: docs/solver.md, "Out of reach".
bool outOfReach(const geometry::Body& a, const geometry::Body& b, const Piece& piece,
                double contact_distance);

}  // namespace collision_node::impact

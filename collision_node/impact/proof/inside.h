/// Is a point inside a closed mesh? By the signed crossings of a ray whose every orientation sign is certain.
#pragma once

#include "collision_node/impact/pair_piece.h"

namespace collision_node::impact {

enum class Where { kInside, kOutside, kUnknown };

/// `solid` is the number of a shape, one of body.solids(). `point` is in the body's frame and known to within
/// `error`. Non-zero winding number is inside. kInside and kOutside are proofs for every point of the ball;
/// kUnknown says nothing.
Where whereIn(const Body& body, int solid, const Vec3& point, double error);

/// A proof that two surfaces meet takes elements some rounding budgets wide. Is one of these narrower, and
/// the other body a solid that may hold it?
bool mayHide(const PairPiece& piece, const Element& a, const Element& b);

/// Of such a pair: is a point of the narrow one proved to be inside a solid of the other body? Holds at any
/// instant, whatever touches. `held` receives the point relative to A's origin.
bool holdsHidden(const PairPiece& piece, const Instant& now, const Element& a, const Element& b, Vec3* held);

/// Does one body's solid hold a part of the other? Meant for an instant at which all surfaces are proved
/// apart. kInside: yes, proved; kOutside: no, proved, for all parts. `held` receives a common point relative
/// to A's origin.
Where containment(const PairPiece& piece, const Instant& now, Vec3* held);

}  // namespace collision_node::impact

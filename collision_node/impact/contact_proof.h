/// Proofs of contact: two elements touch at every time of an interval, or at some time of it.
///
/// Guarantee of every function here: `true` (or a positive time) only if the elements are within
/// `contact_distance` of each other in exact arithmetic of the loaded geometry and the motion model. `false`
/// says nothing. Derivations: docs/solver.md, "Proofs of contact".
#pragma once

#include <array>
#include <vector>

#include "collision_node/impact/gjk.h"

namespace collision_node::impact {

/// A closed oriented surface of triangles over points of B - A. Where every triangle sees the origin on its
/// inner side, the surface winds around the origin, so the origin lies in the hull of the points: the
/// elements share a point.
struct Wrap {
  std::vector<SupportPair> points;
  std::vector<std::array<int, 3>> faces;  ///< indices into points, outward
};

/// Builds a wrap whose faces are all at least `depth` away from the origin at this instant, or returns false.
/// A proposal (an expanding polytope, van den Bergen 2001); wrapHolds() is the proof.
bool buildWrap(const Cores& cores, double depth, Wrap& wrap);

/// What is known to touch, so that it can be followed in time.
struct ContactWitness {
  std::int32_t element_a = -1, element_b = -1;  ///< -1: one body's solid holds the other (no surfaces touch)
  bool rounded = false;                         ///< two cores within the sum of their radii; else a wrap
  double shrunk = 0.0;  ///< [m] rounded: by how much cylinders were made smaller and grown back
  Closest closest;      ///< rounded
  Wrap wrap;            ///< otherwise
  Vec3 point =
      Vec3::Zero();  ///< a common point, world axes relative to A's origin (rounded: between the cores)
};

/// Do the two elements touch at `now`? Fills `witness` (but not its element ids). With `witness.shrunk` > 0 a
/// proof that lasts is sought, from a little deeper than that on (infinite: from the deepest); else any will
/// do.
bool touchesAt(const PairPiece& piece, const Instant& now, const Element& a, const Element& b,
               const Closest& closest, ContactWitness& witness);

/// Do the elements that `witness` holds at `from` touch at every time in [from.t, to.t]?
bool touchesThrough(const PairPiece& piece, const Instant& from, const Instant& to, const Element& a,
                    const Element& b, const ContactWitness& witness);

/// Does a point pass through a patch of triangles at some time in [from.t, to.t]? For pairs without radius or
/// volume. `patch` are triangles of one body (b when `point_is_a`), `point` is in the other's frame. A patch
/// of several triangles proves a passage through their common edge or vertex, which none of them proves
/// alone.
bool passesThrough(const PairPiece& piece, const Instant& from, const Instant& to, bool point_is_a,
                   const Vec3& point, const std::vector<std::array<Vec3, 3>>& patch);

}  // namespace collision_node::impact

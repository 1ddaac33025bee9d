/// Proofs of contact: two elements touch at an instant, or at every time of an interval.
///
/// Guarantee of every function here: `true` only if the elements are within
/// `contact_distance` of each other in exact arithmetic of the loaded geometry and the motion model. `false`
/// says nothing. Derivations: docs/solver.md, "Proofs of contact".
#pragma once

#include "collision_node/impact/proof/wrap.h"

namespace collision_node::impact {

/// What is known to touch, so that it can be followed in time.
struct ContactWitness {
  std::int32_t element_a = -1, element_b = -1;  ///< -1: one body's solid holds the other (no surfaces touch)
  bool rounded = false;                         ///< two cores within the sum of their radii; else a wrap
  bool momentary = false;  ///< rounded: proved at its instant only; what is to last is sought anew
  double shrunk = 0.0;     ///< [m] rounded: by how much cylinders were made smaller and grown back
  Closest closest;         ///< rounded
  Wrap wrap;               ///< otherwise
  Vec3 point =
      Vec3::Zero();  ///< a common point, world axes relative to A's origin (rounded: between the cores)

  /// As new, without touching all the room there is for a wrap.
  void clear() {
    element_a = element_b = -1;
    rounded = momentary = false;
    shrunk = 0.0;
    closest = Closest();
    wrap.points.clear();
    wrap.faces.clear();
    point.setZero();
  }
};

/// Do the two elements touch at `now`? Fills `witness` (but not its element ids). With `witness.shrunk` > 0 a
/// proof that lasts is sought, from a little deeper than that on (infinite: from the deepest); else any will
/// do.
bool touchesAt(const PairPiece& piece, const Instant& now, const Element& a, const Element& b,
               const Closest& closest, ContactWitness& witness);

/// The same by the depth of cores that overlap by much more than their radii and the contact distance: a
/// proof that lasts where one by these would not.
bool touchesDeep(const PairPiece& piece, const Instant& now, const Element& a, const Element& b,
                 const Closest& closest, ContactWitness& witness);

/// The same for two cores without a radius that were last seen apart with the closest points `before` and
/// along `direction`, from A to B (null: neither is known), where a known feature of one of them reaches into
/// the other: no search, and a proof of this instant only.
bool touchesSliding(const PairPiece& piece, const Instant& now, const Element& a, const Element& b,
                    const Closest& before, const Vec3* direction, ContactWitness& witness);

/// Do the elements that `witness` holds at `from` touch at every time in [from.t, to.t]? If so, it holds them
/// at `to`; its `point` stays that of the instant before. Else `share` becomes a guess: up to which share of
/// the time it may be.
bool touchesThrough(const PairPiece& piece, const Instant& from, const Instant& to, const Element& a,
                    const Element& b, ContactWitness& witness, double& share);

}  // namespace collision_node::impact

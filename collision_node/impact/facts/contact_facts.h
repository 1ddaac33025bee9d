/// Where two elements touch, with hard error bounds: the ball, the normal and its cone, the features.
#pragma once

#include "collision_node/impact/convex/contact_view.h"
#include "collision_node/impact/walk/search.h"

namespace collision_node::impact {

/// What may have happened since a bracket opened on an earlier piece.
struct Earlier {
  double distance = 0.0;  ///< [m] that any point may have moved, in the world or against the other body
  double angle = 0.0;     ///< [rad] that both bodies may have turned, together
};

/// When a contact begins or ends: within `span` of the instant at which it is described.
struct Bracketed {
  double span;      ///< [s]
  double apart_at;  ///< [s] on the side in time on which the pair is apart: 0 for an impact, the piece's end
                    ///< for a separation
  Earlier earlier;
};

/// Where to begin; any would do.
struct Proposal {
  const Parting* parting = nullptr;  ///< a normal
  Closest closest;                   ///< closest points
};

struct ContactFacts {
  Vec3 position = Vec3::Zero();           ///< world axes, relative to A's origin at the reference instant [m]
  double position_error = 0.0;            ///< [m] see describeContact()
  Vec3 normal = Vec3::Zero();             ///< unit, from A to B; NaN when unknown
  double normal_error = 0.0;              ///< [rad]
  Vec3 relative_velocity = Vec3::Zero();  ///< v_b - v_a of the material points at `position` [m/s]
  double closing_speed = 0.0;             ///< [m/s]
  Side a, b;                              ///< features, elements and witness points; not the poses
};

/// Facts of the contact of one pair of elements.
///
/// Guarantee: every point that the two elements share at the first (or last) instant of this contact, if that
/// instant lies within `when.span` of now.t, is within position_error of `position` + A's origin at now.t
/// (world); the common support plane there has its normal within normal_error of `normal`. Derivation:
/// docs/solver.md, "The ball".
ContactFacts describeContact(const PairPiece& piece, const Instant& now, ElementPair pair,
                             const Bracketed& when, const Proposal& proposal, ViewBuffers& buffers);

/// No pair is known (the budget ran out): a ball that holds all shared points within `span` of now.
ContactFacts describeUnknown(const PairPiece& piece, const Instant& now, double span);

/// Facts of an overlap that was not seen to begin: a shared point, and a ball that holds all shared points.
ContactFacts describeOverlap(const PairPiece& piece, const Instant& now, const ContactWitness& witness);

}  // namespace collision_node::impact

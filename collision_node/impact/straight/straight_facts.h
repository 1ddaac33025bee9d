/// A contact on a straight path as an event: closed forms instead of searches.
///
/// Guarantee: that of describeContact() (contact_facts.h); the facts hold at the bracket's start.
#pragma once

#include "collision_node/impact/straight/straight_path.h"

namespace collision_node::impact {

/// Fills `event`, a new one, as the CONFIRMED impact of a `contact` of kind kContact. Triangles that are met
/// in the bracket elsewhere than at the reported place make it `multiple`.
void writeStraight(const Piece& piece, const PairOptions& options, const StraightPath& path,
                   const PathContact& contact, PairEvent& event);

/// Who has passed a surface within the impact's bracket leaves it on the other side.
PairEvent separationBehind(PairEvent impact);

/// What a pair that was apart is, behind a contact on a straight path: a sphere touches; a point is inside
/// what it went into if that is solid, and apart again if that is a surface. Through several solids at once:
/// not known, kUndecided.
PairState::Phase phaseBehind(const StraightPath& path, const PathContact& contact);

}  // namespace collision_node::impact

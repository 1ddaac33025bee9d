/// Along which direction does a contact show the largest gap, and how far is it from the true normal?
#pragma once

#include <vector>

#include "collision_node/impact/convex/gap_model.h"

namespace collision_node::impact {

/// At a contact closest points no longer tell a direction. The best of: `first`, the features' own normals,
/// and the axes of instants at which the two were still (or again) well apart, turned on to now. A proposal:
/// bounds hold for any direction. `apart_at` [s] lies on the side in time on which the pair is apart.
Vec3 bestNormal(const PairPiece& piece, const Instant& now, const Element& ea, const Element& eb,
                const Closest& closest, const Vec3& first, double apart_at);

/// The direction across the nearest face of the difference of two cores that overlap; false when they have no
/// volume.
bool shallowestNormal(const PairPiece& piece, const Cores& cores, Vec3* n);

/// By how much each body may have turned since, or otherwise than computed, at most [rad].
struct Turned {
  double a, b;
};

/// For cores with a radius, n along their closest points: an angle to the true normal at any time at which
/// the two have moved by `moved` since, relative to each other, and turned [rad]. `plane_gap` is that of the
/// support planes across n, `gap` the same within what the contact allows, both > 2 moved.
double roundedCone(const PairPiece& piece, const Cores& cores, const Closest& closest, const Vec3& n,
                   double plane_gap, double gap, double moved, const Turned& turned);

}  // namespace collision_node::impact

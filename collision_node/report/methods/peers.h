/// Other people's libraries as contestants, each called the way its own sources say is right. Every function
/// gives null where the library was not found when this was built, or where the set holds shapes that it
/// cannot answer.
#pragma once

#include "collision_node/report/contestant.h"

namespace collision_node::report {

/// Conservative advancement by hand on fcl::distance (RSS trees, libccd for primitives): t += d / (|v_rel| +
/// w_a rho_a
/// + w_b rho_b), a hit at `gap` [m]. Meshes and primitives; any motion. Never late; a fly-by
/// within `gap` is a hit to it; no answer after 20 000 steps.
ContestantPtr makeFclAdvancement(const QuerySet& set, double gap = 1e-5);

/// fcl::collide (OBBRSS trees) at the ends of `steps` equal parts of the piece, as CCDC_NAIVE does. Meshes
/// and primitives; any motion. Its time is that of a sample in contact, and it sees no contact between two
/// samples.
ContestantPtr makeFclSamples(const QuerySet& set, int steps);

/// FCL's own stepping: 1000 samples (OBBRSS trees). Meshes; straight paths, less than half a turn.
ContestantPtr makeFclSampling(const QuerySet& set);

/// FCL's conservative advancement for pairs of primitives, with libccd; straight paths, cut into parts of
/// less than half a turn. (That of meshes passes through them.) Its times may be early by a few percent of
/// the piece, so they judge nobody's lateness.
ContestantPtr makeFclPrimitives(const QuerySet& set);

/// Embree's rtcIntersect1 on a robust scene, float: points against a mesh, straight paths without turning.
ContestantPtr makeEmbreeRays(const QuerySet& set);

/// Bullet's sweep of a sphere (convexSweepTest, one object) against a btBvhTriangleMeshShape or a sphere,
/// float; straight paths without turning. Its iteration may stop early by a few percent of the piece, so its
/// times judge nobody's lateness.
ContestantPtr makeBulletSweep(const QuerySet& set);

/// btContinuousConvexCollision for pairs of primitives on straight paths, with a margin of 1e-4 m. Bullet
/// clamps a turn to pi/4 within one call: the piece is cut so that none is longer. It stops at a gap of 1 mm
/// by its own choice.
ContestantPtr makeBulletContinuous(const QuerySet& set);

}  // namespace collision_node::report

/// Other people's libraries as contestants, each called the way its own sources say is right. Every function
/// gives null where the library was not found when this was built, or where the set holds shapes that it
/// cannot answer.
#pragma once

#include "collision_node/report/contestant.h"

namespace collision_node::report {

/// Conservative advancement by hand on fcl::distance (RSS trees): t += d / (|v_rel| + w_a rho_a + w_b rho_b),
/// a hit at 1e-5 m. Meshes; straight paths. Never late; a fly-by within 1e-5 m is a hit to it.
ContestantPtr makeFclAdvancement(const QuerySet& set);

/// FCL's own stepping: 1000 samples (OBBRSS trees). Meshes. Its time is that of a sample in contact: always
/// late by up to a thousandth of the piece, and it sees no contact between two samples.
ContestantPtr makeFclSampling(const QuerySet& set);

/// FCL's conservative advancement for pairs of primitives, with libccd. Its times may be early by a few
/// percent of the piece, so they judge nobody's lateness.
ContestantPtr makeFclPrimitives(const QuerySet& set);

/// Embree's rtcIntersect1 on a robust scene, float: points on straight lines against a mesh at rest.
ContestantPtr makeEmbreeRays(const QuerySet& set);

/// Bullet's sphere sweep on a btBvhTriangleMeshShape, float, mesh at rest. Its iteration may stop early by a
/// few percent of the piece, so its times judge nobody's lateness.
ContestantPtr makeBulletSweep(const QuerySet& set);

}  // namespace collision_node::report

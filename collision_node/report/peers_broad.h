/// Other people's broad phases, and one ray through a scene of boxes. Null where the library was not found
/// when this was built.
#pragma once

#include <memory>
#include <vector>

#include "collision_node/geometry/bvh.h"

namespace collision_node::report {

class BroadPeer {
 public:
  virtual ~BroadPeer() = default;
  /// Moves every object to its next box; how many pairs meet.
  virtual std::size_t pairs(const std::vector<geometry::Bounds>& boxes) = 0;
};

class RayPeer {
 public:
  virtual ~RayPeer() = default;
  virtual bool hits(const geometry::Vec3& from, const geometry::Vec3& to) = 0;
};

/// SSaPCollisionManager: sorted along three axes anew, swept along the one where fewest meet.
std::unique_ptr<BroadPeer> makeFclBroadPhase(const std::vector<geometry::Bounds>& boxes);
/// btDbvtBroadphase, boxes in float.
std::unique_ptr<BroadPeer> makeBulletBroadPhase(const std::vector<geometry::Bounds>& boxes);
/// Twelve triangles a box, float, robust.
std::unique_ptr<RayPeer> makeEmbreeBoxes(const std::vector<geometry::Bounds>& boxes);

}  // namespace collision_node::report

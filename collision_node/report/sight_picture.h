/// The paper's Figure 5: where a line-of-sight test puts the hits of shots at a driving target, where they
/// truly are, and which part of the target each names.
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "collision_node/report/scenes/tank.h"

namespace collision_node::report {

/// Both points in the tank's frame [m], on its surface; a sight that meets nothing has no point.
struct SightedShot {
  geometry::Vec3 truth, sight;
  std::string true_part, sighted_part;  ///< "turret/cockpit"; empty: nothing
};

/// Shots fired from where the demo's launcher hangs, 150 m away, that lead the tank. All hit.
std::vector<SightedShot> sightedShots(const Tank& tank);

/// The shots, and the tank's triangles with the name of their link, for whoever draws them.
void writeShots(std::ostream& out, const std::vector<SightedShot>& shots);
void writeTriangles(std::ostream& out, const Tank& tank);

}  // namespace collision_node::report

/// The report's scenes. Every one is a function of its seed and count alone; its truth comes from a closed
/// form or from the march in truth/, never from the solver.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "collision_node/report/trial.h"

namespace collision_node::report {

struct SceneMaker {
  std::size_t count, quick_count;  ///< queries of a full and of a quick run
  std::function<Trials(std::size_t count)> make;
};

std::vector<SceneMaker> allScenes();

/// The demo's tank at 15 m/s, as one mesh, and a shot at 2000 to 2400 m/s that leads it; points, or spheres
/// of 5 cm.
Trials tankShots(std::size_t count, double radius);

/// Two noisy spheres, 1000, 10 000 or 100 000 triangles each, both turn by up to half a turn.
Trials tumbling(int triangles, std::size_t count);
/// tumbling(1000) 1e8 m away from the world's origin.
Trials largeOffset(std::size_t count);
/// The same meshes, one in the other from the start.
Trials deepOverlap(std::size_t count);
/// A jagged splinter at 2000 m/s and 1e5 rad/s against a vehicle.
Trials highSpin(std::size_t count);
/// A ball through the disc of a blade that turns at 300 rad/s.
Trials spinningBlade(std::size_t count);
/// A shell on a cubic path against a driving vehicle.
Trials ballistic(std::size_t count);
/// 48 primitives within 4 m at up to 60 m/s, all pairs. `count` is the number of pairs that are kept.
Trials swarm(std::size_t count);

// Closed forms.
/// Two spheres that pass at their touching distance, give or take 1e-2 to 1e-10 m.
Trials grazingSpheres(std::size_t count);
/// The tip of a turning mesh over a plate, as close.
Trials grazingTip(std::size_t count);
/// A box over a plate at 10 m/s, faces parallel, that sinks by 1e-1 to 1e-5 m/s or not at all.
Trials sliding(std::size_t count);

}  // namespace collision_node::report

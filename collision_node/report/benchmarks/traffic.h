/// What moves in the rows of many objects.
#pragma once

#include <vector>

#include "collision_node/scene/broad_phase/sweep.h"

namespace collision_node::report {

constexpr int kTrafficSteps = 100;
constexpr double kTrafficStep = 0.01;  ///< [s]

/// By step, then by object: spheres at constant density, every tenth at 200 to 2000 m/s, the others at up to
/// 10 m/s; who leaves the cube turns round.
std::vector<std::vector<scene::Sweep>> traffic(std::size_t count);

/// The broad phase alone: every step's pairs of swept boxes that meet, but for those that thick lines keep
/// apart.
std::size_t pairsInTraffic(const std::vector<std::vector<scene::Sweep>>& steps);

}  // namespace collision_node::report

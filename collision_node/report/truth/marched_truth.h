/// Truth by a slow march that shares nothing with the solver but the input: 80 bit arithmetic, distances of
/// single triangles and primitives (the tests' oracle, test/oracle), and a tree of balls so that meshes need
/// not be looked at triangle by triangle.
#pragma once

#include "collision_node/report/trial.h"

namespace collision_node::report {

/// The first contact of each query. Never late: two parts are only moved on by their proved distance over a
/// bound of their speed. kUndecided where the two come within some 1e-16 of their size and no instant of
/// contact shows, or where `max_steps` are not enough. `point` is NaN where the first contact is not one
/// point, and at the start.
std::vector<Truth> marchedTruths(const QuerySet& set, std::int64_t max_steps = 20'000'000);

}  // namespace collision_node::report

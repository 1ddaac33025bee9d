/// Published vertex-face and edge-edge queries whose vertices move on straight lines, with exact verdicts:
/// read for measurements. Data: B. Wang et al., A Large Scale Benchmark and an Inclusion-Based Algorithm for
/// Continuous Collision Detection, ACM TOG 40(5), 2021.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <vector>

#include "collision_node/impact/linear/linear_features.h"

namespace collision_node::report {

/// Edges: a0 a1 b0 b1; else the vertex and the triangle's three.
struct LinearQuery {
  bool edges = false, made_by_hand = false;
  bool touches = false;  ///< the published truth
  std::array<impact::LinearVertex, 4> vertices;
};

/// All queries of a folder's .csv files, in the order of their names; empty where there is no such folder.
/// Throws std::runtime_error that names a file which is not of this kind.
std::vector<LinearQuery> readLinearQueries(const std::filesystem::path& folder);

/// FCL's Intersect, with Newton: whether they touch. Empty where FCL was not found when this was built.
std::optional<bool> fclLinearContact(const LinearQuery& query);

}  // namespace collision_node::report

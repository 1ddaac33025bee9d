#include "collision_node/report/benchmarks/rows.h"

namespace collision_node::report {
namespace {

QuerySet meshes1k(std::size_t count) { return tumblingMeshes(1000, count); }
QuerySet meshes10k(std::size_t count) { return tumblingMeshes(10000, count); }
QuerySet meshes100k(std::size_t count) { return tumblingMeshes(100000, count); }

ContestantPtr none(const QuerySet&) { return nullptr; }

}  // namespace

const std::vector<Row>& rows() {
  static const std::vector<Row> all = {
      {"mesh_1k", 200, meshes1k, "", none, 60.0},
      {"mesh_10k", 200, meshes10k, "", none, 100.0},
      {"mesh_100k", 100, meshes100k, "", none, 120.0},
      {"particle", 10000, particleShots, "", none, 1.0 / 1.2},
      {"sphere", 5000, sphereShots, "", none, 50.0},
      {"primitives", 2000, tumblingPrimitives, "", none, 12.0},
  };
  return all;
}

}  // namespace collision_node::report

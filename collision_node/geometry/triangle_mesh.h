/// An indexed triangle mesh, welded, with a report of what is odd about it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "collision_node/geometry/types.h"

namespace collision_node::geometry {

/// What the user says about a mesh; `kAuto` asks the edges.
enum class SolidChoice { kAuto, kYes, kNo };

/// What was found while loading. Counts are of the welded mesh.
struct MeshReport {
  std::string source;         ///< file, or what made it
  std::size_t vertices = 0;   ///< after welding exactly equal positions
  std::size_t triangles = 0;  ///< all are kept, odd ones too
  std::size_t degenerate_triangles =
      0;  ///< zero area in exact arithmetic: they are still hit, as a segment or point
  std::size_t duplicate_triangles = 0;  ///< same three vertices as an earlier one, either orientation
  std::size_t open_edges = 0;           ///< used by exactly one triangle
  std::size_t odd_edges = 0;            ///< used by more than two, or by two in the same direction
  bool closed = false;                  ///< every edge shared by exactly two oppositely directed triangles
  double coordinate_rounding = 0.0;     ///< [m] the file reader's float32 rounding, an upper bound; 0 if none
  Vec3 lower = Vec3::Zero();            ///< [m] axis-aligned bounds
  Vec3 upper = Vec3::Zero();
};

struct TriangleMesh {
  std::vector<Vec3> vertices;                          ///< [m]
  std::vector<std::array<std::int32_t, 3>> triangles;  ///< in file order: index = the triangle id in events
  bool solid = false;  ///< inside counts as touching (non-zero winding number)
  MeshReport report;
};

/// Welds vertices at exactly equal positions, fills the report, and decides `solid`.
/// Throws std::invalid_argument when empty, an index is out of range or a coordinate is not finite.
TriangleMesh makeTriangleMesh(std::vector<Vec3> vertices, std::vector<std::array<std::int32_t, 3>> triangles,
                              SolidChoice solid, const std::string& source);

}  // namespace collision_node::geometry

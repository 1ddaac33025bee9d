/// Triangles under a hierarchy of eight boxes a node, for paths: a node is tested with one load per plane.
///
/// Guarantee: every box holds the triangles below it in exact arithmetic, in the hierarchy's own units. The
/// same triangles give the same tree on any machine. Sources: I. Wald 2007 (binned surface area heuristic),
/// H. Ylitie, T. Karras, S. Laine 2017 (wide nodes by its cost).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "collision_node/geometry/types.h"

namespace collision_node::geometry {

/// Eight children. An empty lane's box is inside out, so that no path meets it.
struct alignas(32) WideNode {
  float plane[6][8];      ///< lower x y z, upper x y z, relative to WideBvh::centre(), times WideBvh::scale()
  std::int32_t child[8];  ///< >= 0: a node; < 0: leaf ~child
};

/// Up to four triangles; a missing one repeats the first's vertices and has element -1.
struct alignas(64) WideLeaf {
  std::int32_t vertex[3][4];
  std::int32_t element[4];
};

class WideBvh {
 public:
  using Corners = std::array<std::int32_t, 3>;

  /// Element i is the triangle `corners(i)` of `vertices`, for i < count; count >= 1. The vertices must
  /// outlive the hierarchy.
  template <typename CornersOf>
  WideBvh(const std::vector<Vec3>& vertices, std::int32_t count, const CornersOf& corners)
      : vertices_(vertices.data()) {
    std::vector<Corners> triangles(static_cast<std::size_t>(count));
    for (std::int32_t i = 0; i < count; ++i) triangles[static_cast<std::size_t>(i)] = corners(i);
    build(triangles);
  }

  static constexpr int kStack = 1024;  ///< more than a depth-first walk can have waiting: 7 for each level

  const Vec3* vertices() const { return vertices_; }
  const std::vector<WideNode>& nodes() const { return nodes_; }  ///< [0] is the root
  const std::vector<WideLeaf>& leaves() const { return leaves_; }
  const Vec3& centre() const { return centre_; }  ///< of the box of all triangles [m]
  double scale() const { return scale_; }         ///< [1/m] a power of two; boxes lie within [-1.1, 1.1]
  const Vec3& half() const { return half_; }      ///< half extents of that box, rounded up [m]
  std::size_t bytes() const { return nodes_.size() * sizeof(WideNode) + leaves_.size() * sizeof(WideLeaf); }

 private:
  void build(const std::vector<Corners>& triangles);

  const Vec3* vertices_;
  std::vector<WideNode> nodes_;
  std::vector<WideLeaf> leaves_;
  Vec3 centre_ = Vec3::Zero(), half_ = Vec3::Zero();
  double scale_ = 1.0;
};

}  // namespace collision_node::geometry

/// The tested geometry as triangles, for pictures only.
#pragma once

#include <vector>

#include "collision_node/geometry/shape.h"

namespace collision_node::messages {

/// Corner triples in the frame that `shape` is placed in. Round shapes are drawn with 24 segments; a point as
/// a small octahedron; a convex shape by the triangles of its file; a mesh of more than kMostTriangles by its
/// bounding box.
std::vector<geometry::Vec3> drawnTriangles(const geometry::PlacedShape& shape);

constexpr std::size_t kMostTriangles = 20000;

}  // namespace collision_node::messages

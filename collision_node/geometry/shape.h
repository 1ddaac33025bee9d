/// The shapes a scene may name (DESIGN: axis z, origin at the centre), as plain data.
#pragma once

#include <memory>
#include <string>
#include <variant>

#include "collision_node/geometry/triangle_mesh.h"
#include "collision_node/geometry/types.h"

namespace collision_node::geometry {

struct Point {};
struct Sphere {
  double radius;  ///< [m], > 0
};
struct Box {
  Vec3 size;  ///< full lengths [m], each > 0
};
struct Cylinder {
  double radius;  ///< [m], > 0
  double length;  ///< full length along z [m], > 0
};
struct Capsule {
  double radius;  ///< [m], > 0
  double length;  ///< between the cap centres, along z [m], >= 0
};
/// The triangles as loaded; a solid when `mesh->solid`, else a surface.
struct Mesh {
  std::shared_ptr<const TriangleMesh> mesh;
};
/// The convex hull of the mesh's vertices, a solid.
struct Convex {
  std::shared_ptr<const TriangleMesh> mesh;
};

using Shape = std::variant<Point, Sphere, Box, Cylinder, Capsule, Mesh, Convex>;

/// A shape and where it sits in its parent frame (a link's or an object's).
struct PlacedShape {
  Shape shape;
  Pose origin;         ///< parent <- shape
  std::string source;  ///< for messages to people: "sphere", or the mesh file as the user wrote it
};

}  // namespace collision_node::geometry

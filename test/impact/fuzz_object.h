/// One random body of the fuzz test, and a point of it to aim at.
#pragma once

#include <string>
#include <vector>

#include "test/impact/fuzz_shapes.h"

namespace fuzz {

struct Object {
  std::vector<collision_node::geometry::PlacedShape> shapes;
  std::string kind;
  collision_node::geometry::Vec3 aim = collision_node::geometry::Vec3::Zero();  ///< a point of the body
  double reach = 0;
};

/// A shape of about the given size [m]; one in ten has a second one beside it.
Object makeObject(Random& random, ShapeKind kind, double scale);

}  // namespace fuzz

#pragma once

#include "collision_node/geometry/types.h"

namespace collision_node::impact {

/// The closest point of a triangle by the region of its plane that x lies over (C. Ericson 2005). A proposal:
/// what is proved from it holds for any point of the triangle.
geometry::Vec3 closestOnTriangle(const geometry::Vec3& x, const geometry::Vec3& a, const geometry::Vec3& b,
                                 const geometry::Vec3& c);

}  // namespace collision_node::impact

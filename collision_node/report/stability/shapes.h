/// Small meshes of the walk, exact in doubles.
#pragma once

#include "collision_node/report/made_meshes.h"

namespace collision_node::report {

MeshPtr cubeMesh(double size);     ///< 12 triangles, `size` its full length [m]
MeshPtr tetrahedron(double size);  ///< 4 triangles, lopsided, inside a cube of that size
MeshPtr moved(const geometry::TriangleMesh& mesh, const geometry::Vec3& by);
/// Four slivers side by side, each an angle of `angle` [rad] at one common tip, two legs of 1 m.
MeshPtr sliverFan(double angle);

}  // namespace collision_node::report

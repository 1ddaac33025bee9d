#include "collision_node/report/stability/shapes.h"

#include <cmath>

namespace collision_node::report {
namespace {

using geometry::Vec3;
using Triangles = std::vector<std::array<std::int32_t, 3>>;

MeshPtr mesh(std::vector<Vec3> vertices, Triangles triangles, const char* name) {
  return std::make_shared<geometry::TriangleMesh>(geometry::makeTriangleMesh(
      std::move(vertices), std::move(triangles), geometry::SolidChoice::kAuto, name));
}

}  // namespace

MeshPtr cubeMesh(double size) {
  std::vector<Vec3> v;
  for (int i = 0; i < 8; ++i) {
    v.emplace_back((i & 1 ? 0.5 : -0.5) * size, (i & 2 ? 0.5 : -0.5) * size, (i & 4 ? 0.5 : -0.5) * size);
  }
  return mesh(std::move(v),
              {{0, 2, 3},
               {0, 3, 1},
               {4, 5, 7},
               {4, 7, 6},
               {0, 1, 5},
               {0, 5, 4},
               {2, 6, 7},
               {2, 7, 3},
               {0, 4, 6},
               {0, 6, 2},
               {1, 3, 7},
               {1, 7, 5}},
              "cube");
}

MeshPtr tetrahedron(double size) {
  const std::vector<Vec3> v = {size * Vec3(-0.5, -0.4, -0.375), size * Vec3(0.5, -0.25, -0.45),
                               size * Vec3(0.125, 0.5, -0.3), size * Vec3(-0.0625, 0.1, 0.5)};
  return mesh(v, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}, "tetrahedron");
}

MeshPtr moved(const geometry::TriangleMesh& from, const Vec3& by) {
  std::vector<Vec3> v = from.vertices;
  for (auto& p : v) p += by;
  return mesh(std::move(v), from.triangles, from.report.source.c_str());
}

MeshPtr sliverFan(double angle) {
  std::vector<Vec3> v = {Vec3::Zero()};
  Triangles triangles;
  for (int i = 0; i <= 4; ++i) v.emplace_back(std::cos(i * angle), std::sin(i * angle), 0.0);
  for (int i = 1; i <= 4; ++i) triangles.push_back({0, i, i + 1});
  return mesh(std::move(v), std::move(triangles), "slivers");
}

}  // namespace collision_node::report

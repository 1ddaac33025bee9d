#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "collision_node/geometry/convex_hull.h"
#include "collision_node/geometry/triangle_mesh.h"

namespace collision_node::geometry {
namespace {

using Triangles = std::vector<std::array<std::int32_t, 3>>;

const std::vector<Vec3> kTetrahedron = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
const Triangles kOutward = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};

std::string refusal(std::vector<Vec3> vertices, Triangles triangles, SolidChoice solid = SolidChoice::kAuto) {
  try {
    makeTriangleMesh(std::move(vertices), std::move(triangles), solid, "m.stl");
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

#define EXPECT_HAS(text, part) \
  EXPECT_NE((text).find(part), std::string::npos) << "no \"" << (part) << "\" in:\n" << (text)

TEST(MeshReport, ClosedTetrahedronIsSolid) {
  const TriangleMesh mesh = makeTriangleMesh(kTetrahedron, kOutward, SolidChoice::kAuto, "m.stl");
  EXPECT_TRUE(mesh.solid);
  EXPECT_TRUE(mesh.report.closed);
  EXPECT_EQ(mesh.report.source, "m.stl");
  EXPECT_EQ(mesh.report.vertices, 4u);
  EXPECT_EQ(mesh.report.triangles, 4u);
  EXPECT_EQ(mesh.report.degenerate_triangles, 0u);
  EXPECT_EQ(mesh.report.duplicate_triangles, 0u);
  EXPECT_EQ(mesh.report.lower, Vec3(0, 0, 0));
  EXPECT_EQ(mesh.report.upper, Vec3(1, 1, 1));
  EXPECT_EQ(mesh.report.coordinate_rounding, 0.0);
  EXPECT_FALSE(makeTriangleMesh(kTetrahedron, kOutward, SolidChoice::kNo, "m.stl").solid);
}

TEST(MeshReport, WeldsEqualPositionsOnlyAndKeepsTriangleOrder) {
  std::vector<Vec3> vertices;
  Triangles triangles;
  for (const auto& corners : kOutward) {
    const auto first = static_cast<std::int32_t>(vertices.size());
    for (const std::int32_t corner : corners) vertices.push_back(kTetrahedron[corner]);
    triangles.push_back({first, first + 1, first + 2});
  }
  vertices[0].x() = -0.0;  // equal to 0, other bits
  const TriangleMesh mesh = makeTriangleMesh(vertices, triangles, SolidChoice::kAuto, "m");
  EXPECT_EQ(mesh.report.vertices, 4u);
  EXPECT_TRUE(mesh.solid);
  EXPECT_FALSE(std::signbit(mesh.vertices[0].x()));  // whichever zero came first, the same bytes come out
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k) EXPECT_EQ(mesh.vertices[mesh.triangles[t][k]], vertices[triangles[t][k]]);
  }

  vertices[1].y() = std::nextafter(1.0, 2.0);  // one step off: another vertex, so the mesh is open
  const TriangleMesh torn = makeTriangleMesh(vertices, triangles, SolidChoice::kAuto, "m");
  EXPECT_EQ(torn.report.vertices, 5u);
  EXPECT_FALSE(torn.solid);
  EXPECT_GT(torn.report.open_edges, 0u);
}

TEST(MeshReport, OpenEdgesAreCountedAndSolidYesIsRefused) {
  const Triangles open(kOutward.begin(), kOutward.end() - 1);
  const TriangleMesh mesh = makeTriangleMesh(kTetrahedron, open, SolidChoice::kAuto, "m");
  EXPECT_FALSE(mesh.solid);
  EXPECT_EQ(mesh.report.open_edges, 3u);
  EXPECT_EQ(mesh.report.odd_edges, 0u);
  const std::string text = refusal(kTetrahedron, open, SolidChoice::kYes);
  EXPECT_HAS(text, "m.stl: solid: yes, but the mesh is not closed: 3 open edges and 0 odd ones");
  EXPECT_HAS(text, "say solid: auto or no");
}

TEST(MeshReport, ATurnedTriangleAndAFinMakeOddEdges) {
  Triangles turned = kOutward;
  std::swap(turned[0][1], turned[0][2]);
  const MeshReport report = makeTriangleMesh(kTetrahedron, turned, SolidChoice::kAuto, "m").report;
  EXPECT_EQ(report.open_edges, 0u);
  EXPECT_EQ(report.odd_edges, 3u);
  EXPECT_FALSE(report.closed);

  std::vector<Vec3> vertices = kTetrahedron;
  vertices.push_back({5, 5, 5});
  Triangles fin = kOutward;
  fin.push_back({0, 1, 4});
  const MeshReport with_fin = makeTriangleMesh(vertices, fin, SolidChoice::kAuto, "m").report;
  EXPECT_EQ(with_fin.open_edges, 2u);
  EXPECT_EQ(with_fin.odd_edges, 1u);
}

TEST(MeshReport, DegenerateIsDecidedExactly) {
  // The third corner is exactly on the line, then one step beside it; a naive cross product rounds to 0 for
  // both.
  const auto count = [](const Vec3& a, const Vec3& b, const Vec3& c) {
    return makeTriangleMesh({a, b, c}, {{0, 1, 2}}, SolidChoice::kAuto, "m").report.degenerate_triangles;
  };
  EXPECT_EQ(count({0, 0, 0}, {1, 1, 1}, {2, 2, 2}), 1u);
  EXPECT_EQ(count({0, 0, 0}, {1, 1, 1}, {2, 2, std::nextafter(2.0, 3.0)}), 0u);
  const Vec3 far(1e7, 1e7, 1e7);
  EXPECT_EQ(count(far, far + Vec3(1, 1, 1), far + Vec3(3, 3, 3)), 1u);
  // Points 12 and 24 of the line y = x, and 0.5 moved by single steps near it.
  const double step = 0x1p-53;
  EXPECT_EQ(count({0.5, 0.5, 0}, {12, 12, 0}, {24, 24, 0}), 1u);
  EXPECT_EQ(count({0.5, 0.5 + 2 * step, 0}, {12, 12, 0}, {24, 24, 0}), 0u);
  EXPECT_EQ(count({0.1, 0.1, 0}, {0.3, 0.3, 0}, {0.7, 0.7, 0}), 1u);
  EXPECT_EQ(count({1, 2, 3}, {1, 2, 3}, {4, 5, 6}), 1u);
}

TEST(MeshReport, DegenerateAgreesWithIntegersOnRandomGrids) {
  const unsigned seed = 20240607;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  std::uniform_int_distribution<std::int64_t> coordinate(-2, 2);
  int degenerate = 0;
  for (int i = 0; i < 5000; ++i) {
    std::int64_t p[3][3];
    std::vector<Vec3> vertices;
    for (auto& point : p) {
      for (auto& value : point) value = coordinate(random);
      vertices.emplace_back(point[0], point[1], point[2]);
      vertices.back() = vertices.back() * 0x1p-30 + Vec3(4096, -4096, 1024);  // exact, far from the origin
    }
    bool zero = true;
    for (int axis = 0; axis < 3; ++axis) {
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      zero = zero && (p[0][u] - p[2][u]) * (p[1][v] - p[2][v]) == (p[0][v] - p[2][v]) * (p[1][u] - p[2][u]);
    }
    const MeshReport report = makeTriangleMesh(vertices, {{0, 1, 2}}, SolidChoice::kAuto, "m").report;
    ASSERT_EQ(report.degenerate_triangles, zero ? 1u : 0u) << "triangle " << i;
    degenerate += zero;
  }
  EXPECT_GT(degenerate, 100);
}

TEST(MeshReport, DuplicatesInEitherOrientationAreCounted) {
  Triangles triangles = kOutward;
  triangles.push_back({2, 1, 0});
  triangles.push_back({1, 2, 0});
  const MeshReport report = makeTriangleMesh(kTetrahedron, triangles, SolidChoice::kAuto, "m").report;
  EXPECT_EQ(report.duplicate_triangles, 2u);
  EXPECT_EQ(report.triangles, 6u);
  EXPECT_FALSE(report.closed);
}

TEST(MeshReport, ACollapsedTriangleNeitherOpensNorClosesTheSurface) {
  std::vector<Vec3> vertices = kTetrahedron;
  vertices.push_back(kTetrahedron[0]);
  Triangles triangles = kOutward;
  triangles.push_back({0, 4, 1});
  const TriangleMesh mesh = makeTriangleMesh(vertices, triangles, SolidChoice::kAuto, "m");
  EXPECT_TRUE(mesh.solid);
  EXPECT_EQ(mesh.report.degenerate_triangles, 1u);
  EXPECT_EQ(mesh.report.triangles, 5u);
  EXPECT_FALSE(makeTriangleMesh({{1, 1, 1}}, {{0, 0, 0}}, SolidChoice::kAuto, "m").report.closed);
}

TEST(MeshReport, BadInputIsRefused) {
  EXPECT_HAS(refusal(kTetrahedron, {}), "m.stl: no triangle");
  EXPECT_HAS(refusal(kTetrahedron, {{0, 1, 4}}), "triangle 0 names vertex 4; there are 4");
  EXPECT_HAS(refusal(kTetrahedron, {{0, -1, 2}}), "names vertex -1");
  for (const double bad : {std::nan(""), HUGE_VAL}) {
    EXPECT_HAS(refusal({{0, 0, 0}, {1, bad, 0}, {0, 1, 0}}, {{0, 1, 2}}),
               "vertex 1 has a coordinate that is not finite");
  }
}

// ---- hullVertices: "the hull of the result is the hull of the input"

TEST(HullVertices, KeepsEveryCornerAndOrderAndDropsDuplicates) {
  std::vector<Vec3> cube;
  for (int i = 0; i < 8; ++i) cube.emplace_back(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
  std::vector<Vec3> points = cube;
  points.push_back({0, 0.1, -0.05});
  points.push_back(cube[3]);
  points.push_back({0.2, 0.2, 0.1});
  const std::vector<Vec3> hull = hullVertices(points);
  ASSERT_GE(hull.size(), 8u);
  for (std::size_t i = 0; i < 8; ++i) EXPECT_EQ(hull[i], cube[i]);
  EXPECT_LT(hull.size(), points.size());
}

TEST(HullVertices, SupportIsUnchangedInEveryDirection) {
  const unsigned seed = 4711;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  const auto draw = [&] { return Vec3(normal(random), normal(random), normal(random)); };
  for (const Vec3& scale :
       {Vec3(1, 1, 1), Vec3(1, 1, 1e-9), Vec3(1, 0, 0), Vec3(0, 0, 0), Vec3(1e6, 1e-3, 1)}) {
    std::vector<Vec3> points;
    for (int i = 0; i < 2000; ++i) points.push_back(draw().cwiseProduct(scale));
    const std::vector<Vec3> hull = hullVertices(points);
    ASSERT_FALSE(hull.empty());
    if (scale == Vec3(1, 1, 1)) {
      EXPECT_LT(hull.size(), 800u);
    }
    for (int i = 0; i < 2000; ++i) {
      const Vec3 direction = draw();
      double all = -HUGE_VAL, kept = -HUGE_VAL;
      for (const Vec3& p : points) all = std::max(all, p.dot(direction));
      for (const Vec3& p : hull) kept = std::max(kept, p.dot(direction));
      ASSERT_EQ(all, kept);
    }
  }
  EXPECT_TRUE(hullVertices({}).empty());
}

}  // namespace
}  // namespace collision_node::geometry

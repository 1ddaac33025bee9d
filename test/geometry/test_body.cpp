/// The hierarchy's promises (body.h): boxes hold their elements, rounded outward; reach and radius bound
/// every point; ids name triangles and shapes; the same input gives the same tree.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>
#include <set>
#include <stdexcept>
#include <string>

#include "collision_node/geometry/body.h"
#include "test/oracle/vec.h"

namespace collision_node::geometry {
namespace {

using oracle::Real;
using Corners = std::array<std::int32_t, 3>;

constexpr unsigned kSeed = 20240707;

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double in(double lo, double hi) { return lo + (hi - lo) * static_cast<double>(engine_() >> 11) * 0x1p-53; }
  Vec3 vec(double size) { return {in(-size, size), in(-size, size), in(-size, size)}; }
  Pose pose(double size) {
    return {vec(size), Quat(in(-1, 1), in(-1, 1), in(-1, 1), in(-1, 1)).normalized()};
  }

 private:
  std::mt19937_64 engine_;
};

PlacedShape meshShape(std::vector<Vec3> vertices, std::vector<Corners> triangles, const Pose& origin = {}) {
  auto mesh = makeTriangleMesh(std::move(vertices), std::move(triangles), SolidChoice::kAuto, "made");
  return {Mesh{std::make_shared<TriangleMesh>(std::move(mesh))}, origin, "mesh"};
}

PlacedShape tetrahedron(double size, const Pose& origin = {}) {
  return meshShape({{0, 0, 0}, {size, 0, 0}, {0, size, 0}, {0, 0, size}},
                   {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}, origin);
}

/// Triangles of all sizes strewn about.
PlacedShape soup(Random& random, int count, const Pose& origin) {
  std::vector<Vec3> vertices;
  std::vector<Corners> triangles;
  for (int i = 0; i < count; ++i) {
    const Vec3 at = random.vec(3);
    const double size = std::pow(10.0, random.in(-4, 0));
    for (int k = 0; k < 3; ++k) vertices.push_back(at + random.vec(size));
    triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return meshShape(std::move(vertices), std::move(triangles), origin);
}

std::vector<PlacedShape> everyShape(Random& random, int triangles) {
  const PlacedShape hull = soup(random, 4, random.pose(2));
  return {{Box{{0.3, 2.0, 0.07}}, random.pose(2), "box"},
          soup(random, triangles, random.pose(2)),
          {Sphere{0.7}, random.pose(2), "sphere"},
          {Cylinder{0.4, 3.0}, random.pose(2), "cylinder"},
          tetrahedron(0.5, random.pose(2)),
          {Capsule{0.2, 1.5}, random.pose(2), "capsule"},
          {Point{}, random.pose(2), "point"},
          {Convex{std::get<Mesh>(hull.shape).mesh}, hull.origin, "convex"}};
}

/// Rough ground of `along` times `along` squares, whose triangles share their corners and come in any order.
PlacedShape ground(Random& random, int along, const Pose& origin) {
  std::vector<Vec3> vertices;
  std::vector<Corners> triangles;
  for (int i = 0; i <= along; ++i)
    for (int k = 0; k <= along; ++k) vertices.push_back({0.1 * i, 0.1 * k, random.in(0.0, 0.02)});
  for (int i = 0; i < along; ++i) {
    for (int k = 0; k < along; ++k) {
      const int first = (along + 1) * i + k, next = first + along + 1;
      triangles.push_back({first, first + 1, next});
      triangles.push_back({next, first + 1, next + 1});
    }
  }
  for (std::size_t i = triangles.size(); i > 1; --i)
    std::swap(triangles[i - 1], triangles[static_cast<std::size_t>(random.in(0.0, static_cast<double>(i)))]);
  return meshShape(std::move(vertices), std::move(triangles), origin);
}

constexpr int kMany = 20000;  ///< enough for the upper levels to be split between the cells of a grid

struct Range {
  Real lower[3], upper[3];
};

/// The element's exact extent along the frame's axes.
Range rangeOf(const Element& e) {
  Range range;
  for (int k = 0; k < 3; ++k) {
    if (e.vertices != nullptr) {
      range.lower[k] = range.upper[k] = e.vertices[0][k];
      for (int i = 1; i < e.count; ++i) {
        range.lower[k] = std::min<Real>(range.lower[k], e.vertices[i][k]);
        range.upper[k] = std::max<Real>(range.upper[k], e.vertices[i][k]);
      }
    } else {
      const Real along = e.axis[k], p = e.axis[(k + 1) % 3], q = e.axis[(k + 2) % 3];
      const Real reach = e.half_length * std::abs(along) + e.rim_radius * std::sqrt(p * p + q * q);
      range.lower[k] = e.centre[k] - reach;
      range.upper[k] = e.centre[k] + reach;
    }
    range.lower[k] -= e.radius;
    range.upper[k] += e.radius;
  }
  return range;
}

/// The element's point that lies farthest from `from`, or a bound that is not below it.
Real farthest(const Element& e, const Vec3& from) {
  Real far = 0;
  if (e.vertices != nullptr) {
    for (int i = 0; i < e.count; ++i)
      far = std::max(far, oracle::norm(oracle::exact(e.vertices[i]) - oracle::exact(from)));
  } else {
    const oracle::V3 x = oracle::exact(e.centre) - oracle::exact(from), axis = oracle::exact(e.axis);
    const Real along = std::abs(oracle::dot(x, axis)) + e.half_length;
    const Real across = oracle::norm(oracle::cross(x, axis)) + e.rim_radius;
    far = std::sqrt(along * along + across * across);
  }
  return far + e.radius;
}

void collect(const Body& body, std::int32_t node, std::vector<std::int32_t>& elements) {
  if (!body.bvh().exists(node)) return;
  const BvhNode n = body.bvh()[node];
  if (n.leaf()) {
    elements.push_back(n.element());
    return;
  }
  for (int i = 0; i < BvhBlock::kWidth; ++i) collect(body, BvhBlock::kWidth * n.link + i, elements);
}

TEST(Body, EveryElementLiesInEveryAncestorsBoxAndReach) {
  // "Boxes are axis-aligned in the object's frame and hold their elements, rounded outward"; "reach >=
  // distance of any point of the node from the frame's origin".
  Random random(kSeed);
  for (int round = 0; round <= 21; ++round) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + " round " + std::to_string(round));
    std::vector<PlacedShape> shapes = everyShape(random, round == 20 ? kMany : 1 + 10 * round);
    if (round > 20) shapes.push_back(ground(random, 100, random.pose(2)));
    const Body body(shapes);
    std::vector<std::int32_t> all;
    collect(body, 0, all);
    EXPECT_EQ(static_cast<std::int32_t>(all.size()), body.elementCount());
    EXPECT_EQ(std::set<std::int32_t>(all.begin(), all.end()).size(), all.size())
        << "an element in two leaves";
    for (std::int32_t node = 0; node < body.bvh().size(); ++node) {
      if (!body.bvh().exists(node)) continue;
      const BvhNode n = body.bvh()[node];
      const Vec3 origin = body.bvh().origin();
      std::vector<std::int32_t> below;
      collect(body, node, below);
      for (const std::int32_t id : below) {
        Vec3 buffer[3];
        const Element e = body.element(id, buffer);
        const Range range = rangeOf(e);
        for (int k = 0; k < 3; ++k) {
          EXPECT_LE(static_cast<Real>(origin[k]) + n.centre[k] - n.half[k], range.lower[k])
              << "node " << node << " id " << id;
          EXPECT_GE(static_cast<Real>(origin[k]) + n.centre[k] + n.half[k], range.upper[k])
              << "node " << node << " id " << id;
        }
        EXPECT_GE(n.reach, static_cast<double>(farthest(e, Vec3::Zero()))) << "node " << node << " id " << id;
      }
    }
  }
}

/// By how much a node's box is larger than its elements need, over the body's size.
Real looseness(const Body& body, std::int32_t node) {
  std::vector<std::int32_t> below;
  collect(body, node, below);
  Range all;
  for (std::size_t i = 0; i < below.size(); ++i) {
    Vec3 buffer[3];
    const Range range = rangeOf(body.element(below[i], buffer));
    for (int k = 0; k < 3; ++k) {
      all.lower[k] = i == 0 ? range.lower[k] : std::min(all.lower[k], range.lower[k]);
      all.upper[k] = i == 0 ? range.upper[k] : std::max(all.upper[k], range.upper[k]);
    }
  }
  const BvhNode n = body.bvh()[node];
  const Vec3 origin = body.bvh().origin();
  Real worst = 0;
  const Real scale = body.reach();  // boxes are floats relative to the whole body
  for (int k = 0; k < 3; ++k) {
    worst = std::max({worst, all.lower[k] - (static_cast<Real>(origin[k]) + n.centre[k] - n.half[k]),
                      static_cast<Real>(origin[k]) + n.centre[k] + n.half[k] - all.upper[k]});
  }
  return worst / scale;
}

TEST(Body, BoxesAreTight) {
  Random random(kSeed + 1);
  Real worst = 0;
  for (int round = 0; round < 10; ++round) {
    const Body body(everyShape(random, 40));
    for (std::int32_t node = 0; node < body.bvh().size(); ++node) {
      if (body.bvh().exists(node)) worst = std::max(worst, looseness(body, node));
    }
  }
  EXPECT_LT(static_cast<double>(worst), 4e-7) << "seed " << kSeed + 1;
}

TEST(Body, EveryTriangleLiesInEveryAncestorsPlate) {
  // "|plate . (p - origin) - middle| <= half for every point p of the node", in exact arithmetic.
  Random random(kSeed + 7);
  int plates = 0;
  for (int round = 0; round <= 16; ++round) {
    SCOPED_TRACE("seed " + std::to_string(kSeed + 7) + " round " + std::to_string(round));
    std::vector<PlacedShape> shapes = everyShape(random, round == 10 ? kMany : 1 + 20 * round);
    if (round > 10) shapes.push_back(ground(random, round == 16 ? 100 : round, random.pose(2)));
    const Body body(shapes);
    const oracle::V3 origin = oracle::exact(body.bvh().origin());
    for (std::int32_t node = 0; node < body.bvh().size(); ++node) {
      if (!body.bvh().exists(node)) continue;
      const BvhNode n = body.bvh()[node];
      const Vec3 axis(n.plate[0], n.plate[1], n.plate[2]);
      EXPECT_LE(axis.norm(), kPlateLength);
      if (axis.isZero(0.0)) continue;
      ++plates;
      std::vector<std::int32_t> below;
      collect(body, node, below);
      for (const std::int32_t id : below) {
        Vec3 buffer[3];
        const Element e = body.element(id, buffer);
        ASSERT_GE(e.triangle, 0) << "a plate around something that is no triangle";
        for (int i = 0; i < 3; ++i) {
          const Real along = oracle::dot(oracle::exact(axis), oracle::exact(e.vertices[i]) - origin);
          EXPECT_LE(std::abs(along - static_cast<Real>(n.plate_middle)), static_cast<Real>(n.plate_half));
        }
      }
    }
  }
  EXPECT_GT(plates, 100);
}

TEST(Body, BoxOfAnUprightCylinderIsTight) {
  const Body body({{Cylinder{0.5, 2.0}, {}, "cylinder"}});
  EXPECT_LT(static_cast<double>(looseness(body, 0)), 4e-7);
}

TEST(Body, BoundsOfThePrimitives) {
  // Sizes are full lengths, a capsule's length runs between its cap centres, axis z, origin at the centre.
  const auto expectHalf = [](const Shape& shape, const Vec3& half) {
    const Body body({{shape, {}, "one"}});
    EXPECT_LT((body.bvh().half(0) - half).cwiseAbs().maxCoeff(), 1e-6) << "shape " << shape.index();
    EXPECT_LT(body.centre().norm(), 1e-15);
    EXPECT_TRUE(body.bvh()[Bvh::kRoot].leaf());
  };
  expectHalf(Point{}, {0, 0, 0});
  expectHalf(Sphere{0.25}, {0.25, 0.25, 0.25});
  expectHalf(Box{{1.0, 2.0, 3.0}}, {0.5, 1.0, 1.5});
  expectHalf(Cylinder{0.5, 3.0}, {0.5, 0.5, 1.5});
  expectHalf(Capsule{0.5, 3.0}, {0.5, 0.5, 2.0});
}

TEST(Body, ReachAndRadiusBoundEveryPoint) {
  Random random(kSeed + 2);
  for (int round = 0; round < 20; ++round) {
    SCOPED_TRACE("seed " + std::to_string(kSeed + 2) + " round " + std::to_string(round));
    const Body body(everyShape(random, 25));
    Vec3 buffer[3];
    Real farthest_from_centre = 0;
    for (std::int32_t id = 0; id < body.elementCount(); ++id) {
      const Element e = body.element(id, buffer);
      EXPECT_LE(static_cast<double>(farthest(e, Vec3::Zero())), body.reach());
      farthest_from_centre = std::max(farthest_from_centre, farthest(e, body.centre()));
    }
    EXPECT_LE(static_cast<double>(farthest_from_centre), body.radius());
  }
}

TEST(Body, IdsNameShapesAndTriangles) {
  Random random(kSeed + 3);
  const std::vector<PlacedShape> shapes = everyShape(random, 7);
  const Body body(shapes);
  std::set<std::pair<int, int>> seen;
  Vec3 buffer[3];
  for (std::int32_t id = 0; id < body.elementCount(); ++id) {
    const Element e = body.element(id, buffer);
    ASSERT_GE(e.shape, 0);
    ASSERT_LT(e.shape, static_cast<int>(shapes.size()));
    EXPECT_TRUE(seen.insert({e.shape, e.triangle}).second)
        << "shape " << e.shape << " triangle " << e.triangle;
    const PlacedShape& placed = shapes[e.shape];
    const auto* mesh = std::get_if<Mesh>(&placed.shape);
    ASSERT_EQ(mesh != nullptr, e.triangle >= 0);
    if (mesh == nullptr) continue;
    const Corners& corners = mesh->mesh->triangles[e.triangle];
    for (int k = 0; k < 3; ++k) {
      EXPECT_LT((e.vertices[k] - placed.origin * mesh->mesh->vertices[corners[k]]).norm(), 1e-14);
    }
  }
  EXPECT_EQ(seen.size(), 7u + 4u + 6u);  // soup, tetrahedron, six primitives
  ASSERT_EQ(body.solids().size(), 1u);   // the soup is open
  EXPECT_EQ(body.solids()[0], 4);
}

TEST(Body, OneRepresentativeForEveryConnectedComponent) {
  // "One point of every connected component of the body."
  std::vector<Vec3> vertices;
  std::vector<Corners> triangles;
  for (int part = 0; part < 3; ++part) {
    const int base = 4 * part;
    for (const Vec3& v : {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)})
      vertices.push_back(v + Vec3(10.0 * part, 0, 0));
    for (const Corners& c : {Corners{0, 2, 1}, Corners{1, 2, 3}}) {
      triangles.push_back({base + c[0], base + c[1], base + c[2]});
    }
  }
  std::rotate(triangles.begin(), triangles.begin() + 3,
              triangles.end());  // components need not come in order
  Pose origin;
  origin.position = {0, 0, 5};
  const Body body(
      {meshShape(vertices, triangles, origin), {Sphere{1.0}, {{100, 0, 0}, Quat::Identity()}, "s"}});
  ASSERT_EQ(body.representatives().size(), 4u);
  std::multiset<int> found;
  for (const Vec3& p : body.representatives())
    found.insert(static_cast<int>(std::round(p.x() / 10.0 - 0.04)));
  EXPECT_EQ(found, (std::multiset<int>{0, 1, 2, 10}));
}

TEST(Body, TheSameInputGivesTheSameTree) {
  Random random_a(kSeed + 4), random_b(kSeed + 4);
  const Body first(everyShape(random_a, 500)), second(everyShape(random_b, 500));
  ASSERT_EQ(first.bvh().size(), second.bvh().size());
  for (std::int32_t i = 0; i < first.bvh().size(); ++i) {
    const BvhNode x = first.bvh()[i], y = second.bvh()[i];
    EXPECT_EQ(std::memcmp(&x, &y, sizeof x), 0) << "node " << i;
  }
}

TEST(Body, ManyTrianglesAtOnePlaceStillMakeATree) {
  std::vector<Vec3> vertices = {{1, 1, 1}, {2, 1, 1}, {1, 2, 1}};
  const Body body({meshShape(vertices, std::vector<Corners>(300, Corners{0, 1, 2}))});
  std::vector<std::int32_t> all;
  collect(body, 0, all);
  EXPECT_EQ(all.size(), 300u);
}

TEST(Body, RefusesNoShapes) { EXPECT_THROW(Body({}), std::invalid_argument); }

TEST(Body, RefusesWhatReachesTooFar) {
  // "beyond kLargestLength": a box of the tree would be infinite, and nothing could be proved.
  const auto refusal = [](const Shape& shape, const Vec3& at) -> std::string {
    try {
      Body({{shape, {at, Quat::Identity()}, "it"}});
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  const Vec3 here = Vec3::Zero();
  EXPECT_EQ(refusal(Sphere{0.999e15}, here), "");
  EXPECT_EQ(refusal(Sphere{1e39}, here),
            "it reaches 1e+39 m from its object's origin; it must stay within 1e+15 m");
  EXPECT_NE(refusal(Box{{1, 1, 2.1e15}}, here), "");
  EXPECT_NE(refusal(Cylinder{1, 1e300}, here), "");
  EXPECT_NE(refusal(Capsule{1, 1e300}, here), "");
  EXPECT_NE(refusal(Point{}, {0, -1.1e15, 0}), "");
  EXPECT_NE(refusal(Point{}, {0, std::nan(""), 0}), "");
  const auto triangle = std::make_shared<const TriangleMesh>(
      makeTriangleMesh({here, Vec3::UnitX(), Vec3(0, 1e16, 0)}, {{0, 1, 2}}, SolidChoice::kAuto, "mesh"));
  EXPECT_NE(refusal(Mesh{triangle}, here), "");
}

}  // namespace
}  // namespace collision_node::geometry

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "collision_node/geometry/wide_bvh.h"

namespace collision_node::geometry {
namespace {

struct Soup {
  std::vector<Vec3> vertices;
  std::vector<WideBvh::Corners> triangles;

  WideBvh hierarchy() const {
    return WideBvh(vertices, static_cast<std::int32_t>(triangles.size()),
                   [this](std::int32_t i) { return triangles[static_cast<std::size_t>(i)]; });
  }
};

/// `size` apart by many orders of magnitude, some without area, around `at`.
Soup soup(int count, const Vec3& at, unsigned seed) {
  std::mt19937_64 engine(seed);
  const auto in = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(engine() >> 11) * 0x1p-53;
  };
  Soup s;
  for (int i = 0; i < count; ++i) {
    const Vec3 corner(in(-3, 3), in(-3, 3), in(-3, 3));
    const double size = std::pow(10.0, in(-9, 0));
    for (int k = 0; k < 3; ++k)
      s.vertices.push_back(at + corner + size * Vec3(in(-1, 1), in(-1, 1), in(-1, 1)));
    s.triangles.push_back({3 * i, 3 * i + 1, i % 5 == 0 ? 3 * i : 3 * i + 2});
  }
  return s;
}

struct Lane {
  const WideNode* node;
  int lane;
};

/// Checks everything below a node and returns the deepest level.
int check(const WideBvh& bvh, const Soup& s, std::int32_t node, std::vector<int>& seen, int level,
          const std::vector<Lane>& above = {}) {
  const WideNode& n = bvh.nodes()[static_cast<std::size_t>(node)];
  int deepest = level;
  for (int lane = 0; lane < 8; ++lane) {
    if (n.plane[0][lane] > n.plane[3][lane]) continue;
    std::vector<Lane> boxes = above;
    boxes.push_back({&n, lane});
    if (n.child[lane] >= 0) {
      deepest = std::max(deepest, check(bvh, s, n.child[lane], seen, level + 1, boxes));
      continue;
    }
    const WideLeaf& leaf = bvh.leaves()[static_cast<std::size_t>(~n.child[lane])];
    for (int k = 0; k < 4; ++k) {
      if (leaf.element[k] < 0) continue;
      ++seen[static_cast<std::size_t>(leaf.element[k])];
      for (int c = 0; c < 3; ++c) {
        const std::int32_t v = leaf.vertex[c][k];
        EXPECT_EQ(v, s.triangles[static_cast<std::size_t>(leaf.element[k])][static_cast<std::size_t>(c)]);
        for (int axis = 0; axis < 3; ++axis) {
          const long double place =
              (static_cast<long double>(s.vertices[static_cast<std::size_t>(v)][axis]) - bvh.centre()[axis]) *
              bvh.scale();
          for (const Lane& box : boxes) {
            EXPECT_LE(box.node->plane[axis][box.lane], place);
            EXPECT_GE(box.node->plane[3 + axis][box.lane], place);
          }
        }
      }
    }
  }
  return deepest;
}

TEST(WideBvh, EveryTriangleIsInOneLeafWhoseBoxHoldsIt) {
  for (const double away : {0.0, 1e7}) {
    for (const int count : {1, 2, 4, 5, 33, 1000}) {
      const Soup s = soup(count, Vec3(away, -away, 0.5 * away), 11);
      const WideBvh bvh = s.hierarchy();
      std::vector<int> seen(s.triangles.size(), 0);
      check(bvh, s, 0, seen, 1);
      for (const int times : seen) EXPECT_EQ(times, 1);
    }
  }
}

TEST(WideBvh, TrianglesThatShrinkTowardsAPointDoNotOutgrowTheWalksStack) {
  Soup s;
  double size = 1.0;
  for (int i = 0; i < 900; ++i, size *= 0.5) {
    for (const Vec3& v : {Vec3(0.9, 0, 0), Vec3(1, 0, 0), Vec3(0.9, 0.1, 0)}) s.vertices.push_back(size * v);
    s.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  const WideBvh bvh = s.hierarchy();
  std::vector<int> seen(s.triangles.size(), 0);
  EXPECT_LT(7 * check(bvh, s, 0, seen, 1) + 8, WideBvh::kStack);
}

TEST(WideBvh, ItTakesAtMostFortyBytesATriangle) {
  const Soup s = soup(20000, Vec3::Zero(), 12);
  EXPECT_LT(static_cast<double>(s.hierarchy().bytes()), 40.0 * 20000);
}

}  // namespace
}  // namespace collision_node::geometry

/// inside.h: "kInside and kOutside are proofs for every point of the ball; kUnknown says nothing. Non-zero
/// winding number is inside." Truth: solid angles in extended precision.
#include <gtest/gtest.h>

#include <cstdio>

#include "collision_node/impact/proof/inside.h"
#include "test/impact/moving_pair.h"

namespace collision_node::impact {
namespace {

using moving::Corners;
using moving::Random;
using oracle::V3;

constexpr std::uint64_t kSeed = 77003;

/// One closed mesh as the solver and as the oracle see it.
struct Solid {
  geometry::Body body;
  std::vector<oracle::Triangle> surface;

  explicit Solid(const geometry::PlacedShape& shape)
      : body({shape}), surface(oracle::makeModel({shape}).closed.at(0)) {}

  Where ask(const Vec3& p, double error) const { return whereIn(body, body.solids().at(0), p, error); }
  bool holds(const Vec3& p) const { return oracle::insideOf(surface, oracle::exact(p)); }
};

/// Boxes as one closed mesh; a negative half size turns that box inside out.
Solid boxes(const std::vector<std::pair<Vec3, double>>& centres_and_halves) {
  std::vector<Vec3> vertices;
  std::vector<Corners> triangles;
  for (const auto& [centre, half] : centres_and_halves) {
    moving::addBox(vertices, triangles, centre, Vec3::Constant(std::abs(half)), half < 0.0);
  }
  return Solid(moving::mesh(vertices, triangles));
}

TEST(Inside, DefiniteAnswersHoldForEveryPointOfTheBall) {
  Random random(kSeed, 0);
  const Solid solids[] = {Solid(moving::torus(1.0, 0.3, 24, 12)),
                          Solid(moving::boxMesh({1.0, 0.5, 0.25})),
                          boxes({{Vec3(0, 0, 0), 1.0}, {Vec3(0.1, 0, 0), -0.5}}),
                          boxes({{Vec3(-0.3, 0, 0), 0.7}, {Vec3(0.3, 0.1, 0), 0.7}}),
                          boxes({{Vec3(0, 0, 0), 1.0}, {Vec3(0, 0, 0), 0.5}}),
                          boxes({{Vec3(-2, 0, 0), 0.5}, {Vec3(2, 0, 0), -0.5}})};
  int inside = 0, outside = 0, unknown = 0, near = 0;
  for (int i = 0; i < 24000; ++i) {
    const Solid& solid = solids[i % 6];
    const double error = random.decade(-15, -1);
    Vec3 p = moving::randomVec(random, 1.5);
    const bool close = random.chance(0.5);
    if (close) {  // within a few errors of the surface, its edges and its corners
      const oracle::Triangle& t = solid.surface[random.below(static_cast<int>(solid.surface.size()))];
      double u = random.unit(), v = random.unit() * (1.0 - u);
      if (random.chance(0.3)) v = 0.0;
      if (random.chance(0.2)) u = v = 0.0;
      const V3 x = t[0] + u * (t[1] - t[0]) + v * (t[2] - t[0]);
      p = Vec3(static_cast<double>(x.x), static_cast<double>(x.y), static_cast<double>(x.z)) +
          error * random.in(0, 3) * random.direction();
    }
    const Where answer = solid.ask(p, error);
    inside += answer == Where::kInside;
    outside += answer == Where::kOutside;
    unknown += answer == Where::kUnknown;
    near += close && answer != Where::kUnknown;
    if (answer == Where::kUnknown) continue;
    for (int k = 0; k < 12; ++k) {
      const Vec3 q =
          k == 0 ? p : Vec3(p + 0.999 * error * (k < 8 ? 1.0 : random.unit()) * random.direction());
      ASSERT_EQ(solid.holds(q), answer == Where::kInside)
          << "seed " << kSeed << " case " << i << " solid " << i % 6 << " error " << error << " ball at "
          << p.transpose() << " point " << q.transpose();
    }
  }
  std::printf("%d inside, %d outside, %d unknown; %d definite within three errors\n", inside, outside,
              unknown, near);
  EXPECT_GT(inside, 2000);
  EXPECT_GT(outside, 3000);
  EXPECT_GT(near, 1000);
}

TEST(Inside, TheBallThatMeetsTheSurfaceIsUnknown) {
  const Solid box(moving::boxMesh({1, 1, 1}));
  EXPECT_EQ(box.ask({0.3, 0.2, 1.0 - 0.5e-9}, 1e-9), Where::kUnknown);
  EXPECT_EQ(box.ask({0.3, 0.2, 1.0}, 0.0), Where::kUnknown);
  EXPECT_EQ(box.ask({1, 1, 1}, 0.0), Where::kUnknown);
  EXPECT_EQ(box.ask({1, 0, 1}, 0.0), Where::kUnknown);
}

TEST(Inside, AnswersWherePointsAreClearOfTheSurface) {
  // Not a guarantee, but the solver could prove no clearance: a ball ten times smaller than its distance from
  // the surface always gets an answer.
  Random random(kSeed, 1);
  const Solid torus(moving::torus(1.0, 0.3, 24, 12));
  int asked = 0;
  for (int i = 0; i < 4000; ++i) {
    const Vec3 p = moving::randomVec(random, 1.5);
    oracle::Real distance = 1e9;
    for (const auto& t : torus.surface)
      distance = std::min(distance, oracle::pointTriangle(oracle::exact(p), t.data()).upper);
    if (distance < 1e-9) continue;
    ++asked;
    ASSERT_NE(torus.ask(p, 0.1 * std::min(0.01, static_cast<double>(distance))), Where::kUnknown)
        << "seed " << kSeed << " case " << i << " at " << p.transpose();
  }
  EXPECT_GT(asked, 3900);
}

TEST(Inside, WindingNumbersOfSeveralComponents) {
  const Vec3 zero = Vec3::Zero();
  const Solid hollow = boxes({{zero, 1.0}, {zero, -0.5}});
  EXPECT_EQ(hollow.ask(zero, 1e-9), Where::kOutside) << "an inner shell wound the other way leaves a hollow";
  EXPECT_EQ(hollow.ask({0.75, 0.1, 0.2}, 1e-9), Where::kInside);
  const Solid twice = boxes({{zero, 1.0}, {zero, 0.5}});
  EXPECT_EQ(twice.ask(zero, 1e-9), Where::kInside) << "winding number 2";
  EXPECT_EQ(twice.ask({0.75, 0.1, 0.2}, 1e-9), Where::kInside);
  const Solid overlapping = boxes({{Vec3(-0.3, 0, 0), 0.7}, {Vec3(0.3, 0.1, 0), 0.7}});
  EXPECT_EQ(overlapping.ask({0.01, 0.02, 0.03}, 1e-9), Where::kInside);
  const Solid inside_out = boxes({{zero, -1.0}});
  EXPECT_EQ(inside_out.ask({0.1, 0.2, 0.3}, 1e-9), Where::kInside) << "winding number -1 is not zero";
  EXPECT_EQ(inside_out.ask({1.1, 0.2, 0.3}, 1e-9), Where::kOutside);
}

TEST(Inside, RaysThroughCornersAndEdgesAreTriedElsewhere) {
  // Seen from the middle, corners and edges of these boxes lie in the most likely directions of a ray.
  const Solid box(moving::boxMesh({0.5773, 0.5613, 0.5930}));
  EXPECT_EQ(box.ask(Vec3::Zero(), 1e-12), Where::kInside);
  EXPECT_EQ(box.ask(Vec3(-0.5773, -0.5613, -0.5930) * 1.5, 1e-12), Where::kOutside);
  const Solid cube(moving::boxMesh({1, 1, 1}));
  EXPECT_EQ(cube.ask(Vec3::Zero(), 1e-12), Where::kInside);
  EXPECT_EQ(cube.ask({-2, 0, 0}, 1e-12), Where::kOutside);
}

/// containment() of a at rest and b at d.
Where contained(const geometry::PlacedShape& a, const geometry::PlacedShape& b, const Vec3& d, Vec3* held) {
  const Piece piece{0, 1'000'000, moving::resting(), moving::resting(d)};
  const moving::Pair pair({a}, {b}, piece);
  return containment(pair.solver, pair.solver.at(0.0), held);
}

TEST(Inside, OneBodyInsideTheOther) {
  // "Does one body's solid hold a part of the other? ... `held` receives a common point relative to A's
  // origin."
  const auto big = moving::boxMesh({1, 1, 1}), small = moving::boxMesh({0.1, 0.1, 0.1});
  const auto surface = moving::boxMesh({1, 1, 1}, Vec3::Zero(), geometry::SolidChoice::kNo);
  const Vec3 d(0.5, 0.2, 0.1);
  Vec3 held;
  EXPECT_EQ(contained(big, small, d, &held), Where::kInside);
  EXPECT_LE((held - d).cwiseAbs().maxCoeff(), 0.1 + 1e-12);
  EXPECT_EQ(contained(small, big, d, &held), Where::kInside);
  EXPECT_LE(held.cwiseAbs().maxCoeff(), 0.1 + 1e-12);
  EXPECT_EQ(contained(big, small, {1.2, 0, 0}, &held), Where::kOutside);
  EXPECT_EQ(contained(surface, small, d, &held), Where::kOutside) << "a surface holds nothing";
  EXPECT_EQ(contained(small, surface, d, &held), Where::kOutside);
  EXPECT_EQ(contained(big, moving::placed(geometry::Point{}), d, &held), Where::kInside);
  EXPECT_EQ(contained(moving::torus(1.0, 0.3, 24, 12), small, Vec3::Zero(), &held), Where::kOutside)
      << "in the hole";
  EXPECT_EQ(contained(moving::torus(1.0, 0.3, 24, 12), small, {1.0, 0, 0}, &held), Where::kInside);
}

TEST(Inside, OneOfTwoComponentsIsEnough) {
  // "If none is inside a solid ... nothing of this body is inside it": the second of two far components
  // counts.
  std::vector<Vec3> vertices;
  std::vector<Corners> triangles;
  moving::addBox(vertices, triangles, Vec3(10, 0, 0), Vec3::Constant(0.1));
  moving::addBox(vertices, triangles, Vec3(0.5, 0, 0), Vec3::Constant(0.1));
  Vec3 held;
  EXPECT_EQ(contained(moving::boxMesh({1, 1, 1}), moving::mesh(vertices, triangles), Vec3::Zero(), &held),
            Where::kInside);
  EXPECT_LE((held - Vec3(0.5, 0, 0)).cwiseAbs().maxCoeff(), 0.1 + 1e-12);
}

}  // namespace
}  // namespace collision_node::impact

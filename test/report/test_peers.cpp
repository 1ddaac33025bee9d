// The peers are called right: each finds a head-on contact whose time is known in closed form, and a fly-by
// clear.
#include <gtest/gtest.h>

#include <cmath>

#include "collision_node/report/made_meshes.h"
#include "collision_node/report/methods/peers.h"
#include "collision_node/report/peers_broad.h"
#include "collision_node/report/random.h"

namespace {

using namespace collision_node::report;
using collision_node::geometry::Body;
using collision_node::geometry::Pose;
using collision_node::geometry::Shape;
using collision_node::geometry::Vec3;
namespace geometry = collision_node::geometry;
namespace impact = collision_node::impact;

/// A unit cube at rest, its face at x = 0.5.
MeshPtr cube() {
  std::vector<Vec3> v;
  for (int i = 0; i < 8; ++i) v.emplace_back(i & 1 ? 0.5 : -0.5, i & 2 ? 0.5 : -0.5, i & 4 ? 0.5 : -0.5);
  return std::make_shared<geometry::TriangleMesh>(geometry::makeTriangleMesh(std::move(v),
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
                                                                             geometry::SolidChoice::kAuto,
                                                                             "cube"));
}

/// B comes from x = 2.5 at 4 m/s for 1 s towards A at rest; the second query passes 3 m beside it.
QuerySet headOn(Shape a, Shape b) {
  QuerySet set;
  for (Shape* shape : {&a, &b}) {
    std::vector<geometry::PlacedShape> shapes;
    shapes.push_back({std::move(*shape), Pose(), "made"});
    set.bodies.push_back(std::make_unique<Body>(std::move(shapes)));
  }
  for (const double aside : {0.0, 3.0}) {
    Query query;
    query.b = 1;
    query.piece.start_ns = 5;
    query.piece.end_ns = 1'000'000'005;
    query.piece.a = collision_node::motion::fixedAt(Pose());
    query.piece.b.start_ns = query.piece.start_ns;
    query.piece.b.end_ns = query.piece.end_ns;
    query.piece.b.c[0] = Vec3(2.5, 0.1 + aside, 0.07);
    query.piece.b.c[1] = Vec3(-4.0, 0.0, 0.0);
    set.queries.push_back(query);
  }
  return set;
}

void check(const QuerySet& set, const ContestantPtr& contestant, double toi, double early, double late) {
  if (!contestant) GTEST_SKIP() << "this peer was not found when the tests were built";
  const Answer hit = contestant->answer(set.queries[0]);
  ASSERT_EQ(hit.verdict, Verdict::kHit) << contestant->name();
  EXPECT_GE(hit.toi_lower, toi - early) << contestant->name();
  EXPECT_LE(hit.toi_lower, toi + late) << contestant->name();
  EXPECT_EQ(contestant->answer(set.queries[1]).verdict, Verdict::kClear) << contestant->name();
}

TEST(Peers, ours_meets_a_cube_head_on_at_the_exact_time) {
  const QuerySet set = headOn(geometry::Mesh{cube()}, geometry::Mesh{cube()});
  check(set, makeOurs(set), 0.375, 1e-9, 0.0);
}

TEST(Peers, advancement_on_fcl_distance_stops_just_before_the_contact) {
  const QuerySet set = headOn(geometry::Mesh{cube()}, geometry::Mesh{cube()});
  check(set, makeFclAdvancement(set), 0.375, 3e-6, 0.0);
}

TEST(Peers, fcl_sampling_finds_the_first_sample_in_contact) {
  const QuerySet set = headOn(geometry::Mesh{cube()}, geometry::Mesh{cube()});
  check(set, makeFclSampling(set), 0.375, 0.0, 1.1e-3);
}

TEST(Peers, fcl_advancement_on_primitives_is_close_and_not_late) {
  const QuerySet set = headOn(geometry::Box{Vec3::Ones()}, geometry::Sphere{0.5});
  check(set, makeFclPrimitives(set), 0.375, 1e-3, 1e-6);
}

TEST(Peers, embree_finds_a_point_on_a_face_in_float) {
  const QuerySet set = headOn(geometry::Mesh{cube()}, geometry::Point{});
  check(set, makeEmbreeRays(set), 0.5, 1e-6, 1e-6);
}

TEST(Peers, bullet_finds_a_sphere_on_a_face_in_float) {
  const QuerySet set = headOn(geometry::Mesh{cube()}, geometry::Sphere{0.5});
  check(set, makeBulletSweep(set), 0.375, 1e-3, 1e-5);
}

TEST(Peers, answer_only_sets_that_they_understand) {
  const QuerySet set = headOn(geometry::Box{Vec3::Ones()}, geometry::Box{Vec3::Ones()});
  EXPECT_EQ(makeFclSampling(set), nullptr);
  EXPECT_EQ(makeEmbreeRays(set), nullptr);
  EXPECT_EQ(makeBulletSweep(set), nullptr);
}

/// A rod from -1 to 1 m along x turns about z by three turns; a ball sits at (0, 0.8): they meet after a
/// quarter turn, less what both are thick.
QuerySet rodAndBall() {
  QuerySet set = headOn(geometry::Capsule{0.05, 2.0}, geometry::Sphere{0.05});
  set.queries.resize(1);
  impact::Piece& piece = set.queries[0].piece;
  piece.a = piece.b;
  piece.a.c[0].setZero(), piece.a.c[1].setZero();
  piece.a.q0 = collision_node::geometry::Quat(Eigen::AngleAxisd(1.5707963267948966, Vec3::UnitY()));
  piece.a.omega = 6.0 * 3.141592653589793 * Vec3::UnitZ();
  piece.b.c[0] = Vec3(0.0, 0.8, 0.0), piece.b.c[1].setZero();
  return set;
}
const double kRodMeets = (0.5 - std::asin(0.1 / 0.8) / 3.141592653589793) / 6.0;

TEST(Peers, fcl_and_bullet_are_given_turns_that_they_can_follow) {
  const QuerySet set = rodAndBall();
  if (!makeFclPrimitives(set)) GTEST_SKIP() << "FCL was not found when the tests were built";
  EXPECT_NEAR(makeFclPrimitives(set)->answer(set.queries[0]).toi_lower, kRodMeets, 1e-4);
  EXPECT_NEAR(makeFclAdvancement(set, 1e-7)->answer(set.queries[0]).toi_lower, kRodMeets, 1e-6);
  if (!makeBulletContinuous(set)) GTEST_SKIP() << "Bullet was not found when the tests were built";
  EXPECT_NEAR(makeBulletContinuous(set)->answer(set.queries[0]).toi_lower, kRodMeets, 1e-3);
}

TEST(Peers, bear_no_offset_of_the_world) {
  QuerySet set = headOn(geometry::Mesh{cube()}, geometry::Mesh{cube()});
  for (Query& query : set.queries) {
    query.piece.a.c[0] += Vec3(1e8, 0.0, 0.0);
    query.piece.b.c[0] += Vec3(1e8, 0.0, 0.0);
  }
  check(set, makeFclAdvancement(set), 0.375, 3e-6, 0.0);
}

TEST(Peers, broad_phases_are_asked_for_all_boxes_that_meet) {
  Random random(3);
  std::vector<std::vector<geometry::Bounds>> steps(3);
  for (std::vector<geometry::Bounds>& boxes : steps) {
    for (int i = 0; i < 200; ++i) {
      const Vec3 at = random.inBox(Vec3::Constant(-5.0), Vec3::Constant(5.0));
      const Vec3 half = random.inBox(Vec3::Constant(0.1), Vec3::Constant(1.0));
      boxes.push_back({at - half, at + half});
    }
  }
  const std::unique_ptr<BroadPeer> fcl = makeFclBroadPhase(steps[0]), bullet = makeBulletBroadPhase(steps[0]);
  for (const std::vector<geometry::Bounds>& boxes : steps) {
    std::size_t meet = 0;
    for (const geometry::Bounds& a : boxes)
      for (const geometry::Bounds& b : boxes)
        meet += &a < &b && (a.lower.array() <= b.upper.array()).all() &&
                        (b.lower.array() <= a.upper.array()).all()
                    ? 1
                    : 0;
    ASSERT_GT(meet, 100u);
    if (fcl) {
      EXPECT_EQ(fcl->pairs(boxes), meet);
    }
    if (bullet) {
      EXPECT_GE(bullet->pairs(boxes), meet);
    }
  }
}

TEST(Peers, embree_sees_boxes_from_outside_and_inside) {
  const std::unique_ptr<RayPeer> rays =
      makeEmbreeBoxes({{Vec3(0, 0, 0), Vec3(1, 2, 3)}, {Vec3(5, 0, 0), Vec3(6, 1, 1)}});
  if (!rays) GTEST_SKIP() << "Embree was not found when the tests were built";
  for (int k = 0; k < 3; ++k) {
    Vec3 before(0.5, 0.7, 0.3);
    Vec3 behind = before;
    before[k] = -1.0;
    behind[k] = 4.0;
    EXPECT_TRUE(rays->hits(before, behind));
    EXPECT_TRUE(rays->hits(behind, before));
    EXPECT_TRUE(rays->hits(Vec3(0.5, 0.7, 0.3), behind));
  }
  EXPECT_FALSE(rays->hits(Vec3(2, 0.5, 0.5), Vec3(4, 0.5, 0.5)));
  EXPECT_FALSE(rays->hits(Vec3(-1, 2.5, 0.5), Vec3(9, 2.5, 0.5)));
}

}  // namespace

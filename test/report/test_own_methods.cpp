// The methods of the paper and those it argues against do what they are described to do: no worse, and no
// better.
#include <gtest/gtest.h>

#include "collision_node/report/methods/own_methods.h"
#include "collision_node/report/scenes/building.h"

namespace {

using namespace collision_node::report;
using collision_node::geometry::Pose;
using collision_node::geometry::Quat;
using collision_node::geometry::Vec3;
namespace geometry = collision_node::geometry;

/// A box of 2 m, its face at x = 1, drives along y at 15 m/s; a ball comes along x from 41 m at 2000 m/s.
QuerySet shotAtDrivingBox(geometry::Shape ball, double aside = 0.0) {
  QuerySet set;
  addBody(set, geometry::Box{Vec3::Constant(2.0)});
  addBody(set, std::move(ball));
  set.queries.push_back(query(0, 1, flight(Pose(), {0.0, 15.0, 0.0}, kFrame),
                              flight({{41.0, aside, 0.1}, Quat::Identity()}, {-2000.0, 0.0, 0.0}, kFrame),
                              kFrame));
  return set;
}

constexpr double kMeets = 0.02;  // [s] the particle; a ball of 5 cm 25 us earlier

TEST(OwnMethods, paper_a_is_right_for_a_particle_and_late_by_the_radius_for_a_ball) {
  const QuerySet point = shotAtDrivingBox(geometry::Point{}), ball = shotAtDrivingBox(geometry::Sphere{0.05});
  EXPECT_NEAR(makePaperA(point)->answer(point.queries[0]).toi_lower, kMeets, 1e-12);
  EXPECT_NEAR(makePaperA(ball)->answer(ball.queries[0]).toi_lower, kMeets, 1e-12);
}

TEST(OwnMethods, sampling_near_s_finds_the_balls_own_contact_to_a_sample) {
  const QuerySet ball = shotAtDrivingBox(geometry::Sphere{0.05});
  for (const auto& method : {makePaperASampled(ball), makePaperBSampled(ball)}) {
    const Answer answer = method->answer(ball.queries[0]);
    EXPECT_GE(answer.toi_lower, kMeets - 25e-6 - 1e-12);
    EXPECT_LE(answer.toi_lower, kMeets - 25e-6 + 50e-6 / 64);
  }
}

TEST(OwnMethods, no_stamp_shows_the_shot_and_subdivision_is_late_by_up_to_a_step) {
  const QuerySet ball = shotAtDrivingBox(geometry::Sphere{0.05});
  EXPECT_EQ(makeStamps(ball)->answer(ball.queries[0]).verdict, Verdict::kClear);
  const Answer answer = makeSubdivision(ball, 100)->answer(ball.queries[0]);
  EXPECT_GE(answer.toi_lower, kMeets - 25e-6);
  EXPECT_LE(answer.toi_lower, kMeets - 25e-6 + kFrame * 1e-11);
}

TEST(OwnMethods, four_dimensional_intersection_samples_only_while_the_bounding_balls_meet) {
  const QuerySet ball = shotAtDrivingBox(geometry::Sphere{0.05});
  const Answer answer = makeSweptVolumes(ball, 100)->answer(ball.queries[0]);
  EXPECT_GE(answer.toi_lower, kMeets - 25e-6);
  EXPECT_LE(answer.toi_lower, kMeets - 25e-6 + 0.15 * kFrame * 1e-11);
  const QuerySet aside = shotAtDrivingBox(geometry::Sphere{0.05}, 5.0);
  EXPECT_EQ(makeSweptVolumes(aside, 100)->answer(aside.queries[0]).verdict, Verdict::kClear);
}

TEST(OwnMethods, a_line_of_sight_sees_the_target_where_it_stood) {
  // The box is 2 m wide and moves 0.3 m until the shot arrives: at 1.2 m the shot hits, but the sight passes.
  const QuerySet hit = shotAtDrivingBox(geometry::Point{}, 1.2),
                 seen = shotAtDrivingBox(geometry::Point{}, -0.9);
  EXPECT_EQ(makePaperA(hit)->answer(hit.queries[0]).verdict, Verdict::kHit);
  EXPECT_EQ(makeLineOfSight(hit)->answer(hit.queries[0]).verdict, Verdict::kClear);
  EXPECT_EQ(makePaperA(seen)->answer(seen.queries[0]).verdict, Verdict::kClear);
  const Answer sight = makeLineOfSight(seen)->answer(seen.queries[0]);
  EXPECT_EQ(sight.verdict, Verdict::kHit);
  EXPECT_NEAR((sight.point - Vec3(1.0, -0.9, 0.1)).norm(), 0.0, 1e-12);
}

}  // namespace

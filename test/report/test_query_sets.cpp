// The sets that measurements run on are frozen: what they hit is counted here.
#include <gtest/gtest.h>

#include "collision_node/report/contestant.h"
#include "collision_node/report/made_meshes.h"

namespace {

using namespace collision_node::report;
using collision_node::geometry::TriangleMesh;

struct Count {
  std::size_t hits = 0, undecided = 0;
};

Count countWithOurs(const QuerySet& set) {
  const ContestantPtr ours = makeOurs(set);
  Count count;
  for (const Query& query : set.queries) {
    const Verdict verdict = ours->answer(query).verdict;
    count.hits += verdict == Verdict::kHit ? 1 : 0;
    count.undecided += verdict == Verdict::kUndecided ? 1 : 0;
  }
  return count;
}

double volume(const TriangleMesh& mesh) {
  double six_times = 0.0;
  for (const auto& t : mesh.triangles) {
    six_times += mesh.vertices[t[0]].dot(mesh.vertices[t[1]].cross(mesh.vertices[t[2]]));
  }
  return six_times / 6.0;
}

TEST(MadeMeshes, are_closed_and_face_outward_and_have_the_sizes_the_table_names) {
  const MeshPtr ball = noisySphere(11, 11), tank = vehicle(), sharp = splinter(21);
  for (const MeshPtr& mesh : {ball, tank, sharp}) {
    EXPECT_TRUE(mesh->solid) << mesh->report.source;
    EXPECT_EQ(mesh->report.degenerate_triangles, 0u) << mesh->report.source;
  }
  EXPECT_EQ(ball->triangles.size(), 968u);
  EXPECT_EQ(noisySphere(35, 11)->triangles.size(), 9800u);
  EXPECT_EQ(tank->triangles.size(), 22640u);
  EXPECT_EQ(sharp->triangles.size(), 960u);
  EXPECT_NEAR(volume(*ball), 4.19, 0.3);
  EXPECT_NEAR(volume(*tank), 30.0, 10.0);
  EXPECT_GT(volume(*sharp), 0.0);
  EXPECT_NEAR((tank->report.upper - tank->report.lower).x(), 7.1, 0.1);
}

TEST(QuerySets, are_the_same_each_time_and_a_shorter_one_is_the_beginning_of_a_longer_one) {
  const QuerySet set = tumblingPrimitives(5), again = tumblingPrimitives(5), longer = tumblingPrimitives(9);
  for (std::size_t i = 0; i < set.queries.size(); ++i) {
    for (const QuerySet* other : {&again, &longer}) {
      EXPECT_EQ(set.queries[i].piece.b.c[0], other->queries[i].piece.b.c[0]);
      EXPECT_EQ(set.queries[i].piece.b.omega, other->queries[i].piece.b.omega);
      EXPECT_EQ(set.bodies[2 * i]->reach(), other->bodies[2 * i]->reach());
    }
  }
}

TEST(QuerySets, about_half_of_the_tumbling_meshes_touch) {
  const Count count = countWithOurs(tumblingMeshes(1000, 200));
  EXPECT_EQ(count.hits, 97u);
  EXPECT_EQ(count.undecided, 0u);
}

TEST(QuerySets, fifty_six_of_a_hundred_shots_hit) {
  const Count particles = countWithOurs(particleShots(10000)), spheres = countWithOurs(sphereShots(5000));
  EXPECT_EQ(particles.hits, 5631u);
  EXPECT_EQ(spheres.hits, 2980u);
  EXPECT_EQ(particles.undecided + spheres.undecided, 0u);
}

TEST(QuerySets, fifty_five_of_a_hundred_primitives_touch) {
  const Count count = countWithOurs(tumblingPrimitives(2000));
  EXPECT_EQ(count.hits, 1091u);
  EXPECT_EQ(count.undecided, 0u);
}

}  // namespace

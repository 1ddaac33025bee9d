#include "test/support/scene_texts.h"

namespace collision_node::scene {
namespace {

class PlanText : public test_support::SceneTest {};

TEST_F(PlanText, NamesObjectsLinksMeshesPairsAndWhatIsLeftOut) {
  const auto scene = load(R"(
objects:
  robot:
    urdf: robot.urdf
    pose: {topic: robot/pose}
    max_speed: 30
    zones: {grip: {link: tool}, front: {link: base, box: {size: [1, 2, 3], position: [0.5, 0, 0]}}}
  ball: {sphere: {radius: 0.05}, pose: {topic: balls, index: 2}, motion: hermite, on_timeout: freeze}
  wall: {mesh: {file: open.obj}, pose: {fixed: {position: [0, 0, 7], orientation: [0, 0, 1, 0]}}}
  floor: {convex: {file: box.obj}, pose: {fixed: {}}}
  drone: {box: {size: [1, 1, 1]}, pose: {tf: drone/base_link}}
pairs: {ignore: [[drone, robot], [ball, drone]], distances: [{pair: [ball, wall], contact_distance: 0.5}]}
)");
  const std::string plan = planText(*scene);
  for (const std::string& part : {
           std::string("plan of ") + file_,
           std::string("world frame: world\n"),
           std::string(
               "precision: time 1e-09 s, distance 1e-06 m; at most 4000000 node tests per pair and piece"),
           std::string("time: reorder 0.1 s, max_gap 1 s, timeout 1.5 s, jump 1 s; stats every 1 s"),
           std::string("objects (5):"),
           std::string("  ball: topic balls, element 2; motion hermite; on timeout freeze\n"),
           std::string("      shape 0: sphere radius 0.05 m, at [0, 0, 0] m\n"),
           std::string("  drone: tf frame drone/base_link; motion slerp; on timeout drop\n"),
           std::string("  robot: topic robot/pose; motion slerp; on timeout drop; max_speed 30 m/s\n"),
           std::string("    link arm, child of base, at [0, 0, 5] m\n"),
           std::string("      shape 0: cylinder radius 0.1 m, length 2 m, at [0, 0, 1] m\n"),
           std::string(
               "    link sensor, child of base, at [0, 0, 0] m: no collision element, touches nothing\n"),
           std::string("    movable joint lift: held at 0\n"),
           std::string("    zone grip: link tool\n"),
           std::string("    zone front: link base, box of size [1, 2, 3] m at [0.5, 0, 0] m\n"),
           std::string("  wall: fixed at [0, 0, 7] m, turned [0, 0, 1, 0]\n"),
           std::string("        8 vertices, 10 triangles; open (4 open edges, 0 odd ones): a surface"),
           std::string("        8 vertices, 12 triangles; closed: a solid; from [0, 0, 0] to [1, 2, 3] m; "
                       "the file reader's float32"),
           std::string("the hull of its vertices is a solid"),
           std::string("  ball/ball x wall/wall: certified: sphere x mesh, along the path while it is "
                       "straight and the mesh "
                       "does not turn, touching within 0.5 m\n"),
           std::string("  ball/ball x robot/arm: certified: sphere x {cylinder, sphere}\n"),
           std::string("  floor/floor x wall/wall: certified: convex x mesh, both fixed: one static test\n"),
           std::string("  ball/ball x drone/drone: listed in pairs/ignore\n"),
           std::string("  drone x robot, 3 pairs of links: listed in pairs/ignore\n"),
           std::string("  robot x robot, 2 pairs of links: neighbours in the URDF\n"),
           std::string("  robot/base x robot/tool: links of one object, pairs/self is not true\n"),
           std::string("no broad phase: few objects, every pair exists\n"),
           std::string("not needed:\n  nothing: all parts are used\n"),
           std::string("warnings (1):\n  robot: robot.urdf: link 'sensor' has no collision element"),
       }) {
    EXPECT_HAS(plan, part);
  }
  EXPECT_HAS_NOT(plan, "assimp is not called");
  EXPECT_HAS_NOT(plan, "no transforms are read");
  EXPECT_EQ(plan, planText(*loadScene(file_, resources_)));
}

TEST_F(PlanText, SaysWhatIsNotNeeded) {
  const std::string plan = planText(*load("objects: {a: {point: {}, pose: {fixed: {}}}}\n"));
  for (const char* part :
       {"assimp is not called", "no transforms are read", "none is subscribed", "no zone",
        "nothing is solved", "pairs watched (0)", "pairs left out (0)", "no pair is watched"}) {
    EXPECT_HAS(plan, part);
  }
}

TEST_F(PlanText, SaysThatABoundOfTurningNeedsALimitOfTheSpin) {
  const std::string plan = planText(*load(R"(
objects:
  a: {point: {}, pose: {topic: a}, acceleration: 5, angular_acceleration: 0.1}
  b: {point: {}, pose: {topic: b}, acceleration: 5, angular_acceleration: 0.1, max_spin: 3}
)"));
  EXPECT_HAS(plan, "warnings (1):\n  a: angular_acceleration says nothing without max_spin");
}

TEST_F(PlanText, SaysWhatAPairThatCannotMoveIsAskedAndWhen) {
  const std::string fixed =
      planText(*load("objects: {a: {point: {}, pose: {fixed: {}}}, b: {point: {}, pose: {fixed: {}}}}\n"));
  EXPECT_HAS(fixed, "warnings (1):\n  " + file_ +
                        ": no watched object moves: each pair is tested once, at the end, with stamp 0");
  const std::string self = planText(*load(R"(
objects: {robot: {urdf: robot.urdf, pose: {topic: robot/pose}}}
pairs: {self: true}
)"));
  EXPECT_HAS(self,
             "  robot/base x robot/tool: certified: box x mesh, links of one object: one static test\n");
  EXPECT_HAS_NOT(self, "no watched object moves");
}

TEST_F(PlanText, AskedSurfaceAndOddTrianglesAreSaid) {
  folder_.write("twice.obj", test_support::boxObj(1, 1, 1) + "f 5 6 8 7\nf 1 1 2\n");
  const std::string plan = planText(*load(R"(
objects:
  a: {mesh: {file: box.obj, solid: no}, pose: {fixed: {}}}
  b: {mesh: {file: twice.obj}, pose: {fixed: {}}}
)"));
  EXPECT_HAS(plan, "closed, but a surface as the scene asks");
  EXPECT_HAS(plan, "; 1 degenerate; 2 duplicate");
}

}  // namespace
}  // namespace collision_node::scene

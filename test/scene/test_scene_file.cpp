#include <cmath>

#include "test/support/scene_texts.h"

namespace collision_node::scene {
namespace {

class SceneFile : public test_support::SceneTest {};

TEST_F(SceneFile, EveryKeyArrivesWhereItBelongs) {
  const auto scene = load(R"(
world_frame: /map
precision: {time: 1.0e-8, distance: 1}
time: {reorder: 0.2, max_gap: 2, timeout: 3, jump: 4}
stats: {period: 0.5}
node_budget: 1000
objects:
  z_sphere:
    sphere: {radius: 1}
    pose: {topic: z/odom}
    motion: hermite
    on_timeout: freeze
    max_speed: 3000
    max_spin: 20
    acceleration: 0
    angular_acceleration: 2.5
  a_box:
    box: {size: [1, 2.5, 3]}
    pose: {tf: /a/base_link}
    motion: spin
  point: {point: {}, pose: {topic: poses, index: 3}}
  cyl: {cylinder: {radius: .5, length: 2}, pose: {topic: /gazebo/model_states, model: c}}
  cap: {capsule: {radius: 0.5, length: 0}, pose: {topic: /gazebo/link_states, link: "c::d"}, motion: slerp, on_timeout: drop}
  mesh: {mesh: {file: box.obj, scale: [1, 1, -2], solid: yes}, pose: {fixed: {position: [1, 2, 3], orientation: [0, 0, 1.001, 0]}}}
  surface: {mesh: {file: box.obj, scale: 2, solid: no}, pose: {fixed: {}}}
  hull: {convex: {file: open.obj}, pose: {fixed: {position: [9, 9, 9]}}}
)");
  EXPECT_EQ(scene->file, file_);
  EXPECT_EQ(scene->world_frame, "map");
  EXPECT_EQ(scene->time_precision, 1e-8);
  EXPECT_EQ(scene->distance_precision, 1.0);
  EXPECT_EQ(scene->time.reorder, 0.2);
  EXPECT_EQ(scene->time.max_gap, 2.0);
  EXPECT_EQ(scene->time.timeout, 3.0);
  EXPECT_EQ(scene->time.jump, 4.0);
  EXPECT_EQ(scene->stats_period, 0.5);
  EXPECT_EQ(scene->node_budget, 1000u);
  EXPECT_TRUE(scene->warnings.empty());
  ASSERT_EQ(scene->objects.size(), 8u);
  for (std::size_t i = 1; i < 8; ++i) EXPECT_LT(scene->objects[i - 1].name, scene->objects[i].name);
  const auto object = [&](const std::string& name) -> const Object& {
    for (const Object& o : scene->objects) {
      if (o.name == name) return o;
    }
    throw std::runtime_error("no object " + name);
  };
  const auto shape = [&](const std::string& name) { return object(name).links.at(0).shapes.at(0).shape; };

  const Object& sphere = object("z_sphere");
  EXPECT_EQ(std::get<geometry::Sphere>(shape("z_sphere")).radius, 1.0);
  EXPECT_EQ(sphere.source.type, PoseSource::Type::kTopic);
  EXPECT_EQ(sphere.source.topic, "z/odom");
  EXPECT_EQ(sphere.source.index, -1);
  EXPECT_EQ(sphere.motion, MotionModel::kHermite);
  EXPECT_EQ(sphere.on_timeout, OnTimeout::kFreeze);
  EXPECT_EQ(sphere.max_speed, 3000.0);
  EXPECT_EQ(sphere.max_spin, 20.0);
  EXPECT_EQ(sphere.acceleration, 0.0);
  EXPECT_EQ(sphere.angular_acceleration, 2.5);
  ASSERT_EQ(sphere.links.size(), 1u);
  EXPECT_EQ(sphere.links[0].name, "z_sphere");
  ASSERT_NE(sphere.links[0].body, nullptr);

  EXPECT_EQ(object("a_box").source.type, PoseSource::Type::kTf);
  EXPECT_EQ(object("a_box").source.tf_frame, "a/base_link");
  EXPECT_EQ(object("a_box").motion, MotionModel::kSpin);
  EXPECT_EQ(object("a_box").on_timeout, OnTimeout::kDrop);
  EXPECT_TRUE(std::isinf(object("a_box").max_speed));
  EXPECT_TRUE(std::isnan(object("a_box").acceleration));
  EXPECT_EQ(std::get<geometry::Box>(shape("a_box")).size, Vec3(1, 2.5, 3));
  EXPECT_EQ(object("point").source.index, 3);
  EXPECT_TRUE(std::holds_alternative<geometry::Point>(shape("point")));
  EXPECT_EQ(object("cyl").source.model, "c");
  EXPECT_EQ(std::get<geometry::Cylinder>(shape("cyl")).length, 2.0);
  EXPECT_EQ(object("cap").source.link, "c::d");
  EXPECT_EQ(std::get<geometry::Capsule>(shape("cap")).length, 0.0);

  const Object& mesh = object("mesh");
  EXPECT_EQ(mesh.source.type, PoseSource::Type::kFixed);
  EXPECT_EQ(mesh.source.fixed.position, Vec3(1, 2, 3));
  EXPECT_EQ(mesh.source.fixed.orientation.z(), 1.0);
  EXPECT_TRUE(std::get<geometry::Mesh>(shape("mesh")).mesh->solid);
  EXPECT_EQ(std::get<geometry::Mesh>(shape("mesh")).mesh->report.lower, Vec3(0, 0, -6));
  EXPECT_FALSE(std::get<geometry::Mesh>(shape("surface")).mesh->solid);
  EXPECT_EQ(std::get<geometry::Mesh>(shape("surface")).mesh->report.upper, Vec3(2, 4, 6));
  EXPECT_TRUE(std::holds_alternative<geometry::Convex>(shape("hull")));
  EXPECT_EQ(object("hull").links[0].shapes[0].source, "open.obj");
}

TEST_F(SceneFile, DefaultsHoldWhenNothingIsSaid) {
  const auto scene = load("objects: {a: {point:, pose: {topic: a}}, b: {point: {}, pose: {fixed:}}}\n");
  const Scene defaults;
  EXPECT_EQ(scene->world_frame, "world");
  EXPECT_EQ(scene->time_precision, defaults.time_precision);
  EXPECT_EQ(scene->time.timeout, defaults.time.timeout);
  EXPECT_EQ(scene->node_budget, defaults.node_budget);
  const auto pairs = scene->pairs.list(scene->objects);
  ASSERT_EQ(pairs.size(), 1u);
  EXPECT_EQ(pairs[0].contact_distance, 0.0);
}

TEST_F(SceneFile, UrdfLinksSitInTheObjectsFrame) {
  const auto scene = load(R"(
objects:
  robot:
    urdf: robot.urdf
    pose: {topic: robot/pose}
    zones:
      grip: {link: tool}
      front: {link: base, box: {size: [1, 2, 3], position: [0.5, 0, 0], orientation: [0, 0, 0, 1]}}
  wall: {box: {size: [1, 1, 1]}, pose: {fixed: {}}, zones: {all: {}, door: {box: {size: [1, 1, 1]}}}}
)");
  const Object& robot = scene->objects.at(0);
  ASSERT_EQ(robot.links.size(), 4u);
  EXPECT_EQ(robot.links[0].name, "base");
  EXPECT_EQ(robot.movable_joints, std::vector<std::string>{"lift"});
  const auto link = [&](const std::string& name) -> const Link& {
    for (const Link& l : robot.links) {
      if (l.name == name) return l;
    }
    throw std::runtime_error("no link " + name);
  };
  EXPECT_EQ(link("tool").parent, "arm");
  EXPECT_LT((link("tool").T_o_l * Vec3(1, 0, 0) - Vec3(3, 1, 5)).norm(), 1e-14);
  EXPECT_EQ(link("sensor").body, nullptr);
  // The arm's shapes stay in the link's frame, its body is in the object's.
  EXPECT_EQ(link("arm").shapes.at(0).origin.position, Vec3(0, 0, 1));
  EXPECT_EQ(link("arm").body->shapes().at(0).origin.position, Vec3(0, 0, 6));
  ASSERT_EQ(robot.zones.size(), 2u);
  EXPECT_EQ(robot.zones[0].name, "grip");
  EXPECT_FALSE(robot.zones[0].has_box);
  EXPECT_TRUE(robot.zones[1].has_box);
  EXPECT_EQ(robot.zones[1].pose.position, Vec3(0.5, 0, 0));
  EXPECT_EQ(scene->objects.at(1).zones.at(0).link, "wall");
  ASSERT_EQ(scene->warnings.size(), 1u);
  EXPECT_HAS(scene->warnings[0], "robot: robot.urdf: link 'sensor' has no collision element");
}

TEST_F(SceneFile, UrdfFromAParameterHasThreeSpellings) {
  for (const char* how :
       {"param: robot_description", "urdf: {param: robot_description}", "urdf: {file: robot.urdf}"}) {
    EXPECT_EQ(load("objects: {r: {" + std::string(how) + ", pose: {fixed: {}}}}")->objects[0].links.size(),
              4u)
        << how;
  }
}

TEST_F(SceneFile, UrisOfAllKindsAreResolved) {
  folder_.write("robots/meshes/part.obj", test_support::boxObj(1, 1, 1));
  folder_.write("robots/relative.urdf", test_support::robotUrdf("meshes/part.obj"));  // relative to the URDF
  folder_.write("robots/packaged.urdf", test_support::robotUrdf("package://known/robots/meshes/part.obj"));
  for (const std::string& uri :
       {std::string("robots/relative.urdf"), std::string("package://known/robots/packaged.urdf"),
        "file://" + folder_.path() + "/robots/relative.urdf", folder_.path() + "/robots/relative.urdf"}) {
    EXPECT_EQ(load("objects: {r: {urdf: '" + uri + "', pose: {fixed: {}}}}")->objects[0].links.size(), 4u)
        << uri;
  }
  EXPECT_NO_THROW(load("objects: {r: {mesh: {file: package://known/box.obj}, pose: {fixed: {}}}}"));
}

TEST_F(SceneFile, OverridesReplaceAndAddByKeyPath) {
  const std::string text =
      "precision: {time: 1e-9}\nobjects: {o: {sphere: {radius: 1}, pose: {fixed: {}}}}\n";
  const auto scene = load(text, {{"precision/time", "1e-6"},
                                 {"time/reorder", "0.3"},
                                 {"objects/o/sphere/radius", "2"},
                                 {"objects/o/pose", "{topic: o/pose}"},
                                 {"objects/p", "{point: {}, pose: {tf: p}}"},
                                 {"pairs/self", "true"}});
  EXPECT_EQ(scene->time_precision, 1e-6);
  EXPECT_EQ(scene->time.reorder, 0.3);
  EXPECT_EQ(std::get<geometry::Sphere>(scene->objects.at(0).links[0].shapes[0].shape).radius, 2.0);
  EXPECT_EQ(scene->objects[0].source.topic, "o/pose");
  EXPECT_EQ(scene->objects.at(1).source.tf_frame, "p");
}

TEST_F(SceneFile, AnAliasIsACopyAnOverrideOfOneLeavesTheOther) {
  const auto scene = load(R"(
objects:
  a: {sphere: &ball {radius: 1}, pose: {fixed: {}}}
  b: {sphere: *ball, pose: {fixed: {position: [5, 0, 0]}}}
)",
                          {{"objects/b/sphere/radius", "3"}});
  EXPECT_EQ(std::get<geometry::Sphere>(scene->objects[0].links[0].shapes[0].shape).radius, 1.0);
  EXPECT_EQ(std::get<geometry::Sphere>(scene->objects[1].links[0].shapes[0].shape).radius, 3.0);
}

}  // namespace
}  // namespace collision_node::scene

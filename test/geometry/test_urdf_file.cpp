#include <gtest/gtest.h>

#include <cmath>

#include "collision_node/geometry/urdf_file.h"
#include "test/support/mesh_texts.h"
#include "test/support/temp_folder.h"

namespace collision_node::geometry {
namespace {

#define EXPECT_HAS(text, part) \
  EXPECT_NE((text).find(part), std::string::npos) << "no \"" << (part) << "\" in:\n" << (text)

const std::string kArm = R"(<robot name="arm">
  <link name="base"><collision><geometry><box size="1 2 3"/></geometry></collision></link>
  <link name="upper">
    <collision><origin xyz="0 0 0.5" rpy="1.5707963267948966 0 0"/><geometry><cylinder radius="0.1" length="1"/></geometry></collision>
    <collision><geometry><sphere radius="0.2"/></geometry></collision>
    <visual><geometry><box size="9 9 9"/></geometry></visual>
  </link>
  <link name="tool"><collision><geometry><mesh filename="m.obj" scale="-1 1 1"/></geometry></collision></link>
  <link name="sensor"/>
  <joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/><origin xyz="1 0 0" rpy="0 0 1.5707963267948966"/>
    <axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
  <joint name="flange" type="fixed"><parent link="upper"/><child link="tool"/><origin xyz="2 0 0"/></joint>
  <joint name="slide" type="prismatic"><parent link="base"/><child link="sensor"/><axis xyz="1 0 0"/>
    <limit lower="0" upper="1" effort="1" velocity="1"/></joint>
</robot>)";

class UrdfFile : public ::testing::Test {
 protected:
  UrdfFile() { folder_.write("m.obj", test_support::boxObj(1, 2, 3)); }

  UrdfModel parse(const std::string& xml) {
    return parseUrdf(xml, "arm.urdf", [&](const std::string& uri, const Vec3& scale) {
      asked_.push_back(uri);
      if (uri.find("://") != std::string::npos) throw LoadError(uri + ": nobody knows this place");
      auto mesh =
          std::make_shared<TriangleMesh>(loadMesh(folder_.path() + "/" + uri, scale, SolidChoice::kAuto));
      mesh->report.source = uri;
      return mesh;
    });
  }
  std::string refusal(const std::string& xml) {
    try {
      parse(xml);
    } catch (const LoadError& error) {
      return error.what();
    }
    return "accepted";
  }
  static std::string oneLink(const std::string& geometry) {
    return "<robot name='r'><link name='l'><collision><geometry>" + geometry +
           "</geometry></collision></link></robot>";
  }

  test_support::TempFolder folder_;
  std::vector<std::string> asked_;
};

TEST_F(UrdfFile, LinksJointsAndOriginsFoldIntoTheRootFrame) {
  const UrdfModel model = parse(kArm);
  EXPECT_EQ(model.name, "arm");
  ASSERT_EQ(model.links.size(), 4u);
  const char* order[] = {"base", "upper", "tool",
                         "sensor"};  // depth first: joints shoulder, flange; then slide
  for (int i = 0; i < 4; ++i) EXPECT_EQ(model.links[i].name, order[i]);
  EXPECT_EQ(model.links[0].parent, "");
  const auto find = [&](const std::string& name) {
    for (const UrdfLink& link : model.links) {
      if (link.name == name) return link;
    }
    throw std::runtime_error("no link " + name);
  };
  EXPECT_EQ(find("tool").parent, "upper");
  // shoulder: 1 along x, a quarter turn about z; flange: 2 along the turned x.
  EXPECT_LT((find("tool").T_root_l * Vec3(1, 0, 0) - Vec3(1, 3, 0)).norm(), 1e-15);
  const UrdfLink upper = find("upper");
  ASSERT_EQ(upper.shapes.size(), 2u);
  ASSERT_TRUE(std::holds_alternative<Cylinder>(upper.shapes[0].shape));
  EXPECT_EQ(std::get<Cylinder>(upper.shapes[0].shape).length, 1.0);
  // The cylinder's z axis was turned about x by a quarter: it points along -y.
  EXPECT_LT((upper.shapes[0].origin * Vec3(0, 0, 1) - Vec3(0, -1, 0.5)).norm(), 1e-15);
  EXPECT_EQ(std::get<Sphere>(upper.shapes[1].shape).radius, 0.2);
  EXPECT_EQ(std::get<Box>(find("base").shapes[0].shape).size, Vec3(1, 2, 3));
  const std::vector<std::string> movable = {"shoulder", "slide"};
  std::vector<std::string> found = model.movable_joints;
  std::sort(found.begin(), found.end());
  EXPECT_EQ(found, movable);
  ASSERT_EQ(model.warnings.size(), 1u);
  EXPECT_HAS(model.warnings[0], "arm.urdf: link 'sensor' has no collision element");
}

TEST_F(UrdfFile, MeshScaleMayMirrorAndStaysSolid) {
  const UrdfModel model = parse(kArm);
  for (const UrdfLink& link : model.links) {
    if (link.name != "tool") continue;
    ASSERT_EQ(link.shapes.size(), 1u);
    EXPECT_EQ(link.shapes[0].source, "m.obj");
    const TriangleMesh& mesh = *std::get<Mesh>(link.shapes[0].shape).mesh;
    EXPECT_EQ(mesh.report.lower, Vec3(-1, 0, 0));
    EXPECT_EQ(mesh.report.source, "m.obj");
    EXPECT_TRUE(mesh.solid);
    double volume = 0.0;
    for (const auto& t : mesh.triangles) {
      volume += mesh.vertices[t[0]].dot(mesh.vertices[t[1]].cross(mesh.vertices[t[2]]));
    }
    EXPECT_DOUBLE_EQ(volume, 36.0);
  }
}

TEST_F(UrdfFile, OneMeshUsedTwiceIsLoadedOnce) {
  const std::string mesh = "<collision><geometry><mesh filename='m.obj'/></geometry></collision>";
  const UrdfModel model = parse("<robot name='r'><link name='l'>" + mesh + mesh + "</link></robot>");
  ASSERT_EQ(model.links[0].shapes.size(), 2u);
  EXPECT_EQ(asked_.size(), 1u);
  EXPECT_EQ(std::get<Mesh>(model.links[0].shapes[0].shape).mesh,
            std::get<Mesh>(model.links[0].shapes[1].shape).mesh);
}

TEST_F(UrdfFile, AllFaultsAreNamedAtOnce) {
  const std::string text = refusal(R"(<robot name="r">
    <link name="a"><collision><geometry><sphere radius="-1"/></geometry></collision></link>
    <link name="b"><collision><geometry><box size="1 0 -2"/></geometry></collision></link>
    <link name="c"><collision><geometry><cylinder radius="0" length="1"/></geometry></collision></link>
    <link name="d"><collision><geometry><mesh filename="absent.stl"/></geometry></collision>
                   <collision><geometry><mesh filename="far://x.stl"/></geometry></collision>
                   <collision><geometry><mesh filename="m.obj" scale="1 0 1"/></geometry></collision></link>
    <joint name="ab" type="fixed"><parent link="a"/><child link="b"/></joint>
    <joint name="ac" type="fixed"><parent link="a"/><child link="c"/></joint>
    <joint name="ad" type="fixed"><parent link="a"/><child link="d"/></joint></robot>)");
  EXPECT_HAS(text, "arm.urdf: link 'a', collision element 0: sphere radius is -1; it must be > 0");
  EXPECT_HAS(text, "link 'b', collision element 0: box size y is 0;");
  EXPECT_HAS(text, "link 'b', collision element 0: box size z is -2;");
  EXPECT_HAS(text, "link 'c', collision element 0: cylinder radius is 0;");
  EXPECT_HAS(text, "link 'd', collision element 0: " + folder_.path() + "/absent.stl: no such mesh file");
  EXPECT_HAS(text, "link 'd', collision element 1: far://x.stl: nobody knows this place");
  EXPECT_HAS(text, "link 'd', collision element 2: mesh scale is 1 0 1; it must be three finite numbers");
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 6);
}

TEST_F(UrdfFile, TextThatIsNoUrdfIsRefusedWithItsSource) {
  EXPECT_HAS(refusal(""), "arm.urdf: ");
  EXPECT_HAS(refusal("<robot name='r'><link name='a'>"), "arm.urdf: ");
  EXPECT_HAS(refusal("<html/>"), "arm.urdf: ");
  EXPECT_HAS(refusal("<robot name='r'/>"), "arm.urdf: ");
  // Each of these urdfdom itself passes over: the link would come out without its shape.
  EXPECT_HAS(refusal(oneLink("<torus/>")), "torus");
  EXPECT_HAS(refusal(oneLink("")), "arm.urdf: ");
  EXPECT_HAS(refusal(oneLink("<sphere radius='nan'/>")), "arm.urdf: ");
  EXPECT_HAS(refusal(oneLink("<sphere radius='wide'/>")), "wide");
  EXPECT_HAS(refusal("<robot name='r'><link name='a'/><link name='a'/></robot>"), "not unique");
  EXPECT_HAS(refusal("<robot name='r'><link name='a'/><link name='b'/></robot>"), "arm.urdf: ");
}

TEST_F(UrdfFile, RingsAndSecondParentsAreRefused) {
  const auto joint = [](const std::string& name, const std::string& parent, const std::string& child) {
    return "<joint name='" + name + "' type='fixed'><parent link='" + parent + "'/><child link='" + child +
           "'/></joint>";
  };
  const std::string links = "<robot name='r'><link name='a'/><link name='b'/><link name='c'/>";
  EXPECT_HAS(refusal(links + joint("1", "a", "b") + joint("2", "a", "c") + joint("3", "b", "c") + "</robot>"),
             "link 'c': is the child of more than one joint");
  EXPECT_HAS(refusal(links + joint("1", "b", "c") + joint("2", "c", "b") + "</robot>"),
             "link 'b' is not connected to the root link");
  EXPECT_HAS(refusal(links + joint("1", "a", "b") + joint("2", "b", "c") + joint("3", "c", "b") + "</robot>"),
             "more than one joint");
}

}  // namespace
}  // namespace collision_node::geometry

/// Loading scenes from text, for tests.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "collision_node/scene/scene.h"
#include "test/support/mesh_texts.h"
#include "test/support/temp_folder.h"

#define EXPECT_HAS(text, part) \
  EXPECT_NE((text).find(part), std::string::npos) << "no \"" << (part) << "\" in:\n" << (text)
#define EXPECT_HAS_NOT(text, part) \
  EXPECT_EQ((text).find(part), std::string::npos) << "a \"" << (part) << "\" in:\n" << (text)

namespace test_support {

/// A robot of four links in a row, base - arm - tool, with a bare sensor on the base; tool's mesh is box.obj.
inline std::string robotUrdf(const std::string& mesh = "box.obj") {
  return R"(<robot name="robot">
  <link name="base"><collision><geometry><box size="1 1 1"/></geometry></collision></link>
  <link name="arm"><collision><origin xyz="0 0 1"/><geometry><cylinder radius="0.1" length="2"/></geometry></collision>
    <collision><geometry><sphere radius="0.3"/></geometry></collision></link>
  <link name="tool"><collision><geometry><mesh filename=")" +
         mesh + R"("/></geometry></collision></link>
  <link name="sensor"/>
  <joint name="lift" type="prismatic"><parent link="base"/><child link="arm"/><origin xyz="0 0 5"/><axis xyz="0 0 1"/>
    <limit lower="0" upper="1" effort="1" velocity="1"/></joint>
  <joint name="grip" type="fixed"><parent link="arm"/><child link="tool"/><origin xyz="3 0 0" rpy="0 0 1.5707963267948966"/></joint>
  <joint name="bolt" type="fixed"><parent link="base"/><child link="sensor"/></joint>
</robot>)";
}

class SceneTest : public ::testing::Test {
 protected:
  SceneTest() {
    folder_.write("box.obj", boxObj(1, 2, 3));
    folder_.write("open.obj", boxObj(1, 2, 3, false));
    folder_.write("robot.urdf", robotUrdf());
    resources_.package_path = [this](const std::string& package) {
      return package == "known" ? folder_.path() : std::string();
    };
    resources_.parameter = [](const std::string& name) {
      return name == "robot_description" ? robotUrdf() : std::string();
    };
  }

  std::shared_ptr<const collision_node::scene::Scene> load(
      const std::string& text, const collision_node::scene::Overrides& overrides = {}) {
    file_ = folder_.write("scene.yaml", text);
    return collision_node::scene::loadScene(file_, resources_, overrides);
  }

  /// The error's text, "accepted" when there is none.
  std::string refusal(const std::string& text, const collision_node::scene::Overrides& overrides = {}) {
    try {
      load(text, overrides);
    } catch (const collision_node::scene::SceneError& error) {
      return error.what();
    }
    return "accepted";
  }

  /// A scene of one object `o` with the given lines, each already indented by four.
  std::string refusalOfObject(const std::string& lines) { return refusal("objects:\n  o:\n" + lines); }

  TempFolder folder_;
  collision_node::scene::Resources resources_;
  std::string file_;
};

}  // namespace test_support

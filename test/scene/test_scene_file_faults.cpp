#include <algorithm>

#include "test/support/scene_texts.h"

namespace collision_node::scene {
namespace {

class SceneFaults : public test_support::SceneTest {
 protected:
  static std::size_t lines(const std::string& text) { return 1 + std::count(text.begin(), text.end(), '\n'); }
};

TEST_F(SceneFaults, AllAtOnceOneLineEachWithFileLineAndKeyPath) {
  const std::string text = refusal(R"(precision: {time: 0}
objects:
  a:
    sphere: {radius: -1}
    pose: {topic: a, indx: 3}
  b:
    box: {size: [1, 0, 1]}
pairs: {ignore: [[a, c]]}
tme: {}
)");
  EXPECT_HAS(text, "scene.yaml:1: precision/time: 0 is out of range; must be > 0 [s]");
  EXPECT_HAS(text, "scene.yaml:4: objects/a/sphere/radius: -1 is out of range; must be > 0 [m]");
  EXPECT_HAS(text, "scene.yaml:5: objects/a/pose/indx: unknown key 'indx'; nearest known: 'index'");
  EXPECT_HAS(text, "scene.yaml:7: objects/b/box/size: element 1 is 0; must be > 0 [m]");
  EXPECT_HAS(text, "scene.yaml:6: objects/b: no pose; write pose: {topic: ");
  EXPECT_HAS(text, "scene.yaml:8: pairs/ignore: unknown object 'c'; known here: a, b");
  EXPECT_HAS(text, "scene.yaml:9: tme: unknown key 'tme'; nearest known: 'time'");
  EXPECT_EQ(lines(text), 7u);
}

TEST_F(SceneFaults, TextThatIsNoScene) {
  EXPECT_HAS(refusal(""), "scene.yaml: no objects; write objects:");
  EXPECT_HAS(refusal("objects: {}\n"), "scene.yaml:1: objects: an empty scene; name at least one object");
  EXPECT_HAS(refusal("objects:\n"), "an empty scene");
  EXPECT_HAS(refusal("objects: [a, b]\n"),
             "scene.yaml:1: objects: a list is not a map; write objects: {<name>: {pose: …, <shape>: …}}");
  EXPECT_HAS(refusal("world_frame: map\nobjects:\n\ta:\n\t\tpose: {tf: a}\n"),
             "; line 3 is indented by a tab: indent by spaces");
  EXPECT_HAS(refusal("- a\n- b\n"), "the scene is not a map");
  EXPECT_HAS(refusal("#ROSBAG V2.0\n"), "scene.yaml: a bag, not a scene; the scene is named first");
  EXPECT_EQ(lines(refusal("- a\n- b\n")), 1u);
  EXPECT_HAS(refusal("a: b\nobjects: {a: [}\n"), "scene.yaml:2: not valid YAML: ");
  EXPECT_EQ(lines(refusal("a: b\nobjects: {a: [}\n")), 1u);
  EXPECT_HAS(refusal("a: 1\n---\nb: 2\n"), "holds 2 YAML documents");
  EXPECT_HAS(refusal("objects: &a {x: *a}\n"), "nested deeper than 50 levels");
  EXPECT_HAS(refusal("[a, b]: c\n"), "a key is no plain word");
  try {
    loadScene(folder_.path() + "/absent.yaml", resources_);
    FAIL();
  } catch (const SceneError& error) {
    EXPECT_HAS(std::string(error.what()), "/absent.yaml: the scene file cannot be opened: No such file");
  }
  try {
    loadScene(folder_.path(), resources_);
    FAIL();
  } catch (const SceneError& error) {
    EXPECT_HAS(std::string(error.what()), ": is a folder; a scene file (YAML) is needed");
  }
}

TEST_F(SceneFaults, RepeatedKeysNameBothLines) {
  const std::string text =
      refusal("objects:\n  o: {point: {}, pose: {fixed: {}}}\n  o: {point: {}, pose: {tf: o}}\n");
  EXPECT_HAS(text, "scene.yaml:3: objects/o: key given twice (first at ");
  EXPECT_HAS(text, "scene.yaml:2); keep one of them");
}

TEST_F(SceneFaults, NumbersOfTheWrongKind) {
  const auto radius = [&](const std::string& value) {
    return refusalOfObject("    sphere: {radius: " + value + "}\n    pose: {fixed: {}}\n");
  };
  EXPECT_EQ(radius("1"), "accepted");
  EXPECT_EQ(radius("1e-9"), "accepted");
  EXPECT_EQ(radius("+.5"), "accepted");
  EXPECT_HAS(radius("wide"), "scene.yaml:3: objects/o/sphere/radius: 'wide' is not a number, > 0 [m]");
  EXPECT_HAS(radius("1m"), "'1m' is not a number");
  EXPECT_HAS(radius("1,5"), "objects/o/sphere");  // a YAML flow map reads 1 and a key 5
  EXPECT_HAS(radius("0x10"), "'0x10' is not a number");
  EXPECT_HAS(radius("1e999"), "'1e999' is not a number");
  EXPECT_HAS(radius("[1]"), "a list is not a number");
  EXPECT_HAS(radius(""), "nothing is not a number");
  for (const char* value : {".nan", ".inf", "-.INF", "NaN"}) {
    EXPECT_HAS(radius(value), std::string(value) + " is not finite; must be a finite number") << value;
  }
  EXPECT_HAS(radius("0"), "0 is out of range; must be > 0 [m]");
  EXPECT_HAS(refusal("objects:\n  o: {sphere: {radius: 1e39}, pose: {fixed: {}}}\n"
                     "  p: {point: {}, pose: {tf: p}}\n"),
             "scene.yaml: objects/o: sphere reaches 1e+39 m from its object's origin; it must stay within "
             "1e+15 m");
  EXPECT_HAS(radius("-0.5"), "-0.5 is out of range; must be > 0 [m]");
}

TEST_F(SceneFaults, Shapes) {
  const auto object = [&](const std::string& shape) {
    return refusalOfObject("    pose: {fixed: {}}\n    " + shape + "\n");
  };
  EXPECT_HAS(object("motion: slerp"),
             "scene.yaml:2: objects/o: no shape; give exactly one of: point, sphere, box,");
  EXPECT_HAS(object("point: {}\n    box: {size: [1, 1, 1]}"),
             "objects/o: several shapes (point, box); give exactly one");
  EXPECT_HAS(object("sphere: {}"), "objects/o/sphere: no radius given");
  EXPECT_HAS(object("sphere: {radius: 1, radios: 2}"),
             "objects/o/sphere/radios: unknown key 'radios'; nearest known: 'radius'");
  EXPECT_HAS(object("sphere: {radius: 1,5}"), "unknown key '5'; numbers have a decimal point, no comma");
  EXPECT_HAS(object("sphere:\n      radius: 1,5"),
             "objects/o/sphere/radius: '1,5' is not a number (write 1.5), > 0 [m]");
  EXPECT_HAS(object("sphere: {radius: 1}\n    contact_distance: 0.1"),
             "unknown key 'contact_distance'; known here: point, sphere, box, ");
  EXPECT_HAS(object("sphere: 3"), "objects/o/sphere: '3' is not a map; write sphere: {radius: <number>}");
  EXPECT_HAS(object("mesh: tank.stl"),
             "objects/o/mesh: 'tank.stl' is not a map; write mesh: {file: <path or package:// URI>}");
  EXPECT_HAS(object("point: {size: 1}"), "objects/o/point/size: unknown key 'size'");
  EXPECT_HAS(object("box: {}"), "objects/o/box: no size given; write size: [x, y, z], full lengths [m]");
  EXPECT_HAS(object("box: {size: 1}"),
             "objects/o/box/size: '1' found; must be three finite numbers [x, y, z]");
  EXPECT_HAS(object("box: {size: [1, 1]}"),
             "objects/o/box/size: a list of 2 found; must be three finite numbers");
  EXPECT_HAS(object("box: {size: [1, 1, .nan]}"), "objects/o/box/size: element 2: .nan is not finite");
  EXPECT_HAS(object("box: {size: [1, -2, 1]}"), "element 1 is -2; must be > 0 [m]");
  EXPECT_HAS(object("cylinder: {radius: 1, length: 0}"),
             "objects/o/cylinder/length: 0 is out of range; must be > 0 [m]");
  EXPECT_HAS(object("cylinder: {length: 1}"), "objects/o/cylinder: no radius given");
  EXPECT_HAS(object("capsule: {radius: 1, length: -1}"),
             "objects/o/capsule/length: -1 is out of range; must be >= 0 [m]");
  EXPECT_HAS(object("mesh: {}"), "objects/o/mesh: no file given");
  EXPECT_HAS(object("mesh: {file: absent.stl}"),
             "scene.yaml:4: objects/o/mesh/file: " + folder_.path() + "/absent.stl: no such mesh file");
  EXPECT_HAS(object("mesh: {file: package://unknown/a.stl}"), "package 'unknown' not found");
  EXPECT_HAS(object("mesh: {file: package://known}"), "not a package URI");
  EXPECT_HAS(object("mesh: {file: http://x/a.stl}"), "http://x/a.stl: a scheme that is not known here");
  EXPECT_HAS(object("mesh: {file: 'file://a.stl'}"), "not a file URI");
  EXPECT_HAS(object("mesh: {file: open.obj, solid: yes}"),
             "open.obj: solid: yes, but the mesh is not closed: 4 open edges");
  EXPECT_EQ(object("mesh: {file: box.obj, solid: yes}"), "accepted");
  EXPECT_HAS(object("mesh: {file: box.obj, solid: maybe}"),
             "objects/o/mesh/solid: 'maybe' found; must be one of: auto, yes, no");
  EXPECT_HAS(object("mesh: {file: box.obj, scale: [1, 0, 1]}"),
             "objects/o/mesh/scale: a factor is 0; must not be 0");
  EXPECT_HAS(object("mesh: {file: box.obj, scale: 0}"), "objects/o/mesh/scale: a factor is 0");
  EXPECT_HAS(object("mesh: {file: box.obj, scale: [1, .inf, 1]}"),
             "objects/o/mesh/scale: element 1: .inf is not finite");
  EXPECT_HAS(object("mesh: {file: box.obj, scale: .inf}"), "objects/o/mesh/scale: .inf is not finite");
  EXPECT_HAS(object("convex: {file: box.obj, solid: yes}"), "objects/o/convex/solid: unknown key 'solid'");
  EXPECT_HAS(object("convex: {file: none.obj}"), "objects/o/convex/file: ");
}

TEST_F(SceneFaults, Urdf) {
  const auto object = [&](const std::string& shape) {
    return refusalOfObject("    pose: {fixed: {}}\n    " + shape + "\n");
  };
  EXPECT_HAS(object("urdf: absent.urdf"),
             "scene.yaml:4: objects/o/urdf: " + folder_.path() + "/absent.urdf: no such file");
  EXPECT_HAS(object("urdf: {}"),
             "objects/o/urdf: give exactly one of: file (a path or package:// URI), param");
  EXPECT_HAS(object("urdf: {file: a, param: b}"), "objects/o/urdf: give exactly one of");
  EXPECT_HAS(object("param: nobody_set_this"),
             "objects/o/param: parameter 'nobody_set_this' is not set or cannot be read here");
  EXPECT_HAS(object("urdf: []"), "objects/o/urdf: a list found; must be a text");
  folder_.write("bare.urdf", "<robot name='r'><link name='l'/></robot>");
  EXPECT_HAS(object("urdf: bare.urdf"),
             "objects/o/urdf: bare.urdf: no link has a collision element; at least one must");
  folder_.write("bad.urdf", test_support::robotUrdf("gone.stl"));
  EXPECT_HAS(object("urdf: bad.urdf"), "objects/o/urdf: bad.urdf: link 'tool', collision element 0: " +
                                           folder_.path() + "/gone.stl: no such mesh file");
  resources_.parameter = nullptr;
  EXPECT_HAS(object("param: robot_description"), "cannot be read here");
  resources_.parameter = [](const std::string&) -> std::string { throw std::runtime_error("no master"); };
  EXPECT_HAS(object("param: robot_description"), "cannot be read here (no master)");
}

TEST_F(SceneFaults, Poses) {
  const auto pose = [&](const std::string& value) {
    return refusalOfObject("    point: {}\n    pose: " + value + "\n");
  };
  EXPECT_HAS(pose("{}"), "scene.yaml:4: objects/o/pose: give exactly one of: topic, tf, fixed; found 0");
  EXPECT_HAS(pose("{topic: a, tf: b}"), "objects/o/pose: give exactly one of: topic, tf, fixed; found 2");
  EXPECT_HAS(pose("a/pose"),
             "objects/o/pose: 'a/pose' is not a map; write pose: {topic: …}, {tf: …} or {fixed: ");
  EXPECT_HAS(pose("{fixed: true}"),
             "objects/o/pose/fixed: 'true' is not a map; write fixed: {position: [x, y, z], ");
  EXPECT_HAS(pose("{topic: }"), "objects/o/pose/topic: nothing found; must be a text");
  EXPECT_HAS(pose("{topic: ''}"), "objects/o/pose/topic: an empty text found");
  EXPECT_HAS(pose("{tf: /}"), "objects/o/pose/tf: '/' is no frame");
  EXPECT_HAS(pose("{topic: a, index: -1}"),
             "objects/o/pose/index: '-1' found; must be a whole number from 0 to");
  EXPECT_HAS(pose("{topic: a, index: 1.5}"), "objects/o/pose/index: '1.5' found; must be a whole number");
  EXPECT_HAS(pose("{tf: a, index: 1}"), "objects/o/pose/index: only meant beside topic");
  EXPECT_HAS(pose("{fixed: {}, model: m}"), "objects/o/pose/model: only meant beside topic");
  EXPECT_HAS(pose("{topic: a, model: m, link: l}"),
             "objects/o/pose: give at most one of: index (PoseArray), model");
  EXPECT_HAS(pose("{topic: a, links: true}"), "objects/o/pose/links: links: true is only meant beside tf");
  EXPECT_HAS(pose("{tf: a, links: true}"), "objects/o/pose/links: only a urdf has links that move");
  EXPECT_EQ(pose("{tf: a, links: false}"), "accepted");
  EXPECT_HAS(pose("{tf: a, links: 3}"), "objects/o/pose/links: '3' found; must be true or false");
  EXPECT_HAS(pose("{fixed: {position: [0, 0]}}"),
             "objects/o/pose/fixed/position: a list of 2 found; must be three finite numbers");
  EXPECT_HAS(pose("{fixed: {position: [0, 0, .inf]}}"),
             "objects/o/pose/fixed/position: element 2: .inf is not finite");
  EXPECT_HAS(pose("{fixed: {orientation: [0, 0, 0, 0]}}"),
             "objects/o/pose/fixed/orientation: quaternion with |q|^2 = 0; must be a unit quaternion");
  EXPECT_HAS(pose("{fixed: {orientation: [0, 0, 0, 1.01]}}"), "quaternion with |q|^2 = 1.0201;");
  EXPECT_EQ(pose("{fixed: {orientation: [0, 0, 0, 1.004]}}"), "accepted");
  EXPECT_HAS(pose("{fixed: {orientation: [0, 0, 1]}}"),
             "a list of 3 found; must be a unit quaternion of four finite numbers");
  EXPECT_HAS(pose("{fixed: {orientaton: [0, 0, 0, 1]}}"),
             "objects/o/pose/fixed/orientaton: unknown key 'orientaton'; nearest known: 'orientation'");
}

TEST_F(SceneFaults, MotionAndLimits) {
  const auto object = [&](const std::string& line) {
    return refusalOfObject("    point: {}\n    pose: {tf: o}\n    " + line + "\n");
  };
  EXPECT_HAS(object("motion: cubic"),
             "scene.yaml:5: objects/o/motion: 'cubic' found; must be one of: slerp, hermite, spin");
  EXPECT_HAS(object("on_timeout: wait"), "objects/o/on_timeout: 'wait' found; must be one of: drop, freeze");
  EXPECT_HAS(object("max_speed: 0"), "objects/o/max_speed: 0 is out of range; must be > 0 [m/s]");
  EXPECT_HAS(object("max_spin: -1"), "objects/o/max_spin: -1 is out of range; must be > 0 [rad/s]");
  EXPECT_HAS(object("acceleration: -1"), "objects/o/acceleration: -1 is out of range; must be >= 0 [m/s^2]");
  EXPECT_HAS(object("angular_acceleration: fast"),
             "objects/o/angular_acceleration: 'fast' is not a number, >= 0 [rad/s^2]");
  EXPECT_HAS(object("max_sped: 3"), "objects/o/max_sped: unknown key 'max_sped'; nearest known: 'max_speed'");
  EXPECT_HAS(refusal("objects: {a/b: {point: {}, pose: {tf: o}}}\n"), "an object's name must not hold '/'");
  EXPECT_HAS(refusal("objects: {a: 3}\n"), "objects/a: '3' is not a map");
}

TEST_F(SceneFaults, Zones) {
  const auto object = [&](const std::string& zones) {
    return refusalOfObject("    urdf: robot.urdf\n    pose: {tf: o}\n    zones: " + zones + "\n");
  };
  EXPECT_HAS(object("{z: {link: tols}}"),
             "scene.yaml:5: objects/o/zones/z/link: unknown link 'tols' of 'o'; nearest known: 'tool'");
  EXPECT_HAS(object("{z: {}}"), "objects/o/zones/z: no link given");
  EXPECT_HAS(object("{z: 1}"), "objects/o/zones/z: '1' is not a map");
  EXPECT_HAS(object("{z: {link: tool, box: {}}}"), "objects/o/zones/z/box: no size given");
  EXPECT_HAS(object("{z: {link: tool, box: {size: [1, 1, 0]}}}"),
             "objects/o/zones/z/box/size: element 2 is 0; must be > 0 [m]");
  EXPECT_HAS(object("{z: {link: tool, box: {size: [1, 1, 1], orientation: [1, 1, 1, 1]}}}"),
             "objects/o/zones/z/box/orientation: quaternion with |q|^2 = 4;");
  EXPECT_HAS(object("{z: {link: tool, bx: {}}}"),
             "objects/o/zones/z/bx: unknown key 'bx'; nearest known: 'box'");
}

TEST_F(SceneFaults, TimePrecisionAndStats) {
  const auto scene = [&](const std::string& line) {
    return refusal(line + "\nobjects: {o: {point: {}, pose: {tf: o}}}\n");
  };
  EXPECT_HAS(scene("time: {max_gap: 5}"),
             "scene.yaml:1: time/timeout: 1.5 is less than max_gap + reorder; must be >= 5 + 0.1 [s]");
  EXPECT_HAS(scene("time: {timeout: 1}"),
             "scene.yaml:1: time/timeout: 1 is less than max_gap + reorder; must be >= 1 + 0.1 [s]");
  EXPECT_EQ(scene("time: {timeout: 0.3, max_gap: 0.1, reorder: 0.2}"), "accepted");
  EXPECT_HAS(scene("time: {timeout: 0.299999999, max_gap: 0.1, reorder: 0.2}"),
             "is less than max_gap + reorder");
  EXPECT_HAS(scene("time: {reorder: -1}"), "time/reorder: -1 is out of range; must be >= 0 and <= 3e+09 [s]");
  EXPECT_HAS(scene("time: {max_gap: 0}"), "time/max_gap: 0 is out of range; must be > 0");
  EXPECT_HAS(scene("time: {jump: 1e10}"), "time/jump: 1e+10 is out of range; must be > 0 and <= 3e+09 [s]");
  EXPECT_HAS(scene("time: {wait: 1}"), "time/wait: unknown key 'wait'");
  EXPECT_HAS(scene("time: 3"), "time: '3' is not a map");
  EXPECT_HAS(scene("precision: {distance: 0}"), "precision/distance: 0 is out of range; must be > 0 [m]");
  EXPECT_HAS(scene("stats: {period: 0}"), "stats/period: 0 is out of range");
  EXPECT_HAS(scene("stats: {perod: 1}"), "stats/perod: unknown key 'perod'; nearest known: 'period'");
  EXPECT_HAS(scene("node_budget: 0"), "node_budget: '0' found; must be a whole number from 1 to");
  EXPECT_HAS(scene("world_frame: []"), "world_frame: a list found; must be a text");
  EXPECT_HAS(scene("world_frame: /"), "world_frame: '/' is no frame");
}

TEST_F(SceneFaults, OverridesAreNamedInTheirFaults) {
  const std::string text = "objects: {o: {point: {}, pose: {tf: o}}}\n";
  EXPECT_HAS(refusal(text, {{"precision/time", "-1"}}),
             "override precision/time: precision/time: -1 is out of range; must be > 0 [s]");
  EXPECT_HAS(refusal(text, {{"presicion/time", "1"}}),
             "override presicion/time: presicion: unknown key 'presicion'; nearest known: 'precision'");
  EXPECT_HAS(refusal(text, {{"time", "[1, 2"}}), "override time: not valid YAML: ");
  EXPECT_HAS(refusal(text, {{"objects/o/pose/tf/x", "1"}}),
             "override objects/o/pose/tf/x: objects/o/pose/tf (");
  EXPECT_HAS(refusal(text, {{"objects/o/pose/tf/x", "1"}}), "is not a map, so it has no key 'x'");
  EXPECT_HAS(refusal(text, {{"", "1"}}), "not a key path");
  EXPECT_HAS(refusal(text, {{"a//b", "1"}}), "override a//b: not a key path");
  EXPECT_HAS(refusal(text, {{"objects/p/sphere/radius", "0"}}),
             "override objects/p/sphere/radius: objects/p/sphere/radius: 0 is out of range");
}

}  // namespace
}  // namespace collision_node::scene

#include <random>

#include "test/support/scene_texts.h"

namespace collision_node::scene {
namespace {

/// Two robots (links base, arm, tool with a shape, sensor without) and a ball.
const std::string kObjects = R"(
objects:
  robot: {urdf: robot.urdf, pose: {topic: robot/pose}}
  ball: {sphere: {radius: 1}, pose: {topic: ball/pose}}
  twin: {urdf: robot.urdf, pose: {fixed: {position: [50, 0, 0]}}}
)";

class ScenePairs : public test_support::SceneTest {
 protected:
  std::vector<std::string> watched(const Scene& scene) {
    std::vector<std::string> names;
    for (const LinkPair& pair : scene.pairs.list(scene.objects)) {
      const Object& a = scene.objects.at(pair.object_a);
      const Object& b = scene.objects.at(pair.object_b);
      names.push_back(a.name + "/" + a.links.at(pair.link_a).name + " " + b.name + "/" +
                      b.links.at(pair.link_b).name);
    }
    return names;
  }
  static std::string reason(const Scene& scene, const std::string& a, const std::string& b) {
    const auto nameOf = [&](int object, int link) {
      return scene.objects[object].name + "/" + scene.objects[object].links[link].name;
    };
    for (const auto& [objects, verdicts] : scene.pairs.exceptions()) {
      for (const PairVerdict& verdict : verdicts) {
        const LinkPair& pair = verdict.pair;
        if (nameOf(pair.object_a, pair.link_a) == a && nameOf(pair.object_b, pair.link_b) == b)
          return verdict.against;
      }
    }
    if (!scene.pairs.watchesRest()) return scene.pairs.reasonAgainstRest();
    return "watched or unknown";
  }
  std::string fault(const std::string& pairs) { return refusal(kObjects + "pairs: " + pairs + "\n"); }
};

using Names = std::vector<std::string>;

TEST_F(ScenePairs, EveryLinkWithAShapeAgainstEveryOtherObjectInByteOrder) {
  const auto scene = load(kObjects);
  EXPECT_EQ(watched(*scene), (Names{"ball/ball robot/arm", "ball/ball robot/base", "ball/ball robot/tool",
                                    "ball/ball twin/arm", "ball/ball twin/base", "ball/ball twin/tool",
                                    "robot/arm twin/arm", "robot/arm twin/base", "robot/arm twin/tool",
                                    "robot/base twin/arm", "robot/base twin/base", "robot/base twin/tool",
                                    "robot/tool twin/arm", "robot/tool twin/base", "robot/tool twin/tool"}));
  EXPECT_EQ(scene->pairs.exceptions().size(), 2u);
  EXPECT_EQ(reason(*scene, "robot/arm", "robot/base"), "neighbours in the URDF");
  EXPECT_EQ(reason(*scene, "robot/base", "robot/tool"), "links of one object, pairs/self is not true");
}

TEST_F(ScenePairs, IgnoreByObjectAndByLink) {
  const auto scene =
      load(kObjects + "pairs: {ignore: [[robot, twin], [twin/arm, ball], [ball, robot/base]]}\n");
  EXPECT_EQ(watched(*scene), (Names{"ball/ball robot/arm", "ball/ball robot/tool", "ball/ball twin/base",
                                    "ball/ball twin/tool"}));
  EXPECT_EQ(reason(*scene, "ball/ball", "twin/arm"), "listed in pairs/ignore");
}

TEST_F(ScenePairs, OnlyListsWhatIsWatchedAlsoWithinOneObject) {
  const auto scene = load(kObjects + "pairs: {only: [[twin/tool, ball], [robot/tool, robot/base]]}\n");
  EXPECT_EQ(watched(*scene), (Names{"ball/ball twin/tool", "robot/base robot/tool"}));
  EXPECT_EQ(reason(*scene, "ball/ball", "robot/arm"), "not listed in pairs/only");
  EXPECT_TRUE(watched(*load(kObjects + "pairs: {only: []}\n")).empty());
}

TEST_F(ScenePairs, SelfPairsLinksOfOneObjectButNeverNeighbours) {
  const auto scene = load("objects: {robot: {urdf: robot.urdf, pose: {tf: r}}}\npairs: {self: true}\n");
  EXPECT_EQ(watched(*scene), (Names{"robot/base robot/tool"}));
  EXPECT_EQ(reason(*scene, "robot/arm", "robot/tool"), "neighbours in the URDF");
}

TEST_F(ScenePairs, TwoFixedObjectsAreAPair) {
  const auto scene =
      load("objects: {a: {point: {}, pose: {fixed: {}}}, b: {point: {}, pose: {fixed: {}}}}\n");
  EXPECT_EQ(watched(*scene), (Names{"a/a b/b"}));
  EXPECT_EQ(scene->warnings.size(), 1u);  // nothing moves
}

TEST_F(ScenePairs, NoPairIsAWarning) {
  const auto scene = load("objects: {a: {point: {}, pose: {tf: a}}}\n");
  ASSERT_EQ(scene->warnings.size(), 1u);
  EXPECT_HAS(scene->warnings[0], "no pair is watched");
}

TEST_F(ScenePairs, ContactDistanceTheLastThatFitsCounts) {
  const auto scene = load(kObjects + R"(
pairs:
  contact_distance: 0.5
  only: [[ball, robot], [ball, twin/arm]]
  distances:
    - {pair: [robot, ball], contact_distance: 0.25}
    - {pair: [ball, robot/tool], contact_distance: 0}
)");
  const auto pairs = scene->pairs.list(scene->objects);
  ASSERT_EQ(pairs.size(), 4u);
  EXPECT_EQ(pairs[0].contact_distance, 0.25);  // robot/arm
  EXPECT_EQ(pairs[2].contact_distance, 0.0);   // robot/tool
  EXPECT_EQ(pairs[3].contact_distance, 0.5);   // twin/arm
}

TEST_F(ScenePairs, FaultsNameWhatIsKnown) {
  EXPECT_HAS(fault("{ignore: [[robt, ball]]}"),
             "pairs/ignore: unknown object 'robt'; nearest known: 'robot'");
  EXPECT_HAS(fault("{only: [[robot/tol, ball]]}"),
             "pairs/only: unknown link 'tol' of 'robot'; nearest known: 'tool'");
  EXPECT_HAS(fault("{ignore: [robot, ball]}"), "pairs/ignore: 'robot' found; must be a pair [a, b]");
  EXPECT_HAS(fault("{ignore: [[robot, ball, twin]]}"), "must be a pair [a, b]");
  EXPECT_HAS(fault("{ignore: [[robot, []]]}"),
             "pairs/ignore: a list found; must be an object's name or object/link");
  EXPECT_HAS(fault("{ignore: robot}"), "pairs/ignore: 'robot' found; must be a list of pairs");
  EXPECT_HAS(fault("{self: 2}"), "pairs/self: '2' found; must be true or false");
  EXPECT_HAS(fault("{contact_distance: -1}"), "pairs/contact_distance: -1 is out of range; must be >= 0 [m]");
  EXPECT_HAS(fault("{distances: 3}"), "pairs/distances: '3' found; must be a list of {pair:");
  EXPECT_HAS(fault("{distances: [{pair: [robot, ball]}]}"), "pairs/distances[0]: no contact_distance given");
  EXPECT_HAS(fault("{distances: [{contact_distance: 1}]}"), "pairs/distances[0]: no pair given");
  EXPECT_HAS(fault("{distances: [{pair: [robot, bal], contact_distance: 1}]}"),
             "unknown object 'bal'; nearest known: 'ball'");
  EXPECT_HAS(fault("{distances: [{pair: [robot, ball], contact_distance: -2}]}"),
             "pairs/distances[0]/contact_distance: -2 is out of range");
  EXPECT_HAS(fault("{ignored: []}"), "pairs/ignored: unknown key 'ignored'; nearest known: 'ignore'");
  EXPECT_HAS(fault("[]"), "pairs: a list is not a map");
}

TEST_F(ScenePairs, OfAnObjectInNoPairNothingIsReadOrBuilt) {
  folder_.write("broken.obj", "this is no mesh");
  const std::string objects = R"(
objects:
  ball: {sphere: {radius: 1}, pose: {topic: ball/pose}}
  stone: {mesh: {file: box.obj}, pose: {fixed: {}}}
  house: {mesh: {file: broken.obj}, pose: {fixed: {}}}
)";
  EXPECT_HAS(refusal(objects), "broken.obj: not a mesh that can be read");
  for (const std::string key : {"only", "ignore"}) {
    const std::string reason = key == "only" ? "not listed in pairs/only" : "listed in pairs/ignore";
    const auto scene = load(objects + "pairs: {" + key + ": " +
                            (key == "only" ? "[[ball, stone]]}" : "[[house, ball], [stone, house]]}"));
    ASSERT_EQ(scene->objects[1].name, "house");
    EXPECT_EQ(scene->objects[1].links[0].body, nullptr);
    EXPECT_NE(scene->objects[2].links[0].body, nullptr);
    EXPECT_EQ(watched(*scene), Names{"ball/ball stone/stone"});
    const std::string plan = planText(*scene);
    EXPECT_HAS(plan,
               "    link house, at [0, 0, 0] m\n      shape 0: mesh broken.obj, at [0, 0, 0] m\n"
               "        not read: the object is in no watched pair\n");
    EXPECT_HAS(plan, "  house: in no watched pair (" + reason +
                         "): no mesh of it is read, no hierarchy is built, nothing can meet it\n");
    EXPECT_HAS_NOT(plan, "assimp is not called");
  }
  EXPECT_HAS(planText(*load(objects + "pairs: {only: []}")), "no mesh: assimp is not called");
  // A file that is not there is a mistake all the same.
  folder_.write("empty.obj", "");
  for (const char* file : {"missing.obj", "empty.obj"}) {
    std::string missing = objects;
    missing.replace(missing.find("broken.obj"), 10, file);
    EXPECT_HAS(refusal(missing + "pairs: {only: [[ball, stone]]}"), file);
  }
}

/// A pair without a body would be a crash; a body without a pair is only a waste.
TEST_F(ScenePairs, WhoIsReadIsWhoIsInAPairWhateverThePairsSay) {
  std::mt19937 random(3);
  const std::vector<std::string> names = {"ball", "robot", "twin", "robot/arm", "twin/tool", "post"};
  int left_out = 0;
  for (int round = 0; round < 300; ++round) {
    std::string text = kObjects + "  post: {sphere: {radius: 1}, pose: {fixed: {}}}\npairs:\n";
    const std::string key = random() % 2 ? "only" : "ignore";
    text += "  self: " + std::string(random() % 2 ? "true" : "false") + "\n  " + key + ": [";
    for (unsigned n = random() % 9; n > 0; --n)
      text += "[" + names[random() % names.size()] + ", " + names[random() % names.size()] + "], ";
    const auto scene = load(text + "]\n");
    for (const LinkPair& pair : scene->pairs.list(scene->objects)) {
      ASSERT_NE(scene->objects[pair.object_a].links[pair.link_a].body, nullptr) << text;
      ASSERT_NE(scene->objects[pair.object_b].links[pair.link_b].body, nullptr) << text;
    }
    for (const Object& object : scene->objects) left_out += object.links[0].body ? 0 : 1;
  }
  EXPECT_GT(left_out, 100);
}

}  // namespace
}  // namespace collision_node::scene

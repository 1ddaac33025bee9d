// What is in no watched pair is not read, heard or waited for, and changes nothing that is said of the
// others.
#include <gtest/gtest.h>

#include <cstdlib>
#include <set>

#include "collision_node/scene/needs.h"
#include "test/scene/random_streams.h"
#include "test/scene/same_run.h"
#include "test/support/scene_texts.h"

namespace collision_node::scene {
namespace {

using Lines = std::vector<std::string>;

std::shared_ptr<Scene> ballWallAndIdler() {
  auto scene = sceneOf({movingSphere("ball"), movingSphere("idler"), fixedSphere("wall", 10.0)});
  scene->pairs = {{0, 0, 2, 0, 0.0}};
  return scene;
}

TEST(LeftOut, NobodyWaitsForItNorNamesIt) {
  Rig rig(ballWallAndIdler());
  rig.feedLine(0, 0, 1000, 100, 0.0, 20.0);
  EXPECT_EQ(rig.events.size(), 2u);
  const Stats stats = rig.engine.stats();
  EXPECT_EQ(stats.watermark_ns, 900 * kMs);
  EXPECT_EQ(stats.uncovered_objects, Lines{});
  EXPECT_EQ(allBins(stats), 1u);
}

TEST(LeftOut, ItsPosesAreNotLookedAt) {
  Rig rig(ballWallAndIdler());
  rig.engine.addPose(1, poseAt(5000, 10.0));
  rig.feedLine(0, 0, 1000, 100, 0.0, 20.0);
  rig.engine.addPose(1, poseAt(0, 10.0));  // back, by more than `jump`
  rig.engine.addPose(1, poseAt(100, std::nan("")));
  rig.engine.fix(1, Pose());
  rig.engine.flush();
  EXPECT_EQ(rig.events.size(), 2u);
  const Stats stats = rig.engine.stats();
  EXPECT_EQ(stats.epoch, 0u);
  EXPECT_EQ(stats.accepted, 11u);
  EXPECT_EQ(stats.rejected + stats.late + stats.holes, 0u);
  EXPECT_EQ(stats.stamp_ns, 1000 * kMs);
}

/// Adds objects that chance moves as the others, but that are in no pair.
void addIdlers(RandomScene& random, int idlers) {
  Scene& scene = *random.scene;
  const int others = static_cast<int>(scene.objects.size());
  RandomScene more(static_cast<unsigned>(random.dice().below(1 << 30)), idlers);
  for (int i = 0; i < idlers; ++i) {
    scene.objects.push_back(more.scene->objects[i]);
    scene.objects.back().name = "z" + std::to_string(i);
    for (int other = 0; other <= others + i; ++other) scene.pairs.set(other, others + i, {});
  }
}

/// The same scene without them.
std::shared_ptr<Scene> firstOf(const Scene& scene, int objects) {
  auto out = std::make_shared<Scene>(scene);
  out->objects.resize(objects);
  const PairRules& pairs = scene.pairs;
  out->pairs = pairs.watchesRest() ? PairRules(pairs.halfDistances(objects + 1).back() * 2.0) : PairRules();
  if (!pairs.watchesRest()) out->pairs.watchNothingElse(pairs.reasonAgainstRest());
  for (const auto& [key, verdicts] : pairs.exceptions())
    if (key.second < objects) out->pairs.set(key.first, key.second, verdicts);
  return out;
}

struct Tally {
  std::size_t events = 0, beats = 0;
};

void compare(unsigned seed, int objects, Tally& tally) {
  SCOPED_TRACE("seed " + std::to_string(seed) + ", " + std::to_string(objects) + " objects");
  RandomScene random(seed, objects);
  addIdlers(random, 1 + static_cast<int>(seed % 3));
  const RandomStreams streams(random);
  const auto alone = firstOf(*random.scene, objects);
  ASSERT_EQ(alone->pairs.count(alone->objects), random.scene->pairs.count(random.scene->objects));
  Rig without(alone, impact::MethodName::kCertified);
  streams.play(without, objects);
  for (const bool everything : {false, true}) {
    Rig with(random.scene, impact::MethodName::kCertified, {everything, 1});
    streams.play(with);
    EXPECT_EQ(difference(texts(with.events), texts(without.events)), "");
    EXPECT_EQ(difference(texts(with.beats), texts(without.beats)), "");
    EXPECT_EQ(with.engine.stats().accepted, without.engine.stats().accepted);
    for (const Stats& beat : with.beats) EXPECT_EQ(allBins(beat), alone->pairs.count(alone->objects));
  }
  tally.events += without.events.size();
  tally.beats += without.beats.size();
}

TEST(LeftOut, ChangesNothingThatIsSaidOfTheOthersOnRandomScenes) {
  Tally tally;
  const unsigned scenes = std::getenv("COLLISION_NODE_LONG") != nullptr ? 3000 : 60;
  for (unsigned seed = 1; seed <= scenes && !testing::Test::HasFailure(); ++seed)
    compare(seed, 2 + static_cast<int>(seed % 9), tally);
  EXPECT_GT(tally.events, 150u);
  EXPECT_GT(tally.beats, 100u);
}

TEST(LeftOut, ChangesNothingBesideABroadPhase) {
  Tally tally;
  const unsigned scenes = std::getenv("COLLISION_NODE_LONG") != nullptr ? 100 : 2;
  for (unsigned seed = 1; seed <= scenes && !testing::Test::HasFailure(); ++seed)
    compare(200000 + seed, 47 + static_cast<int>(seed % 4), tally);
  EXPECT_GT(tally.events, 50u);
}

TEST(LeftOut, IsWhoIsInNoPairOfTheList) {
  int watched = 0, left_out = 0;
  for (unsigned seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE(seed);
    RandomScene random(seed, 2 + static_cast<int>(seed % 7));
    if (seed % 2 == 0) addIdlers(random, 1);
    const Scene& scene = *random.scene;
    std::map<std::pair<int, int>, std::uint64_t> listed;
    for (const LinkPair& pair : scene.pairs.list(scene.objects)) {
      ++listed[{pair.object_a, pair.link_a}];
      ++listed[{pair.object_b, pair.link_b}];
    }
    const auto counts = scene.pairs.countByLink(scene.objects);
    const std::vector<Need> needs = needsOf(scene);
    for (int i = 0; i < static_cast<int>(needs.size()); ++i) {
      std::uint64_t all = 0;
      for (int k = 0; k < static_cast<int>(counts[i].size()); ++k) {
        const std::uint64_t expected = listed[{i, k}];
        EXPECT_EQ(counts[i][k], expected);
        all += expected;
      }
      EXPECT_EQ(needs[i], all > 0 ? Need::kWatched : Need::kNone);
      (all > 0 ? watched : left_out) += 1;
    }
  }
  EXPECT_GT(watched, 500);
  EXPECT_GT(left_out, 150);
}

// ---- what the plan says

class LeftOutPlan : public test_support::SceneTest {};

TEST_F(LeftOutPlan, SaysWhoIsNeitherReadNorWaitedForAndWhy) {
  const auto scene = load(R"(
objects:
  ball: {sphere: {radius: 1}, pose: {topic: ball/pose}}
  idler: {mesh: {file: box.obj}, pose: {topic: idler/pose}}
  post: {sphere: {radius: 1}, pose: {fixed: {}}}
  scout: {sphere: {radius: 1}, pose: {tf: scout}}
  stone: {sphere: {radius: 1}, pose: {fixed: {}}}
pairs: {ignore: [[idler, ball], [idler, stone], [idler, scout], [idler, post], [scout, ball], [scout, stone], [scout, post],
                 [post, ball], [post, stone]]}
)");
  const std::string why = " in no watched pair (listed in pairs/ignore): ";
  EXPECT_EQ(
      leftOut(*scene),
      (Lines{"idler:" + why +
                 "no mesh of it is read, no hierarchy is built, its poses are neither read nor waited for",
             "post:" + why + "no hierarchy is built, nothing can meet it",
             "scout:" + why + "no hierarchy is built, its poses are neither read nor waited for"}));
  const std::string plan = planText(*scene);
  for (const std::string& line : leftOut(*scene)) EXPECT_HAS(plan, "  " + line + "\n");
  EXPECT_HAS(plan, "no object is driven through tf: no transforms are read");
  EXPECT_HAS(plan, "no mesh: assimp is not called");
  for (const Object& object : scene->objects)
    EXPECT_EQ(object.links[0].body != nullptr, object.name == "ball" || object.name == "stone");
}

/// base - turn - arm - reach - hand
const char* const kCrane = R"(<robot name='crane'>
  <link name='base'><collision><geometry><box size='1 1 1'/></geometry></collision></link>
  <link name='arm'><collision><geometry><box size='1 1 1'/></geometry></collision></link>
  <link name='hand'><collision><geometry><box size='1 1 1'/></geometry></collision></link>
  <joint name='turn' type='continuous'><parent link='base'/><child link='arm'/></joint>
  <joint name='reach' type='prismatic'><parent link='arm'/><child link='hand'/>
    <limit lower='0' upper='1' effort='1' velocity='1'/></joint>
</robot>)";

TEST_F(LeftOutPlan, KeepsThePosesOfABaseForThePartsThatHangOnIt) {
  folder_.write("crane.urdf", kCrane);
  const auto crane = [&](const std::string& pose) {
    return load(
        "objects:\n  ball: {sphere: {radius: 1}, pose: {topic: ball}}\n  crane: {urdf: crane.urdf, pose: " +
        pose + "}\npairs: {only: [[ball, crane/hand]]}\n");
  };
  const auto jointed = crane("{topic: base}, joints: {topic: joints}");
  EXPECT_EQ(needsOf(*jointed),  // ball, base, arm, hand
            (std::vector<Need>{Need::kWatched, Need::kAsParent, Need::kNone, Need::kWatched}));
  EXPECT_EQ(
      leftOut(*jointed),
      (Lines{
          "crane/base: in no watched pair (not listed in pairs/only): no hierarchy is built, its poses only "
          "place the parts that joints move on it",
          "crane/arm: in no watched pair (not listed in pairs/only): no hierarchy is built, its poses are "
          "neither read nor waited for"}));
  const auto framed = crane("{tf: base, links: true}");
  EXPECT_EQ(needsOf(*framed), (std::vector<Need>{Need::kWatched, Need::kNone, Need::kNone, Need::kWatched}));
  // One line for a whole object, however many parts it has.
  EXPECT_EQ(leftOut(*load("objects:\n  ball: {sphere: {radius: 1}, pose: {topic: ball}}\n  cube: {box: "
                          "{size: [1, 1, 1]}, "
                          "pose: {fixed: {}}}\n  crane: {urdf: crane.urdf, pose: {tf: base, links: true}}\n"
                          "pairs: {only: [[ball, cube]]}\n"))
                .size(),
            1u);
}

TEST_F(LeftOutPlan, SaysThatAnObjectWithoutCompanyIsInNoPair) {
  const auto lone = load("objects: {ball: {point: {}, pose: {topic: ball}}}\n");
  EXPECT_HAS(leftOut(*lone).at(0), "ball: in no watched pair (nothing else is there): ");
  EXPECT_HAS(lone->warnings.at(0), "no pair is watched: no pose is read, nothing can be reported");
}

TEST_F(LeftOutPlan, AMoverThatNobodyMeetsIsNoMover) {
  const auto scene = load(R"(
objects:
  ball: {point: {}, pose: {topic: ball}}
  post: {point: {}, pose: {fixed: {}}}
  wall: {point: {}, pose: {fixed: {}}}
pairs: {only: [[post, wall]]}
)");
  EXPECT_HAS(scene->warnings.at(0), "no watched object moves: each pair is tested once");
}

}  // namespace
}  // namespace collision_node::scene

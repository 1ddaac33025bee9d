/// A track that is sent as a whole, ahead of its time, beside others that send as time goes.
#include <gtest/gtest.h>

#include "test/scene/engine_fixture.h"

namespace collision_node::scene {
namespace {

std::shared_ptr<Scene> twoMoving() { return sceneOf({movingSphere("path"), movingSphere("wall")}); }

/// Twenty seconds at once: ten times `timeout`.
void feedPath(Rig& rig, Nanoseconds from_ms = 0) {
  for (Nanoseconds t = from_ms; t <= 20000; t += 500) {
    motion::StampedPose pose = poseAt(t, 40.0 - 10e-3 * static_cast<double>(t));
    pose.comes_ahead = true;
    rig.engine.addPose(0, pose);
  }
}

TEST(SentAhead, nobodyIsLateForATrackThatIsAhead) {
  Rig first(twoMoving());  // timeout 1.5 s
  feedPath(first);
  EXPECT_FALSE(first.engine.stats().has_watermark) << "the wall is waited for";
  EXPECT_TRUE(first.beats.empty()) << "time has not begun";
  first.feedLine(1, 0, 6000, 500, 0.0, 0.0);
  EXPECT_EQ(first.engine.stats().watermark_ns, 5500 * kMs);
  EXPECT_TRUE(first.engine.stats().uncovered_objects.empty());
  EXPECT_EQ(first.beats.size(), 5u) << "one a second, as the wall goes on";
  first.engine.flush();

  // The same in another order.
  Rig second(twoMoving());
  second.feedLine(1, 0, 1000, 500, 0.0, 0.0);
  feedPath(second);
  second.feedLine(1, 1500, 6000, 500, 0.0, 0.0);
  second.engine.flush();
  EXPECT_EQ(kinds(first.events),
            (std::vector<std::string>{"IMPACT/CONFIRMED/NONE", "SEPARATION/CONFIRMED/NONE"}));
  EXPECT_EQ(texts(first.events), texts(second.events));
}

TEST(SentAhead, aTrackThatIsSentAheadIsMissedLikeAnyOther) {
  Rig rig(twoMoving());
  rig.feedLine(1, 0, 6000, 500, 0.0, 0.0);
  EXPECT_EQ(rig.engine.stats().uncovered_objects, std::vector<std::string>{"path"});
  feedPath(rig);
  EXPECT_EQ(rig.engine.stats().late, 11u) << "it joins where the scene is, at 5500 ms";
}

TEST(SentAhead, whereAllAreSentAheadTheFarthestTellsTheTime) {
  auto scene = twoMoving();
  scene->objects.erase(scene->objects.begin() + 1);
  scene->objects.push_back(fixedSphere("wall", 0.0));
  Rig rig(scene);
  feedPath(rig);
  EXPECT_EQ(kinds(rig.events),
            (std::vector<std::string>{"IMPACT/CONFIRMED/NONE", "SEPARATION/CONFIRMED/NONE"}));
  EXPECT_GE(rig.beats.size(), 19u);
}

}  // namespace
}  // namespace collision_node::scene

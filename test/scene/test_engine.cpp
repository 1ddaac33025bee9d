// Poses in, events out: order, numbers and certificates. The pairs are solved by a stand-in in closed
// form.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <stdexcept>

#include "test/scene/engine_fixture.h"

namespace collision_node::scene {
namespace {

using Kinds = std::vector<std::string>;

TEST(Engine, AnImpactAndItsSeparationShareAContact) {
  Rig rig(sceneOf({movingSphere("ball"), fixedSphere("wall", 10.0)}));
  rig.feedLine(0, 0, 1000, 100, 0.0, 20.0);  // meets at 9 m (0.45 s), leaves at 11 m (0.55 s)
  rig.engine.flush();
  ASSERT_EQ(kinds(rig.events), (Kinds{"IMPACT/CONFIRMED/NONE", "SEPARATION/CONFIRMED/NONE"}));
  const Event& hit = rig.events[0];
  EXPECT_EQ(hit.event_id, 0u);
  EXPECT_EQ(hit.contact_id, 0u);
  EXPECT_EQ(rig.events[1].event_id, 1u);
  EXPECT_EQ(rig.events[1].contact_id, 0u);
  EXPECT_EQ(hit.interval_start_ns, 400 * kMs);
  EXPECT_EQ(hit.interval_end_ns, 500 * kMs);
  EXPECT_NEAR(hit.toi_lower, 0.05, 1e-12);
  EXPECT_NEAR(static_cast<double>(hit.stamp_ns), 450e6, 1.0);
  EXPECT_EQ(hit.a.object, "ball");
  EXPECT_EQ(hit.b.object, "wall");
  EXPECT_EQ(hit.a.sample_before_ns, 400 * kMs);
  EXPECT_TRUE(std::isnan(hit.model_toi_lower));
  EXPECT_LT((hit.a.pose.position - Vec3(9, 0, 0)).norm(), 1e-9);
}

TEST(Engine, AnImpactInTheLastSegmentIsReported) {
  Rig rig(sceneOf({movingSphere("ball"), fixedSphere("wall", 10.0)}));
  rig.feedLine(0, 0, 500, 100, 0.0, 20.0);
  EXPECT_TRUE(rig.events.empty());  // the last stamp is not released before the end
  rig.engine.flush();
  EXPECT_EQ(kinds(rig.events), Kinds{"IMPACT/CONFIRMED/NONE"});  // still touching: no event
}

TEST(Engine, NothingIsPublishedBeforeTheWatermarkPassesIt) {
  Rig rig(sceneOf({movingSphere("a"), movingSphere("b"), fixedSphere("wall", 10.0)}));
  rig.feedLine(0, 0, 1000, 100, 0.0, 20.0);  // hits the wall at 0.45 s
  rig.feedLine(1, 0, 500, 100, 100.0, 0.0);
  EXPECT_TRUE(rig.events.empty());  // b is known up to 0.4 s
  rig.feedLine(1, 600, 600, 100, 100.0, 0.0);
  EXPECT_EQ(rig.events.size(), 1u);  // up to 0.5 s
  EXPECT_EQ(rig.engine.stats().watermark_ns, 500 * kMs);
}

TEST(Engine, EventsOfManyPairsComeInOrder) {
  const unsigned seed = 31;
  std::mt19937_64 random(seed);
  std::size_t seen = 0;
  for (int round = 0; round < 50; ++round) {
    SCOPED_TRACE("seed " + std::to_string(seed) + " round " + std::to_string(round));
    std::vector<Object> objects;
    for (int i = 0; i < 5; ++i) objects.push_back(movingSphere("o" + std::to_string(i)));
    Rig rig(sceneOf(objects));
    // Each has its own rate, phase and speed; arrival is by stamp with jitter less than `reorder`.
    std::vector<std::tuple<Nanoseconds, int, motion::StampedPose>> arrivals;
    for (int i = 0; i < 5; ++i) {
      const Nanoseconds step = 20 + static_cast<Nanoseconds>(random() % 80);
      const double v = static_cast<double>(random() % 40) - 20.0, x0 = 8.0 * i;
      for (Nanoseconds t = static_cast<Nanoseconds>(random() % 50); t < 3000; t += step)
        arrivals.emplace_back(t, i, poseAt(t, x0 + v * 1e-3 * static_cast<double>(t)));
    }
    std::stable_sort(arrivals.begin(), arrivals.end(),
                     [](const auto& l, const auto& r) { return std::get<0>(l) < std::get<0>(r); });
    for (const auto& [when, object, pose] : arrivals) rig.engine.addPose(object, pose);
    rig.engine.flush();
    seen += rig.events.size();
    for (std::size_t i = 0; i < rig.events.size(); ++i) {
      EXPECT_EQ(rig.events[i].event_id, i);
      if (i > 0) {
        EXPECT_LE(rig.events[i - 1].stamp_ns, rig.events[i].stamp_ns);
      }
    }

    // The same poses in another order of arrival: the same events.
    Rig other(sceneOf(objects));
    for (auto& arrival : arrivals) std::get<0>(arrival) += static_cast<Nanoseconds>(random() % 100);
    std::stable_sort(arrivals.begin(), arrivals.end(),
                     [](const auto& l, const auto& r) { return std::get<0>(l) < std::get<0>(r); });
    for (const auto& [when, object, pose] : arrivals) other.engine.addPose(object, pose);
    other.engine.flush();
    EXPECT_EQ(other.engine.stats().late, 0u);
    EXPECT_GT(other.engine.stats().reordered, 0u);
    EXPECT_EQ(texts(rig.events), texts(other.events));
  }
  EXPECT_GT(seen, 300u);
}

TEST(Engine, EqualInstantsAreOrderedByNames) {
  // Three balls at rest are met at the same moment.
  std::vector<Object> objects;
  for (const char* name : {"a", "b", "c", "hammer"})
    objects.push_back(name[0] == 'h' ? movingSphere(name) : fixedSphere(name, 10.0));
  auto scene = sceneOf(objects);
  scene->pairs = {{0, 0, 3, 0, 0.0}, {1, 0, 3, 0, 0.0}, {2, 0, 3, 0, 0.0}};
  Rig rig(scene);
  rig.feedLine(3, 0, 1000, 100, 0.0, 20.0);
  rig.engine.flush();
  ASSERT_EQ(rig.events.size(), 6u);
  EXPECT_EQ(rig.events[0].a.object, "a");
  EXPECT_EQ(rig.events[1].a.object, "b");
  EXPECT_EQ(rig.events[2].a.object, "c");
  EXPECT_EQ(rig.events[3].contact_id, 0u);
  EXPECT_EQ(rig.events[4].contact_id, 1u);
}

TEST(Engine, AFlushInTheMiddleMissesNothing) {
  for (Nanoseconds flush_at = 100; flush_at <= 900; flush_at += 100) {
    Rig rig(sceneOf({movingSphere("ball"), fixedSphere("wall", 10.0)}));
    for (Nanoseconds t = 0; t <= 1000; t += 100) {
      rig.engine.addPose(0, poseAt(t, 0.02 * static_cast<double>(t)));
      if (t == flush_at) rig.engine.flush();
    }
    rig.engine.flush();
    EXPECT_EQ(kinds(rig.events), (Kinds{"IMPACT/CONFIRMED/NONE", "SEPARATION/CONFIRMED/NONE"})) << flush_at;
    EXPECT_EQ(rig.events[1].contact_id, 0u);
  }
}

// README: "a stamp is when the object was there"
TEST(Engine, AGuessedStampIsNotCertified) {
  Rig rig(sceneOf({movingSphere("ball"), fixedSphere("wall", 10.0)}));
  for (Nanoseconds t = 0; t <= 1000; t += 100)
    rig.engine.addPose(0, poseAt(t, 0.02 * static_cast<double>(t)), t == 400);
  rig.engine.flush();
  EXPECT_EQ(kinds(rig.events), (Kinds{"IMPACT/UNCERTIFIED/STAMP_GUESSED", "SEPARATION/CONFIRMED/NONE"}));
}

TEST(Engine, C13_ATurnTooFarForSlerpIsNotCertified) {
  Rig rig(sceneOf({movingSphere("ball"), fixedSphere("wall", 10.0)}));
  for (Nanoseconds t = 0; t <= 1000; t += 100) {
    motion::StampedPose pose = poseAt(t, 0.02 * static_cast<double>(t));
    pose.has_twist = true;
    pose.angular = Vec3(0, 0, 40.0);
    rig.engine.addPose(0, pose);
  }
  rig.engine.flush();
  EXPECT_EQ(kinds(rig.events), (Kinds{"IMPACT/UNCERTIFIED/ALIAS", "SEPARATION/UNCERTIFIED/ALIAS"}));
}

// README: "poses are finite and within 1e15 m, their quaternions of length 1, and one topic keeps to one type and
// one frame"
TEST(Engine, C33_BadPosesAreCountedAndHarmless) {
  Rig rig(sceneOf({movingSphere("ball"), fixedSphere("wall", 10.0)}));
  rig.feedLine(0, 0, 400, 100, 0.0, 20.0);
  motion::StampedPose bad = poseAt(450, 9.0);
  bad.pose.orientation.w() = std::nan("");
  rig.engine.addPose(0, bad);
  rig.engine.addPose(0, poseAt(460, 1.1e15));
  rig.engine.addPose(0, poseAt(470, -1.1e15));
  bad = poseAt(480, 9.0);
  bad.pose.orientation.w() = 1.01;
  rig.engine.addPose(0, bad);
  rig.feedLine(0, 400, 1000, 100, 0.0, 20.0);  // 400 comes twice
  rig.engine.flush();
  const Stats stats = rig.engine.stats();
  EXPECT_EQ(stats.rejected, 4u);
  EXPECT_EQ(stats.duplicate, 1u);
  EXPECT_EQ(stats.accepted, 11u);
  EXPECT_EQ(rig.events.size(), 2u);
}

TEST(Engine, aComposedPathWithATwistAgainstItMakesAlias) {
  auto scene = sceneOf({movingSphere("ball"), fixedSphere("wall", 0.0)});
  Rig rig(scene);
  rig.engine.addPose(0, poseAt(0, -5.0));
  auto after = poseAt(100, 5.0);
  after.may_alias = true;
  rig.engine.addPose(0, after);
  rig.engine.flush();
  ASSERT_EQ(rig.events.size(), 2u);
  EXPECT_EQ(rig.events[0].reason, impact::Reason::kAlias);
  EXPECT_EQ(rig.events[0].certificate, impact::Certificate::kUncertified);
}

TEST(Engine, RefusesWhatItCannotDo) {
  auto scene = sceneOf({movingSphere("ball"), fixedSphere("wall", 10.0)});
  Rig rig(scene);
  EXPECT_THROW(rig.engine.addPose(2, poseAt(0, 0)), std::invalid_argument);
  EXPECT_THROW(rig.engine.addPose(-1, poseAt(0, 0)), std::invalid_argument);
  EXPECT_THROW(rig.engine.addPose(1, poseAt(0, 0)), std::invalid_argument);
  scene->time.timeout = 1.05;  // < max_gap + reorder
  EXPECT_THROW(Rig{scene}, std::invalid_argument);
}

}  // namespace
}  // namespace collision_node::scene

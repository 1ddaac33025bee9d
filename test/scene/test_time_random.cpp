// The rules of time against a slow second writing of its rules: several objects, random mishaps.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "engine_fixture.h"
#include "time_rules.h"

namespace collision_node::scene {
namespace {

constexpr int kObjects = 3;

std::shared_ptr<Scene> threeSpheres(double unit) {
  auto scene = sceneOf({movingSphere("a"), movingSphere("b"), movingSphere("c")});
  scene->time = {100 * unit, 1000 * unit, 1500 * unit, 700 * unit};
  scene->stats_period = 500 * unit;
  return scene;
}

motion::StampedPose poseOf(const Arrival& arrival) {
  motion::StampedPose pose;
  pose.stamp_ns = arrival.stamp_ns;
  pose.pose.position.x() = arrival.x;
  return pose;
}

int indexOf(const std::string& name) { return name[0] - 'a'; }

std::string whatOf(const Event& event) {
  std::string what = toString(event.kind);
  if (event.certificate == impact::Certificate::kUncertified)
    what += std::string(" ") + toString(event.reason);
  return what;
}

/// Of one epoch and one pair, in the order of time.
std::vector<const Event*> eventsOf(const std::vector<Event>& events, const TimeRules::Change& like) {
  std::vector<const Event*> out;
  for (const Event& event : events)
    if (event.epoch == like.epoch && indexOf(event.a.object) == like.a && indexOf(event.b.object) == like.b)
      out.push_back(&event);
  return out;
}

/// Every change is an event, at its time, and there are no others.
void expectSame(const std::vector<Event>& events, const std::vector<TimeRules::Change>& changes) {
  ASSERT_EQ(events.size(), changes.size());
  std::size_t place = 0;
  for (std::size_t i = 0; i < changes.size(); ++i) {
    const TimeRules::Change& change = changes[i];
    const bool is_first = i == 0 || changes[i - 1].epoch != change.epoch || changes[i - 1].a != change.a ||
                          changes[i - 1].b != change.b;
    place = is_first ? 0 : place + 1;
    const std::vector<const Event*> of_pair = eventsOf(events, change);
    ASSERT_LT(place, of_pair.size());
    if (whatOf(*of_pair[place]) != change.or_what) {
      EXPECT_EQ(whatOf(*of_pair[place]), change.what);
    }
    const double off = motion::secondsBetween(change.piece_ns, of_pair[place]->interval_start_ns) +
                       of_pair[place]->toi_lower - change.seconds;
    EXPECT_NEAR(off, 0.0, 1e-9 * (1e-6 + change.seconds));
  }
}

void runRounds(unsigned seed, int rounds, const Mishaps& mishaps) {
  const double unit = 1e-9 * static_cast<double>(mishaps.unit_ns);
  const Ns u = mishaps.unit_ns;
  std::mt19937_64 random(seed);
  std::size_t epochs = 0, late = 0, duplicates = 0, timeouts = 0, changes = 0;
  for (int round = 0; round < rounds; ++round) {
    SCOPED_TRACE("seed " + std::to_string(seed) + " round " + std::to_string(round));
    Rig rig(threeSpheres(unit));
    TimeRules rules(kObjects, {100 * u, 1000 * u, 1500 * u, 700 * u});
    const std::vector<Arrival> arrivals = arrivalsWithMishaps(random, mishaps);
    for (const Arrival& arrival : arrivals) {
      const Stats before = rig.engine.stats();
      const std::size_t published = rig.events.size();
      rig.engine.addPose(arrival.object, poseOf(arrival));
      rules.add(arrival);
      const Stats now = rig.engine.stats();
      ASSERT_EQ(now.epoch, rules.epoch());
      ASSERT_EQ(now.has_watermark, rules.watermark().has_value());
      if (now.has_watermark) {
        ASSERT_EQ(now.watermark_ns, *rules.watermark());
      }
      // What was decided stays decided.
      for (std::size_t i = published; i < rig.events.size(); ++i)
        if (before.has_watermark && rig.events[i].epoch == before.epoch) {
          EXPECT_GE(rig.events[i].stamp_ns, before.watermark_ns - 1);
        }
    }
    rig.engine.flush();
    rules.flush();
    const Stats end = rig.engine.stats();
    EXPECT_EQ(end.accepted, rules.counts().accepted);
    EXPECT_EQ(end.late, rules.counts().late);
    EXPECT_EQ(end.duplicate, rules.counts().duplicate);
    EXPECT_EQ(end.accepted + end.late + end.duplicate + end.rejected, arrivals.size());
    EXPECT_EQ(end.epoch, rules.epoch());
    const std::vector<TimeRules::Change> expected = rules.changes();
    expectSame(rig.events, expected);
    if (testing::Test::HasFailure()) return;
    epochs += end.epoch;
    late += end.late;
    duplicates += end.duplicate;
    changes += expected.size();
    for (const TimeRules::Change& change : expected) timeouts += change.what == "SEPARATION TIMEOUT" ? 1 : 0;
  }
  // The streams do what they are for.
  EXPECT_GT(epochs, static_cast<std::size_t>(rounds / 2));
  EXPECT_GT(late, static_cast<std::size_t>(rounds));
  EXPECT_GT(duplicates, static_cast<std::size_t>(rounds));
  EXPECT_GT(timeouts, static_cast<std::size_t>(rounds / 100));
  EXPECT_GT(changes, static_cast<std::size_t>(20 * rounds));
}

TEST(TimeAgainstRules, RandomMishapsOfThreeObjects) { runRounds(4711, 400, {1'000'000, 0, kObjects, 60}); }

TEST(TimeAgainstRules, StampsOneNanosecondApart) { runRounds(4712, 200, {1, 0, kObjects, 60}); }

TEST(TimeAgainstRules, StampsOfAThousandMillionSeconds) {
  runRounds(4713, 200, {1'000'000, 1'000'000'000'000'000'000, kObjects, 60});
}

TEST(TimeAgainstRules, OrderOfArrivalWithinTheWindowChangesNoEvent) {
  const unsigned seed = 4714;
  std::mt19937_64 random(seed);
  for (int round = 0; round < 200; ++round) {
    SCOPED_TRACE("seed " + std::to_string(seed) + " round " + std::to_string(round));
    // Each pose is under way for less than `reorder`.
    std::vector<std::pair<Nanoseconds, Arrival>> arrivals;
    for (int object = 0; object < kObjects; ++object) {
      Nanoseconds t = static_cast<Nanoseconds>(random() % 50) * kMs;
      for (int i = 0; i < 60; ++i) {
        t += static_cast<Nanoseconds>(1 + random() % (i % 20 == 19 ? 1400 : 60)) * kMs;
        const double x = std::uniform_real_distribution<double>(-2.0, 2.0)(random);
        arrivals.push_back({t, {object, t, x}});
      }
    }
    const auto by_time = [](const auto& l, const auto& r) { return l.first < r.first; };
    const auto played = [&] {
      auto rig = std::make_unique<Rig>(threeSpheres(1e-3));
      std::stable_sort(arrivals.begin(), arrivals.end(), by_time);
      for (const auto& arrival : arrivals) rig->engine.addPose(arrival.second.object, poseOf(arrival.second));
      rig->engine.flush();
      return texts(rig->events);
    };
    const std::vector<std::string> in_order = played();
    EXPECT_GT(in_order.size(), 10u);
    for (auto& arrival : arrivals) arrival.first += static_cast<Nanoseconds>(random() % 100) * kMs;
    ASSERT_EQ(played(), in_order);
  }
}

/// A 100 Hz target at rest and a 1 Hz stream that flies by at 10 m/s.
void feedOneHertz(Rig& rig, Nanoseconds arrives_late_ms, Nanoseconds stamped_late_ms) {
  for (Nanoseconds t = 0; t <= 10000; t += 10) {
    rig.engine.addPose(0, poseAt(t, 0.0));
    if (t % 1000 != arrives_late_ms) continue;
    const Nanoseconds second = t - arrives_late_ms,
                      stamp = second == 5000 ? second + stamped_late_ms : second;
    rig.engine.addPose(1, poseAt(stamp, 10.0 * 1e-3 * static_cast<double>(stamp) - 55.0));
  }
}

TEST(EngineTime, AOneHertzStreamWhosePosesArriveFiveHundredthsLateLosesNothing) {
  Rig rig(sceneOf({movingSphere("target"), movingSphere("visitor")}));
  feedOneHertz(rig, 50, 0);
  EXPECT_EQ(rig.engine.stats().late, 0u);
  EXPECT_EQ(rig.engine.stats().holes, 0u);
  for (const Stats& beat : rig.beats) EXPECT_TRUE(beat.uncovered_objects.empty()) << beat.stamp_ns;
  EXPECT_EQ(rig.engine.stats().watermark_ns, 8000 * kMs);  // 9 s have come
  EXPECT_EQ(kinds(rig.events),
            (std::vector<std::string>{"IMPACT/CONFIRMED/NONE", "SEPARATION/CONFIRMED/NONE"}));
}

TEST(EngineTime, AOneHertzStreamStampedFiveHundredthsLateHasADeclaredHole) {
  Rig rig(sceneOf({movingSphere("target"), movingSphere("visitor")}));
  feedOneHertz(rig, 50, 50);
  const Stats stats = rig.engine.stats();
  EXPECT_EQ(stats.holes, 1u);  // 1.05 s is longer than max_gap
  ASSERT_TRUE(stats.first_hole);
  EXPECT_EQ(stats.first_hole->reason, impact::Reason::kGap);
  EXPECT_EQ(stats.first_hole->after_ns, 4000 * kMs);
  EXPECT_EQ(stats.first_hole_object, "visitor");
}

TEST(EngineTime, NoRoundOfALoopIsLeftOutWhileAnObjectThatFellSilentIsWaitedFor) {
  Rig rig(sceneOf({movingSphere("a"), movingSphere("b"), movingSphere("silent")}));
  for (Nanoseconds t = 0; t <= 200; t += 50) rig.engine.addPose(2, poseAt(t, 100.0));
  constexpr int kRounds = 5;  // each is shorter than `timeout`
  for (int round = 0; round < kRounds; ++round) {
    const Nanoseconds begin = 7 * round;  // the same stamps again would be duplicates
    for (Nanoseconds t = begin; t <= begin + 600; t += 50) {
      rig.engine.addPose(0, poseAt(t, 0.0));
      rig.engine.addPose(1, poseAt(t, 0.01 * static_cast<double>(t) - 3.3));
    }
  }
  EXPECT_GE(rig.engine.stats().epoch, 1u);  // the silent one does not hold up the rest for ever
  rig.engine.flush();
  ASSERT_EQ(rig.events.size(), 2u * kRounds);
  for (int round = 0; round < kRounds; ++round) {
    EXPECT_EQ(rig.events[2 * round].kind, impact::Kind::kImpact);
    EXPECT_EQ(rig.events[2 * round].epoch, static_cast<std::uint32_t>(round));
    EXPECT_EQ(rig.events[2 * round + 1].kind, impact::Kind::kSeparation);
  }
}

}  // namespace
}  // namespace collision_node::scene

// Many objects against a truth in closed form: everything through everything.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <map>
#include <random>

#include "test/scene/engine_fixture.h"

namespace collision_node::scene {
namespace {

/// Spheres on straight lines at constant speed.
struct Flight {
  Vec3 from, velocity;
  double radius;
};

struct Truth {
  impact::Kind kind;
  double time;
};

/// All changes of contact of two spheres within [0, end]; nothing when they graze each other, or touch at an
/// end, by less than a micrometre.
std::optional<std::vector<Truth>> truthOf(const Flight& a, const Flight& b, double end) {
  const Vec3 d = b.from - a.from, v = b.velocity - a.velocity;
  const double r = a.radius + b.radius, vv = v.squaredNorm(), dv = d.dot(v);
  const double nearest = (d - v * (dv / vv)).norm();
  if (std::abs(nearest - r) < 1e-6 || std::abs(d.norm() - r) < 1e-6) return std::nullopt;
  std::vector<Truth> out;
  if (nearest > r) return out;
  const double half = std::sqrt((r - nearest) * (r + nearest) / vv), middle = -dv / vv;
  if (middle + half < 0.0 || middle - half > end) return out;
  if (middle - half > 0.0) out.push_back({impact::Kind::kImpact, middle - half});
  if (middle - half <= 0.0) out.push_back({impact::Kind::kInitialOverlap, 0.0});
  if (middle + half < end) out.push_back({impact::Kind::kSeparation, middle + half});
  return out;
}

TEST(EngineMany, FiveHundredSpheresThroughEachOtherEveryChangeAndNoneElse) {
  constexpr int kCount = 500;
  constexpr double kEnd = 1.0;
  std::mt19937_64 random(20240517);
  const auto real = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  std::vector<Flight> flights;
  while (flights.size() < kCount) {
    const double speed = flights.size() % 10 == 0 ? 400.0 : 20.0;
    Flight flight{{real(-13, 13), real(-13, 13), real(-13, 13)},
                  {real(-speed, speed), real(-speed, speed), real(-speed, speed)},
                  std::exp(real(std::log(0.05), std::log(1.2)))};
    bool is_plain = true;
    for (const Flight& other : flights) is_plain = is_plain && truthOf(flight, other, kEnd).has_value();
    if (is_plain) flights.push_back(flight);
  }
  std::map<std::pair<std::string, std::string>, std::vector<Truth>> truth;
  std::vector<Object> objects;
  for (int i = 0; i < kCount; ++i) {
    char name[8];
    std::snprintf(name, sizeof name, "s%03d", i);
    Object object = movingSphere(name);
    object.links[0].shapes = {{geometry::Sphere{flights[i].radius}, {}, "sphere"}};
    object.links[0].body = std::make_shared<geometry::Body>(object.links[0].shapes);
    objects.push_back(object);
    for (int k = 0; k < i; ++k) {
      const std::vector<Truth> changes = *truthOf(flights[k], flights[i], kEnd);
      if (!changes.empty()) truth[{objects[k].name, name}] = changes;
    }
  }
  // Each has its own stamps between the common first and last one; or all have the same, so that a release is
  // work for several threads.
  std::vector<std::pair<Nanoseconds, int>> own, common;
  for (int i = 0; i < kCount; ++i) {
    Nanoseconds stamp = 0;
    while (stamp < 1000 * kMs) {
      own.push_back({stamp, i});
      stamp += static_cast<Nanoseconds>(real(10e6, 120e6));
    }
    own.push_back({1000 * kMs, i});
    for (int k = 0; k <= 20; ++k) common.push_back({50 * k * kMs, i});
  }
  std::sort(own.begin(), own.end());
  std::sort(common.begin(), common.end());
  const auto scene = sceneOf(objects);
  for (const auto& [stamps, threads] : {std::pair(own, 1), std::pair(own, 2), std::pair(common, 2)}) {
    Rig rig(scene, impact::MethodName::kCertified, {false, threads});
    for (const auto& [stamp, i] : stamps) {
      motion::StampedPose pose;
      pose.stamp_ns = stamp;
      pose.pose.position = flights[i].from + flights[i].velocity * (1e-9 * static_cast<double>(stamp));
      rig.engine.addPose(i, pose);
    }
    rig.engine.flush();
    auto left = truth;
    std::size_t count = 0;
    for (const Event& event : rig.events) {
      SCOPED_TRACE(text(event));
      std::vector<Truth>& expected = left[{event.a.object, event.b.object}];
      ASSERT_FALSE(expected.empty()) << "an event that is none";
      EXPECT_EQ(event.kind, expected.front().kind);
      EXPECT_EQ(event.certificate, impact::Certificate::kConfirmed);
      const double start = 1e-9 * static_cast<double>(event.interval_start_ns);
      EXPECT_LE(start + event.toi_lower, expected.front().time + 1e-9);
      EXPECT_GE(start + event.toi_upper, expected.front().time - 1e-9);
      expected.erase(expected.begin());
      ++count;
    }
    for (const auto& [names, changes] : left)
      EXPECT_TRUE(changes.empty()) << names.first << " x " << names.second << " is missing a change";
    EXPECT_GT(count, 350u);
    const Stats stats = rig.engine.stats();
    EXPECT_EQ(stats.pairs_uncovered + stats.pairs_undecided, 0u);
    EXPECT_EQ(stats.pairs_culled + stats.pairs_clear + stats.pairs_impact, 500u * 499u / 2u);
  }
}

TEST(EngineMany, AShotOverTenThousandObstaclesMeetsTheOnesInItsWay) {
  std::vector<Object> objects;
  std::mt19937_64 random(5);
  const auto body = movingSphere("any").links;
  std::vector<Vec3> places;
  for (int i = 0; i < 10000; ++i) {
    char name[8];
    std::snprintf(name, sizeof name, "o%05d", i);
    Object object = fixedSphere(name, 0.0);
    object.links = body;
    // A hundred by a hundred, 5 m apart; the shot's row is 0.3 m off its line.
    object.source.fixed.position = {5.0 * (i % 100), 5.0 * (i / 100), 0.3};
    objects.push_back(object);
  }
  objects.push_back(movingSphere("shot"));
  Rig rig(sceneOf(objects), impact::MethodName::kCertified);
  for (int k = 0; k <= 20; ++k) {  // 2000 m/s at 50 Hz along the 40th row
    motion::StampedPose pose;
    pose.stamp_ns = 20 * kMs * k;
    pose.pose.position = {-100.0 + 40.0 * k, 200.0, 0.0};
    rig.engine.addPose(10000, pose);
  }
  rig.engine.flush();
  EXPECT_EQ(rig.events.size(), 200u);
  for (const Event& event : rig.events) {
    EXPECT_EQ(event.certificate, impact::Certificate::kConfirmed);
    EXPECT_EQ(event.a.object.substr(0, 4), "o040");
  }
  EXPECT_LT(rig.engine.stats().node_tests, 20000u);
}

}  // namespace
}  // namespace collision_node::scene

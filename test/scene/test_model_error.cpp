// True flights that obey the bounds, sampled far too coarsely: what the events say of the truth.
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "engine_fixture.h"

namespace collision_node::scene {
namespace {

using geometry::Quat;

constexpr double kStep = 2e-5;         // [s] of the truth
constexpr int kStepsPerSample = 1667;  // 30 Hz
constexpr int kSamples = 9;
constexpr Nanoseconds kStepNs = 20'000;
constexpr double kRadius = 0.05;
const Vec3 kHalf(0.3, 0.2, 0.1);

/// A rigid body under random accelerations, every step of it.
struct Truth {
  std::vector<Vec3> position, velocity;
  std::vector<Quat> orientation;
};

struct Limits {
  double acceleration, angular_acceleration, spin;
};

Vec3 anyDirection(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  return Vec3(normal(random), normal(random), normal(random)).normalized();
}

Truth fly(std::mt19937_64& random, const Limits& limits, Vec3 position, Vec3 velocity) {
  Truth truth;
  Quat orientation(Eigen::AngleAxisd(3.0, anyDirection(random)));
  Vec3 omega = 0.7 * limits.spin * anyDirection(random);
  Vec3 push = Vec3::Zero(), twist = Vec3::Zero();
  for (int i = 0; i <= kSamples * kStepsPerSample; ++i) {
    if (i % (kStepsPerSample / 3) == 0) {
      push = limits.acceleration * anyDirection(random);
      twist = limits.angular_acceleration * anyDirection(random);
    }
    truth.position.push_back(position);
    truth.velocity.push_back(velocity);
    truth.orientation.push_back(orientation);
    position += kStep * velocity + 0.5 * kStep * kStep * push;
    velocity += kStep * push;
    const Vec3 middle = omega + 0.5 * kStep * twist;
    if ((omega + kStep * twist).norm() < limits.spin) omega += kStep * twist;
    const double angle = std::min(middle.norm(), limits.spin) * kStep;
    if (angle > 0.0)
      orientation = (Quat(Eigen::AngleAxisd(angle, middle.normalized())) * orientation).normalized();
  }
  return truth;
}

/// Onsets of true contact, as steps: the sphere's centre comes within its radius of the box.
struct Onset {
  int step;
  Vec3 point;
};
std::vector<Onset> onsets(const Truth& box, const Truth& sphere) {
  std::vector<Onset> out;
  bool touching = false;
  for (std::size_t i = 0; i < box.position.size(); ++i) {
    const Vec3 centre = box.orientation[i].conjugate() * (sphere.position[i] - box.position[i]);
    const Vec3 nearest = centre.cwiseMax(-kHalf).cwiseMin(kHalf);
    const bool now = (centre - nearest).norm() <= kRadius;
    if (now && !touching)
      out.push_back({static_cast<int>(i), box.position[i] + box.orientation[i] * nearest});
    touching = now;
  }
  return out;
}

std::shared_ptr<Scene> boxAndSphere(const Limits& of_box, const Limits& of_sphere, MotionModel model) {
  Object box = movingSphere("box"), sphere = movingSphere("sphere");
  box.links[0].shapes = {{geometry::Box{2.0 * kHalf}, {}, "box"}};
  sphere.links[0].shapes = {{geometry::Sphere{kRadius}, {}, "sphere"}};
  for (Object* object : {&box, &sphere})
    object->links[0].body = std::make_shared<geometry::Body>(object->links[0].shapes);
  box.acceleration = of_box.acceleration;
  box.angular_acceleration = of_box.angular_acceleration;
  box.max_spin = of_box.spin;
  sphere.acceleration = of_sphere.acceleration;
  sphere.motion = model;
  return sceneOf({box, sphere});
}

void feed(Rig& rig, int object, const Truth& truth, bool twists) {
  for (int sample = 0; sample <= kSamples; ++sample) {
    const std::size_t i = static_cast<std::size_t>(sample) * kStepsPerSample;
    motion::StampedPose pose;
    pose.stamp_ns = static_cast<Nanoseconds>(i) * kStepNs;
    pose.pose.position = truth.position[i];
    pose.pose.orientation = truth.orientation[i];
    pose.has_twist = twists;
    pose.linear = truth.velocity[i];
    rig.engine.addPose(object, pose);
  }
}

double secondsOf(const Event& event, double toi) {
  return static_cast<double>(event.interval_start_ns) * 1e-9 + toi;
}

struct Tally {
  int true_contacts = 0, certain = 0, near_misses = 0, points = 0;
};

/// What a flight's events promise of the truth.
void check(const std::vector<Event>& events, const std::vector<Onset>& truth, Tally& tally) {
  for (const Onset& onset : truth) {
    const double early = (onset.step - 1) * kStep, late = onset.step * kStep;
    ++tally.true_contacts;
    // The last event that knows of the model's error and begins before the contact.
    const Event* of = nullptr;
    for (const Event& event : events)
      if (event.kind == impact::Kind::kImpact && secondsOf(event, event.model_toi_lower) <= late) of = &event;
    ASSERT_NE(of, nullptr) << "no event allows the contact at " << late;
    const double lower = secondsOf(*of, of->model_toi_lower);
    const bool is_first = std::none_of(truth.begin(), truth.end(), [&](const Onset& other) {
      return other.step < onset.step && other.step * kStep >= lower;
    });
    if (!is_first) continue;  // an approach speaks of its first contact
    if (!std::isnan(of->model_toi_upper)) {
      EXPECT_LE(early, secondsOf(*of, of->model_toi_upper));
    }
    if (!std::isnan(of->model_position_error)) {
      EXPECT_LE((onset.point - of->position).norm(), of->model_position_error + 1e-3);
      ++tally.points;
    }
  }
  for (const Event& event : events) {
    if (event.kind != impact::Kind::kImpact) continue;
    if (event.certificate == impact::Certificate::kPossible) ++tally.near_misses;
    ASSERT_FALSE(std::isnan(event.model_toi_lower));
    EXPECT_LE(event.model_toi_lower, event.toi_lower);
    if (std::isnan(event.model_toi_upper)) continue;
    EXPECT_GE(event.model_toi_upper, event.toi_upper);
    ++tally.certain;
    const double lower = secondsOf(event, event.model_toi_lower),
                 upper = secondsOf(event, event.model_toi_upper);
    EXPECT_TRUE(std::any_of(truth.begin(), truth.end(),
                            [&](const Onset& onset) {
                              return (onset.step) * kStep >= lower && (onset.step - 1) * kStep <= upper;
                            }))
        << "no true contact in [" << lower << ", " << upper << "], which was called certain";
  }
}

Tally runFlights(unsigned seed, int flights, const Limits& of_box, const Limits& of_sphere,
                 MotionModel model) {
  std::mt19937_64 random(seed);
  Tally tally;
  for (int flight = 0; flight < flights; ++flight) {
    SCOPED_TRACE("seed " + std::to_string(seed) + " flight " + std::to_string(flight));
    std::uniform_real_distribution<double> off(-0.35, 0.35);
    const Truth box = fly(random, of_box, Vec3(off(random), off(random), off(random)), anyDirection(random));
    const Vec3 aim(off(random), off(random), 0.0), towards(0, 0, 8.0);
    const Truth sphere = fly(random, of_sphere, aim - Vec3(0, 0, 1.2), towards);
    Rig rig(boxAndSphere(of_box, of_sphere, model), impact::MethodName::kCertified);
    feed(rig, 0, box, false);
    feed(rig, 1, sphere, model == MotionModel::kHermite);
    rig.engine.flush();
    check(rig.events, onsets(box, sphere), tally);
    if (testing::Test::HasFailure()) break;
  }
  return tally;
}

// README: "between two poses the object moves as the motion model says"
TEST(EngineModelError, TheTrueContactOfABallThatSwervesLiesInTheModelFields) {
  const Tally tally = runFlights(91, 300, {20.0, 100.0, 30.0}, {60.0, 0.0, 1.0}, MotionModel::kSlerp);
  std::cout << tally.true_contacts << " true contacts, " << tally.certain << " certain, " << tally.near_misses
            << " near misses, " << tally.points << " points\n";
  EXPECT_GT(tally.true_contacts, 50);
  EXPECT_GT(tally.certain, 20);
  EXPECT_GT(tally.near_misses, 5);
  EXPECT_GT(tally.points, 30);
}

TEST(EngineModelError, TheTrueContactLiesInTheModelFieldsOfACubicToo) {
  const Tally tally = runFlights(92, 200, {0.0, 0.0, 1e-6}, {200.0, 0.0, 1.0}, MotionModel::kHermite);
  EXPECT_GT(tally.true_contacts, 20);
  EXPECT_GT(tally.certain, 10);
}

/// A ball flies past a ball at rest, `gap` metres beside it.
std::unique_ptr<Rig> passBeside(double gap, double acceleration) {
  auto scene = sceneOf({fixedSphere("post", 0.0), movingSphere("visitor")});
  auto changed = std::make_shared<Scene>(*scene);
  changed->objects[1].acceleration = acceleration;
  auto rig = std::make_unique<Rig>(changed, impact::MethodName::kCertified);
  for (Nanoseconds t = 0; t <= 1000; t += 100) {
    motion::StampedPose pose = poseAt(t, 0.02 * static_cast<double>(t) - 10.0);
    pose.pose.position.y() = 1.0 + gap;
    rig->engine.addPose(1, pose);
  }
  rig->engine.flush();
  return rig;
}

TEST(EngineModelError, AMissByLessThanTheTubeIsPossibleAndSaysSoInTheStats) {
  // 2 m/s^2 over 0.1 s: 2.5 mm.
  const auto near = passBeside(0.001, 2.0), far = passBeside(0.01, 2.0), unasked = passBeside(0.001, NAN);
  EXPECT_TRUE(far->events.empty());
  EXPECT_TRUE(unasked->events.empty());
  EXPECT_EQ(kinds(near->events), std::vector<std::string>{"IMPACT/POSSIBLE/GRAZING"});
  ASSERT_FALSE(near->events.empty());
  const Event& event = near->events[0];
  EXPECT_EQ(event.model_toi_lower, event.toi_lower);
  EXPECT_TRUE(std::isnan(event.model_toi_upper));
  EXPECT_LT(secondsOf(event, event.toi_lower), 0.5);
  EXPECT_GT(secondsOf(event, event.toi_upper), 0.5);
  std::uint64_t undecided = 0;
  for (const Stats& beat : near->beats) undecided += beat.pairs_undecided;
  EXPECT_EQ(undecided, 1u);
}

// model_error.md: "`~stats` counts the pair among `pairs_undecided` until something is", up to that instant.
TEST(EngineModelError, AnApproachThatWasLeftOpenIsUndecidedUpToItsClearance) {
  auto scene = std::make_shared<Scene>(*sceneOf({fixedSphere("post", 0.0), movingSphere("visitor")}));
  scene->objects[1].acceleration = 2.0;
  scene->stats_period = 0.1;  // every pose
  Rig rig(scene, impact::MethodName::kCertified);
  Nanoseconds t = 0;
  for (const double x : {-1.0, -0.05, -0.05, -0.05, -0.05, -1.0, -2.0}) {
    motion::StampedPose pose = poseAt(t, x);
    pose.pose.position.y() = 1.001;
    rig.engine.addPose(1, pose);
    t += 100;
  }
  rig.engine.flush();
  EXPECT_EQ(kinds(rig.events), std::vector<std::string>{"IMPACT/POSSIBLE/GRAZING"});
  std::string said;
  for (const Stats& beat : rig.beats)
    said += beat.pairs_undecided > 0 ? 'u' : beat.pairs_clear + beat.pairs_culled > 0 ? 'c' : '-';
  EXPECT_EQ(said, "uuuuuc");
}

TEST(EngineModelError, AnImpactDeeperThanTheTubeIsCertain) {
  const auto rig = passBeside(-0.2, 2.0);
  ASSERT_EQ(kinds(rig->events),
            (std::vector<std::string>{"IMPACT/CONFIRMED/NONE", "SEPARATION/CONFIRMED/NONE"}));
  const Event& event = rig->events[0];
  EXPECT_LT(event.model_toi_lower, event.toi_lower);
  EXPECT_GT(event.model_toi_upper, event.toi_upper);
  EXPECT_LT(event.model_toi_upper - event.model_toi_lower, 0.01);
  EXPECT_GT(event.model_position_error, 0.0025);
  EXPECT_TRUE(std::isnan(rig->events[1].model_toi_lower));  // only beginnings are bounded
}

TEST(EngineModelError, AnImpactLateInAnApproachThatWasLeftOpenKeepsItsLowerEnd) {
  auto scene = std::make_shared<Scene>(*sceneOf({fixedSphere("post", 0.0), movingSphere("visitor")}));
  scene->objects[1].acceleration = 2.0;
  Rig rig(scene, impact::MethodName::kCertified);
  // It waits for half a second 1 mm beside the post, inside the tube; then it brushes past and is gone.
  Nanoseconds t = 0;
  for (const double x : {-1.0, -0.05, -0.05, -0.05, -0.05, -0.05, 0.6, 1.2}) {
    motion::StampedPose pose = poseAt(t, x);
    pose.pose.position.y() = 0.9999;
    rig.engine.addPose(1, pose);
    t += 100;
  }
  rig.engine.flush();
  ASSERT_EQ(kinds(rig.events), (std::vector<std::string>{"IMPACT/POSSIBLE/GRAZING", "IMPACT/CONFIRMED/NONE",
                                                         "SEPARATION/CONFIRMED/NONE"}));
  const Event& left_open = rig.events[0];
  const Event& impact = rig.events[1];
  EXPECT_NEAR(secondsOf(impact, impact.model_toi_lower), secondsOf(left_open, left_open.toi_lower), 1e-9);
  EXPECT_TRUE(std::isnan(impact.model_toi_upper));
  EXPECT_TRUE(std::isnan(left_open.model_position_error));
}

TEST(EngineModelError, WithoutALimitOfTheSpinABoundOfTurningIsAlias) {
  auto scene = std::make_shared<Scene>(*sceneOf({fixedSphere("post", 0.0), movingSphere("visitor")}));
  scene->objects[1].angular_acceleration = 1.0;
  Rig rig(scene, impact::MethodName::kCertified);
  rig.feedLine(1, 0, 1000, 100, -5.0, 5.0);
  rig.engine.flush();
  ASSERT_FALSE(rig.events.empty());
  EXPECT_EQ(kinds(rig.events)[0], "IMPACT/UNCERTIFIED/ALIAS");
  EXPECT_TRUE(std::isnan(rig.events[0].model_toi_lower));
}

TEST(EngineModelError, ASourceThatComposedItsPosesAddsItsOwnBound) {
  for (const double bound : {0.002, std::numeric_limits<double>::infinity()}) {
    Rig rig(sceneOf({fixedSphere("post", 0.0), movingSphere("visitor")}), impact::MethodName::kCertified);
    for (Nanoseconds t = 0; t <= 1000; t += 100) {
      motion::StampedPose pose = poseAt(t, 0.005 * static_cast<double>(t) - 3.0);
      pose.model_position = bound;
      rig.engine.addPose(1, pose);
    }
    rig.engine.flush();
    ASSERT_FALSE(rig.events.empty());
    if (std::isinf(bound)) {
      EXPECT_TRUE(std::isnan(rig.events[0].model_toi_lower));
    } else {
      EXPECT_NEAR(rig.events[0].model_toi_lower, rig.events[0].toi_lower - 0.002 / 5.0, 1e-4);
    }
  }
}

}  // namespace
}  // namespace collision_node::scene

/// Random scenes and streams with all the mishaps there are, for tests that compare two engines.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "test/scene/engine_fixture.h"

namespace collision_node::scene {

struct RandomPose {
  Nanoseconds arrives_ns;
  int object;
  motion::StampedPose pose;
  bool guessed;
};

class RandomScene {
 public:
  /// `objects` in a cube that grows with their number; about a fifth stands still.
  RandomScene(unsigned seed, int objects) : random_(seed), side_(4.0 * std::cbrt(objects)) {
    std::vector<Object> all;
    for (int i = 0; i < objects; ++i) all.push_back(makeObject(i));
    scene = sceneOf(all);
    scene->stats_period = 0.5;
    if (chance(0.3)) scene->pairs = PairRules(real(0.0, 0.3));
    if (chance(0.5)) addExceptions(objects);
    for (int i = 0; i < objects; ++i)
      if (all[i].source.type != PoseSource::Type::kFixed) addStream(i);
    if (chance(0.3)) {  // a loop: the same stamps again
      const std::vector<RandomPose> round = poses;
      for (RandomPose pose : round) {
        pose.arrives_ns += 5000 * kMs;
        poses.push_back(pose);
      }
    }
    std::stable_sort(poses.begin(), poses.end(),
                     [](const RandomPose& l, const RandomPose& r) { return l.arrives_ns < r.arrives_ns; });
  }

  void play(Rig& rig) const {
    for (const RandomPose& pose : poses) rig.engine.addPose(pose.object, pose.pose, pose.guessed);
    rig.engine.flush();
  }

  std::shared_ptr<Scene> scene;
  std::vector<RandomPose> poses;

 private:
  double real(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  bool chance(double p) { return real(0.0, 1.0) < p; }
  Vec3 vector(double size) { return {real(-size, size), real(-size, size), real(-size, size)}; }

  Object makeObject(int i) {
    char name[16];
    std::snprintf(name, sizeof name, "o%05d", i);
    Object object = movingSphere(name);
    const double size = std::exp(real(std::log(0.05), std::log(2.0)));
    geometry::Shape shape = geometry::Sphere{size};
    if (chance(0.3)) shape = geometry::Box{Vec3(size, 0.5 * size, 2.0 * size)};
    if (chance(0.2)) shape = geometry::Capsule{0.5 * size, size};
    Link& link = object.links[0];
    link.shapes = {{shape, {}, "random"}};
    if (chance(0.2)) link.shapes[0].origin.position = vector(size);
    link.body = std::make_shared<geometry::Body>(link.shapes);
    if (chance(0.2)) {
      object.source = {};
      object.source.fixed.position = vector(0.5 * side_);
    }
    if (chance(0.2)) object.on_timeout = OnTimeout::kFreeze;
    if (chance(0.2)) object.motion = chance(0.5) ? MotionModel::kHermite : MotionModel::kSpin;
    if (chance(0.1)) object.max_speed = 60.0;
    if (chance(0.2)) object.acceleration = real(0.0, 20.0);
    return object;
  }

  void addExceptions(int objects) {
    for (int i = 0; i < objects / 3; ++i) {
      const int a = static_cast<int>(random_() % static_cast<unsigned>(objects - 1));
      const LinkPair pair{a, 0, a + 1, 0, real(0.0, 0.5)};
      scene->pairs.set(a, a + 1, {{pair, chance(0.5) ? "left out" : ""}});
    }
  }

  void addStream(int object) {
    const Nanoseconds period = static_cast<Nanoseconds>(real(10.0, chance(0.2) ? 400.0 : 60.0)) * kMs;
    const bool guessed = chance(0.1), is_fast = chance(0.2), often_rests = chance(0.3);
    const bool has_twist = scene->objects[object].motion != MotionModel::kSlerp;
    Vec3 position = vector(0.5 * side_);
    Vec3 velocity = vector(is_fast ? 400.0 : 4.0);
    Nanoseconds stamp = static_cast<Nanoseconds>(real(0.0, 100.0)) * kMs;
    if (chance(0.15)) stamp += 900 * kMs;                         // joins late
    const Nanoseconds ends = (chance(0.15) ? 1500 : 4000) * kMs;  // falls silent
    while (stamp < ends) {
      RandomPose next;
      next.object = object;
      next.guessed = guessed;
      next.arrives_ns = stamp + static_cast<Nanoseconds>(real(0.0, 0.08) * 1e9);
      next.pose.stamp_ns = stamp;
      next.pose.pose.position = position;
      next.pose.pose.orientation = geometry::Quat(1.0, real(-0.2, 0.2), real(-0.2, 0.2), 0.0).normalized();
      next.pose.has_twist = has_twist;
      next.pose.linear = velocity;
      poses.push_back(next);
      if (chance(0.02)) velocity = vector(is_fast ? 400.0 : 4.0);
      if (!often_rests || chance(0.3)) position += velocity * (1e-9 * static_cast<double>(period));
      for (int k = 0; k < 3; ++k)
        if (std::abs(position[k]) > 0.5 * side_) velocity[k] = -std::copysign(velocity[k], position[k]);
      stamp += period;
      if (chance(0.01)) stamp += static_cast<Nanoseconds>(real(0.5, 2.5) * 1e9);  // a hole, or silence
      if (chance(0.003)) position = vector(0.5 * side_);                          // a leap
    }
  }

  std::mt19937_64 random_;
  double side_;
};

}  // namespace collision_node::scene

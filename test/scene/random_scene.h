/// Random scenes of all that the engine has to cope with, for tests that compare two engines.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include "collision_node/geometry/triangle_mesh.h"
#include "test/scene/engine_fixture.h"

namespace collision_node::scene {

/// Chance, and what is drawn from it.
class Dice {
 public:
  explicit Dice(unsigned seed) : random_(seed) {}

  double real(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  double anySize(double low, double high) { return std::exp(real(std::log(low), std::log(high))); }
  bool chance(double p) { return real(0.0, 1.0) < p; }
  int below(int n) { return std::uniform_int_distribution<int>(0, n - 1)(random_); }
  Vec3 vector(double size) { return {real(-size, size), real(-size, size), real(-size, size)}; }
  geometry::Quat turn() {
    return geometry::Quat(real(-1.0, 1.0), real(-1.0, 1.0), real(-1.0, 1.0), real(-1.0, 1.0)).normalized();
  }
  Nanoseconds ms(double low, double high) { return static_cast<Nanoseconds>(real(low, high) * 1e6); }

 private:
  std::mt19937_64 random_;
};

/// Objects in a cube that grows with their number, and which of their pairs are watched.
class RandomScene {
 public:
  RandomScene(unsigned seed, int objects)
      : dice_(seed), side_(dice_.anySize(3.0, 40.0) * std::cbrt(objects)), origin_(Vec3::Zero()) {
    // Where a rounding is as large as an object, too.
    if (dice_.chance(0.3)) origin_ = dice_.vector(dice_.anySize(10.0, 1e9));
    std::vector<Object> all;
    for (int i = 0; i < objects; ++i) all.push_back(makeObject(i));
    scene = sceneOf(std::move(all));
    scene->stats_period = dice_.real(0.1, 1.0);
    scene->node_budget = 20000;
    if (dice_.chance(0.5)) {
      scene->time.reorder = dice_.chance(0.2) ? 0.0 : dice_.real(0.0, 0.2);
      scene->time.max_gap = dice_.real(0.1, 1.0);
      scene->time.timeout = scene->time.max_gap + scene->time.reorder + dice_.real(0.0, 1.0);
      scene->time.jump = dice_.real(0.1, 1.0);
    }
    if (dice_.chance(0.3)) scene->pairs = PairRules(dice_.real(0.0, 0.3));
    if (dice_.chance(0.15)) scene->pairs.watchNothingElse("not listed in pairs/only");
    const int exceptions = scene->pairs.watchesRest() ? objects / 3 : objects * 2;
    if (dice_.chance(0.5) || !scene->pairs.watchesRest())
      for (int i = 0; i < exceptions; ++i) addException(dice_.below(objects), dice_.below(objects));
    for (int i = 0; i < objects; ++i)  // self
      if (scene->objects[i].links.size() > 1) addException(i, i);
  }

  double side() const { return side_; }
  const Vec3& origin() const { return origin_; }
  Dice& dice() { return dice_; }

  std::shared_ptr<Scene> scene;

 private:
  geometry::Shape makeShape() {
    const double size = dice_.anySize(0.05, 2.0);
    switch (dice_.below(12)) {
      case 0:
      case 1:
        return geometry::Box{Vec3(size, 0.5 * size, 2.0 * size)};
      case 2:
        return geometry::Capsule{0.5 * size, size};
      case 3:
        return geometry::Cylinder{0.5 * size, 2.0 * size};
      case 4:
        return geometry::Point{};
      case 5:
        return geometry::Mesh{tetrahedron(size, dice_.chance(0.5))};
      case 6:
        return geometry::Convex{tetrahedron(size, true)};
      default:
        return geometry::Sphere{size};
    }
  }

  static std::shared_ptr<const geometry::TriangleMesh> tetrahedron(double size, bool is_closed) {
    std::vector<std::array<std::int32_t, 3>> faces = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}};
    if (is_closed) faces.push_back({1, 2, 3});
    return std::make_shared<geometry::TriangleMesh>(geometry::makeTriangleMesh(
        {Vec3::Zero(), size * Vec3::UnitX(), size * Vec3::UnitY(), size * Vec3::UnitZ()}, faces,
        geometry::SolidChoice::kAuto, "tetrahedron"));
  }

  Object makeObject(int i) {
    char name[16];
    std::snprintf(name, sizeof name, "o%05d", i);
    Object object = movingSphere(name);
    object.links.clear();
    const int links = dice_.chance(0.15) ? 2 + dice_.below(2) : 1;
    for (int k = 0; k < links; ++k) {
      Link link;
      link.name = "body" + std::to_string(k);
      link.shapes = {{makeShape(), {}, "random"}};
      if (links > 1 || dice_.chance(0.2)) link.shapes[0].origin.position = dice_.vector(1.0);
      link.body = std::make_shared<geometry::Body>(link.shapes);
      object.links.push_back(link);
    }
    if (dice_.chance(0.2)) {
      object.source = {};
      object.source.fixed.position = origin_ + dice_.vector(0.5 * side_);
      if (dice_.chance(0.5)) object.source.fixed.orientation = dice_.turn();
    }
    if (dice_.chance(0.2)) object.on_timeout = OnTimeout::kFreeze;
    if (dice_.chance(0.3)) object.motion = dice_.chance(0.5) ? MotionModel::kHermite : MotionModel::kSpin;
    if (dice_.chance(0.1)) object.max_speed = 60.0;
    if (dice_.chance(0.2)) object.acceleration = dice_.anySize(0.01, 100.0);
    if (dice_.chance(0.1)) object.max_spin = dice_.anySize(1.0, 100.0);
    if (std::isfinite(object.max_spin) && dice_.chance(0.5))
      object.angular_acceleration = dice_.anySize(0.01, 100.0);
    return object;
  }

  void addException(int a, int b) {
    if (a > b) std::swap(a, b);
    std::vector<PairVerdict> verdicts;
    const int links_a = static_cast<int>(scene->objects[a].links.size());
    const int links_b = static_cast<int>(scene->objects[b].links.size());
    for (int i = 0; i < links_a; ++i)
      for (int k = a == b ? i + 1 : 0; k < links_b; ++k)
        verdicts.push_back({{a, i, b, k, dice_.chance(0.5) ? 0.0 : dice_.real(0.0, 0.5)},
                            dice_.chance(0.4) ? "left out" : ""});
    scene->pairs.set(a, b, std::move(verdicts));
  }

  Dice dice_;
  double side_;
  Vec3 origin_;
};

}  // namespace collision_node::scene

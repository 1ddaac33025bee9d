#include <algorithm>
#include <cmath>

#include "collision_node/report/made_meshes.h"
#include "collision_node/report/stability/direction.h"
#include "collision_node/report/stability/grazing_trials.h"
#include "collision_node/report/stability/shapes.h"
#include "collision_node/report/stability/straight_trials.h"
#include "collision_node/report/stability/turning_trials.h"

namespace collision_node::report {
namespace {

constexpr double kMargin = 1e-2;  ///< of the smaller body: how near it flies past

std::vector<double> powers(int from, int to, int stride = 1) {
  std::vector<double> values;
  for (int e = from; from < to ? e <= to : e >= to; e += from < to ? stride : -stride) {
    values.push_back(std::stod("1e" + std::to_string(e)));
  }
  return values;
}

std::size_t indexOf(const std::vector<double>& values, double value) {
  return static_cast<std::size_t>(std::find(values.begin(), values.end(), value) - values.begin());
}

/// Point, ball and mesh against a mesh, ball against a box; A has `size_a`, B `size_b` [m].
std::vector<Group> fourKinds(const MeshPtr& a, double size_a, double size_b, const Setting& setting,
                             int count, Random& random) {
  const geometry::Mesh mesh{a};
  std::vector<Group> groups;
  groups.push_back(makeGroup("point, mesh", mesh, geometry::Point{}));
  groups.push_back(makeGroup("ball, mesh", mesh, geometry::Sphere{0.5 * size_b}));
  groups.push_back(makeGroup("mesh, mesh", mesh, geometry::Mesh{tetrahedron(size_b)}));
  groups.push_back(
      makeGroup("ball, box", geometry::Box{size_a * geometry::Vec3::Ones()}, geometry::Sphere{0.5 * size_b}));
  for (Group& group : groups) {
    Setting own = setting;
    own.both_move = group.trials.name == "mesh, mesh" || group.trials.name == "ball, box";
    addStraightTrials(group, own, kMargin * std::min(size_a, size_b), count, random);
  }
  return groups;
}

std::vector<Group> cubeAnd(double size_a, double size_b, const Setting& setting, int count, Random& random) {
  return fourKinds(cubeMesh(size_a), size_a, size_b, setting, count, random);
}

Direction offset(int stride) {
  Direction d{"offset", "both bodies so far from the world's origin; 1 m, 10 m/s, 0.1 s", "m", {}, 0, {}};
  d.values = powers(0, 9, stride);
  d.groups = [](double value, int count, Random& random) {
    Setting setting;
    setting.offset = value;
    return cubeAnd(1.0, 0.5, setting, count, random);
  };
  return d;
}

Direction size(int stride) {
  Direction d{"size", "both bodies so large; 10 m/s, 0.1 s", "m", powers(-6, 6, stride), 0, {}};
  d.easy = indexOf(d.values, 1.0);
  d.groups = [](double value, int count, Random& random) {
    return cubeAnd(value, 0.5 * value, Setting(), count, random);
  };
  return d;
}

Direction ratio(int stride) {
  Direction d{"ratio", "A so many times as large as B; their mean 1 m, 10 m/s, 0.1 s", "", {}, 0, {}};
  d.values = powers(0, 9, stride);
  d.groups = [](double value, int count, Random& random) {
    return cubeAnd(std::sqrt(value), 1.0 / std::sqrt(value), Setting(), count, random);
  };
  return d;
}

Direction speed(int stride) {
  Direction d{"speed", "1 m, 0.1 s", "m/s", powers(-9, 5, stride), 0, {}};
  d.easy = indexOf(d.values, 10.0);
  d.groups = [](double value, int count, Random& random) {
    Setting setting;
    setting.speed = value;
    return cubeAnd(1.0, 0.5, setting, count, random);
  };
  return d;
}

Direction step(int stride) {
  Direction d{"step", "time between two poses; 1 m, 10 m/s", "s", powers(-9, 4, stride), 0, {}};
  d.easy = d.values.size() / 2;
  d.groups = [](double value, int count, Random& random) {
    Setting setting;
    setting.step_ns = std::llround(value * 1e9);
    return cubeAnd(1.0, 0.5, setting, count, random);
  };
  return d;
}

Direction stamp() {
  Direction d{"stamp", "the poses' first stamp; 1 m, 10 m/s, 0.1 s", "s", {0.0, 1.0, 1e6, 1.7e9, 9.2e9}, 0,
              {}};
  d.groups = [](double value, int count, Random& random) {
    Setting setting;
    setting.start_ns = std::llround(value * 1e9) + (value > 0.0 ? 123'456'789 : 0);
    return cubeAnd(1.0, 0.5, setting, count, random);
  };
  return d;
}

Direction spin(bool quick) {
  Direction d{"spin", "a bar turns into a ball; a mesh falls spinning on a face; 1 m, 0.1 s", "rad/s", {}, 0,
              {}};
  d.values = powers(-3, quick ? 4 : 6, quick ? 2 : 1);
  d.easy = indexOf(d.values, quick ? 10.0 : 1.0);
  d.groups = [](double value, int count, Random& random) {
    std::vector<Group> groups;
    groups.push_back(barAndBall(value, 100'000'000, count, random));
    groups.push_back(spinningFall(tetrahedron(1.0), value, 10.0, 100'000'000, count, random));
    return groups;
  };
  return d;
}

Direction stiffSpin(bool quick) {
  Direction d{"stiff", "the same spin with an approach of 1 cm/s", "rad/s", {}, 0, {}};
  d.values = powers(1, quick ? 4 : 6);
  d.groups = [](double value, int count, Random& random) {
    std::vector<Group> groups;
    groups.push_back(slowApproach(value, 0.01, 1'000'000'000, count, random));
    groups.push_back(spinningFall(tetrahedron(1.0), value, 0.01, 1'000'000'000, count, random));
    return groups;
  };
  return d;
}

Direction arm() {
  Direction d{"arm", "a mesh at the end of an arm so long, its tip at 100 m/s", "m", powers(1, 9), 0, {}};
  d.groups = [](double value, int count, Random& random) {
    std::vector<Group> groups;
    groups.push_back(longArm(value, count, random));
    return groups;
  };
  return d;
}

Direction acceleration(int stride) {
  Direction d{"reversal", "acceleration that reverses within 0.1 s (hermite)", "m/s^2", {}, 0, {}};
  d.values = powers(-3, 9, stride);
  d.easy = d.values.size() / 2;
  d.groups = [](double value, int count, Random& random) {
    std::vector<Group> groups;
    groups.push_back(reversal(value, 100'000'000, count, random));
    return groups;
  };
  return d;
}

Direction graze(int stride) {
  Direction d{"graze", "closing speed at the touch, per speed: past a ball and past an edge at 10 m/s",
              "",      {},
              0,       {}};
  d.values = powers(-1, -9, stride);
  d.values.push_back(0.0);
  d.groups = [](double value, int count, Random& random) {
    std::vector<Group> groups;
    groups.push_back(grazingBalls(value, count, random));
    groups.push_back(grazingEdge(value, count, random));
    return groups;
  };
  return d;
}

Direction sliver(int stride) {
  Direction d{"sliver", "four slivers side by side, each of such an angle, legs of 1 m", "rad", {}, 0, {}};
  d.values = powers(-1, -15, stride);
  d.values.push_back(0.0);
  d.groups = [](double value, int count, Random& random) {
    auto groups = fourKinds(sliverFan(value), 1.0, 0.1, Setting(), count, random);
    groups.pop_back();  // a box has no slivers
    return groups;
  };
  return d;
}

Direction triangles(bool quick) {
  Direction d{"triangles", "a ball of so many, spinning at 3 rad/s, falls on a face at 10 m/s", "", {}, 0,
              {}};
  d.values = quick ? std::vector<double>{8, 968} : std::vector<double>{8, 968, 9800, 99'012, 1'002'528};
  d.groups = [](double value, int count, Random& random) {
    std::vector<Group> groups;
    const int rows = static_cast<int>(std::lround(std::sqrt(value / 8.0)));
    groups.push_back(spinningFall(noisySphere(rows, 31), 3.0, 10.0, 100'000'000, std::min(count, 4), random));
    return groups;
  };
  return d;
}

}  // namespace

std::vector<Direction> allDirections(bool quick) {
  const int stride = quick ? 3 : 1;
  return {offset(stride),       size(stride),         ratio(stride),
          speed(quick ? 2 : 1), step(stride),         stamp(),
          spin(quick),          stiffSpin(quick),     arm(),
          acceleration(stride), graze(quick ? 2 : 1), sliver(quick ? 2 : 1),
          triangles(quick)};
}

}  // namespace collision_node::report

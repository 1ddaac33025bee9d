#include <cmath>

#include "collision_node/report/made_meshes.h"
#include "collision_node/report/scenes/building.h"
#include "collision_node/report/scenes/scenes.h"
#include "collision_node/report/truth/marched_truth.h"

namespace collision_node::report {
namespace {

using geometry::Pose;
using geometry::Quat;
using geometry::Vec3;

Trials withTruth(std::string name, std::string about, QuerySet set) {
  Trials trials{std::move(name), std::move(about), std::move(set), {}};
  trials.truths = marchedTruths(trials.set);
  return trials;
}

geometry::Shape anyDrone(Random& random) {
  const auto kind = static_cast<int>(random.in(0.0, 4.0));
  const double a = random.in(0.1, 0.4), b = random.in(0.2, 0.6), c = random.in(0.1, 0.4);
  if (kind == 0) return geometry::Box{{a, b, c}};
  if (kind == 1) return geometry::Cylinder{0.5 * a, b};
  if (kind == 2) return geometry::Sphere{0.5 * b};
  return geometry::Capsule{0.5 * a, b};
}

}  // namespace

Trials tumbling(int triangles, std::size_t count) {
  const std::string thousands = std::to_string(triangles / 1000);
  return withTruth("tumbling_" + thousands + "k",
                   "two meshes of " + thousands + "k triangles, both turn by up to half a turn in 1 s",
                   tumblingMeshes(triangles, count));
}

Trials largeOffset(std::size_t count) {
  QuerySet set = tumblingMeshes(1000, count);
  for (Query& query : set.queries) {
    for (motion::RigidMotion* motion : {&query.piece.a, &query.piece.b}) motion->c[0] += Vec3(1e8, -7e7, 3e7);
  }
  return withTruth("large_offset", "as tumbling_1k, 1.3e8 m from the world's origin", std::move(set));
}

Trials deepOverlap(std::size_t count) {
  QuerySet set = tumblingMeshes(10000, count);
  Random random(6001);
  for (Query& query : set.queries) query.piece.b.c[0] = query.piece.a.c[0] + random.vector(0.0, 0.6);
  return withTruth("deep_overlap", "as tumbling_10k, one in the other from the start", std::move(set));
}

Trials highSpin(std::size_t count) {
  return withTruth("high_spin", "a splinter of 960 triangles at 2000 m/s and 1e5 rad/s, a vehicle of 22 640",
                   splinterShots(count, 1e5));
}

Trials spinningBlade(std::size_t count) {
  QuerySet set;
  addBody(set, geometry::Box{{2.0, 0.15, 0.02}});
  addBody(set, geometry::Sphere{0.03});
  Random random(6101);
  for (std::size_t i = 0; i < count; ++i) {
    const double phase = random.in(0.0, 3.14), at = random.in(0.2, 1.02), round = random.in(0.0, 6.28);
    const Vec3 start(at * std::cos(round), at * std::sin(round), random.in(0.2, 0.8));
    const Vec3 home = random.vector(0.0, 3.0), common = random.vector(0.0, 10.0);
    const Quat turned(Eigen::AngleAxisd(phase, Vec3::UnitZ()));
    const Vec3 fall = Vec3(random.in(-5.0, 5.0), random.in(-5.0, 5.0), -30.0);
    set.queries.push_back(query(0, 1, flight({home, turned}, common, kFrame, 300.0 * Vec3::UnitZ()),
                                flight({home + start, Quat::Identity()}, common + fall, kFrame), kFrame));
  }
  return withTruth("spinning_blade", "a blade of 2 m at 300 rad/s, a ball of 3 cm through its disc at 30 m/s",
                   std::move(set));
}

Trials ballistic(std::size_t count) {
  QuerySet set;
  addBody(set, geometry::Mesh{vehicle()});
  addBody(set, geometry::Sphere{0.08});
  Random random(6201);
  for (std::size_t i = 0; i < count; ++i) {
    const double hit = random.in(0.3, 0.9);
    const Vec3 drive(15.0, 0.0, 0.0);
    const Vec3 goal = 1.3 * random.inBox({-3.0, -1.7, -0.8}, {3.0, 1.7, 1.2}) + hit * drive;
    const Vec3 fall(random.in(-8.0, 8.0), random.in(-8.0, 8.0), -9.81);  // drag bends the path too
    const Vec3 arrives(random.in(-40.0, 40.0), random.in(-40.0, 40.0), random.in(-30.0, -10.0));
    const auto along = [&](double t) -> Vec3 {
      return goal + (t - hit) * arrives + 0.5 * (t - hit) * (t - hit) * fall;
    };
    motion::StampedPose from, to;
    from.stamp_ns = kStart, to.stamp_ns = kStart + kSecond;
    from.has_twist = to.has_twist = true;
    from.pose.position = along(0.0), to.pose.position = along(1.0);
    from.linear = arrives - hit * fall, to.linear = arrives + (1.0 - hit) * fall + random.vector(0.0, 2.0);
    set.queries.push_back(query(0, 1, flight(Pose(), drive, kSecond), motion::hermite(from, to), kSecond));
  }
  return withTruth("ballistic",
                   "a shell of 8 cm on a Hermite cubic of 1 s, a driving vehicle of 22 640 triangles",
                   std::move(set));
}

Trials swarm(std::size_t count) {
  constexpr int kWide = 4, kHigh = 3;
  QuerySet set;
  Random random(6301);
  std::vector<motion::RigidMotion> motions;
  const motion::Nanoseconds duration = kSecond / 10;
  for (int x = 0; x < kWide; ++x) {
    for (int y = 0; y < kWide; ++y) {
      for (int z = 0; z < kHigh; ++z) {
        addBody(set, anyDrone(random));
        const Vec3 place = 1.1 * Vec3(x, y, z) + random.inBox(Vec3::Constant(-0.1), Vec3::Constant(0.1));
        const Quat turned = random.orientation();
        const Vec3 velocity = random.vector(0.0, 60.0), spin = random.vector(0.0, 20.0);
        motions.push_back(flight({place, turned}, velocity, duration, spin));
      }
    }
  }
  for (std::uint32_t a = 0; a < set.bodies.size(); ++a) {
    for (std::uint32_t b = a + 1; b < set.bodies.size() && set.queries.size() < count; ++b) {
      set.queries.push_back(query(a, b, motions[a], motions[b], duration));
    }
  }
  return withTruth("swarm",
                   "48 boxes, cylinders, spheres and capsules within 4 m, up to 60 m/s, 0.1 s: all pairs",
                   std::move(set));
}

}  // namespace collision_node::report

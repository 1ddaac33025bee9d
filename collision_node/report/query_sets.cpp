#include "collision_node/report/query_sets.h"

#include <cmath>
#include <stdexcept>
#include <utility>

#include "collision_node/report/made_meshes.h"
#include "collision_node/report/random.h"
#include "collision_node/report/scenes/building.h"

namespace collision_node::report {
namespace {

using geometry::Pose;
using geometry::Quat;
using geometry::Shape;
using geometry::Vec3;
using motion::Nanoseconds;

constexpr double kSpeed = 2000.0;  // [m/s]
constexpr double kHalfTurn = 3.141592653589793;

motion::RigidMotion between(const Pose& from, const Pose& to, Nanoseconds duration) {
  motion::StampedPose first, second;
  first.stamp_ns = kStart;
  first.pose = from;
  second.stamp_ns = kStart + duration;
  second.pose = to;
  return motion::straightSlerp(first, second);
}

/// B starts at `start` from A and travels `travel` relative to it; where in the world and how both turn is
/// drawn.
impact::Piece tumble(Random& random, const Vec3& start, const Vec3& travel) {
  const Vec3 home = random.inBox(Vec3::Constant(-5.0), Vec3::Constant(5.0));
  const Vec3 common = random.vector(0.0, 2.0);
  const Quat qa = random.orientation(), qb = random.orientation();
  const Quat ta = random.turn(kHalfTurn), tb = random.turn(kHalfTurn);
  impact::Piece piece;
  piece.start_ns = kStart;
  piece.end_ns = kStart + kSecond;
  piece.a = between({home, qa}, {home + common, (ta * qa).normalized()}, kSecond);
  piece.b = between({home + start, qb}, {home + start + common + travel, (tb * qb).normalized()}, kSecond);
  return piece;
}

/// From 20 to 40 m away towards somewhere near the vehicle.
motion::RigidMotion shot(Random& random, double aim) {
  Vec3 from = random.direction();
  from.z() = std::abs(from.z());
  const Vec3 start = random.in(20.0, 40.0) * from;
  const Vec3 goal = aim * random.inBox({-3.3, -1.8, -1.0}, {3.3, 1.8, 1.3});
  const Vec3 end = start + kSpeed * 1e-9 * static_cast<double>(kFrame) * (goal - start).normalized();
  const Quat q = random.orientation();
  return between({start, q}, {end, q}, kFrame);
}

QuerySet shots(Shape projectile, std::uint64_t seed, std::size_t count, double spin) {
  QuerySet set;
  addBody(set, geometry::Mesh{vehicle()});
  addBody(set, std::move(projectile));
  Random random(seed);
  for (std::size_t i = 0; i < count; ++i) {
    Query query;
    query.b = 1;
    query.piece.start_ns = kStart;
    query.piece.end_ns = kStart + kFrame;
    query.piece.a = motion::fixedAt(Pose());
    query.piece.b = shot(random, 1.27);
    query.piece.b.omega = spin * random.direction();
    set.queries.push_back(query);
  }
  return set;
}

Shape anyPrimitive(Random& random) {
  const auto kind = static_cast<int>(random.in(0.0, 4.0));
  const Vec3 size = random.inBox(Vec3::Constant(0.1), Vec3::Constant(1.0));
  switch (kind) {
    case 0:
      return geometry::Box{size};
    case 1:
      return geometry::Cylinder{0.5 * size.x(), size.y()};
    case 2:
      return geometry::Sphere{0.5 * size.x()};
    default:
      return geometry::Capsule{0.5 * size.x(), size.y()};
  }
}

}  // namespace

QuerySet tumblingMeshes(int triangles, std::size_t count) {
  const int rows = static_cast<int>(std::lround(std::sqrt(triangles / 8.0)));
  QuerySet set;
  addBody(set, geometry::Mesh{noisySphere(rows, 11)});
  addBody(set, geometry::Mesh{noisySphere(rows, 12)});
  Random random(2001);
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 towards = random.direction();
    const Vec3 start = -random.in(2.5, 3.5) * towards;
    const Vec3 goal = random.across(towards, 0.0, 6.4);
    Query query;
    query.b = 1;
    query.piece = tumble(random, start, random.in(2.0, 3.0) * (goal - start).normalized());
    set.queries.push_back(query);
  }
  return set;
}

QuerySet particleShots(std::size_t count) { return shots(geometry::Point{}, 3001, count, 0.0); }

QuerySet sphereShots(std::size_t count) { return shots(geometry::Sphere{0.05}, 3001, count, 0.0); }

QuerySet splinterShots(std::size_t count, double spin) {
  return shots(geometry::Mesh{splinter(21)}, 4001, count, spin);
}

QuerySet tumblingPrimitives(std::size_t count) {
  QuerySet set;
  Random random(5001);
  for (std::size_t i = 0; i < count; ++i) {
    addBody(set, anyPrimitive(random));
    addBody(set, anyPrimitive(random));
    const geometry::Body &a = *set.bodies[2 * i], &b = *set.bodies[2 * i + 1];
    // Of the boxes: the set stays as it was frozen.
    const double reach = a.bvh()[geometry::Bvh::kRoot].reach + b.bvh()[geometry::Bvh::kRoot].reach;
    const Vec3 towards = random.direction();
    const Vec3 start = -random.in(1.01, 1.8) * reach * towards;
    const Vec3 goal = random.across(towards, 0.0, 1.36 * reach);
    Query query;
    query.a = static_cast<std::uint32_t>(2 * i);
    query.b = query.a + 1;
    query.piece = tumble(random, start, random.in(1.5, 2.5) * reach * (goal - start).normalized());
    set.queries.push_back(query);
  }
  return set;
}

}  // namespace collision_node::report

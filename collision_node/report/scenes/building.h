/// What sets and scenes are built from.
#pragma once

#include <utility>

#include "collision_node/report/query_sets.h"
#include "collision_node/report/random.h"

namespace collision_node::report {

constexpr motion::Nanoseconds kStart = 1'600'000'000'000'000'000;  ///< like a robot's clock
constexpr motion::Nanoseconds kSecond = 1'000'000'000;
constexpr motion::Nanoseconds kFrame = 33'333'333;  ///< 30 Hz

/// One shape at its body's origin.
inline void addBody(QuerySet& set, geometry::Shape shape) {
  std::vector<geometry::PlacedShape> shapes;
  shapes.push_back({std::move(shape), geometry::Pose(), "made"});
  set.bodies.push_back(std::make_unique<geometry::Body>(std::move(shapes)));
}

/// Straight and at a constant spin, from a pose at kStart on.
inline motion::RigidMotion flight(const geometry::Pose& from, const geometry::Vec3& velocity,
                                  motion::Nanoseconds duration,
                                  const geometry::Vec3& spin = geometry::Vec3::Zero()) {
  motion::RigidMotion motion;
  motion.start_ns = kStart;
  motion.end_ns = kStart + duration;
  motion.c[0] = from.position;
  motion.c[1] = velocity;
  motion.q0 = from.orientation;
  motion.omega = spin;
  return motion;
}

inline Query query(std::uint32_t a, std::uint32_t b, const motion::RigidMotion& motion_a,
                   const motion::RigidMotion& motion_b, motion::Nanoseconds duration) {
  Query query;
  query.a = a, query.b = b;
  query.piece.start_ns = kStart;
  query.piece.end_ns = kStart + duration;
  query.piece.a = motion_a;
  query.piece.b = motion_b;
  return query;
}

}  // namespace collision_node::report

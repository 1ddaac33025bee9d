#include "collision_node/report/stability/grazing_trials.h"

#include <algorithm>
#include <cmath>

#include "collision_node/report/stability/shapes.h"
#include "collision_node/report/stability/straight_trials.h"

namespace collision_node::report {
namespace {

using geometry::Quat;
using geometry::Vec3;

/// How far aside two things pass whose reaches sum up to kGrazeReach.
double aside(double share, bool meets) {
  const double depth = 1.0 - std::sqrt(1.0 - share * share);
  return kGrazeReach * (meets ? 1.0 - depth : 1.0 + std::max(depth, 4e-16));
}

/// B from `from` to `to`, A at rest at the origin with orientation `q`.
void record(Group& group, const Quat& q, const Vec3& from, const Vec3& to, double share) {
  const Setting setting;
  const Flight a = flight(setting, Vec3::Zero(), Vec3::Zero(), q);
  const Flight b = flight(setting, from, to, Quat::Identity());
  impact::Piece piece = pieceOf(a, b);
  piece.a = motion::fixedAt(a.from.pose);
  const auto touch = firstTouch<Exact>(surfaceOf<Exact>(*group.trials.set.bodies[0], q),
                                       surfaceOf<Exact>(*group.trials.set.bodies[1], Quat::Identity()),
                                       b.start(), b.velocity());
  if (touch) {
    group.addContact(piece, touch->time, &touch->point, share * kGrazeSpeed);
  } else {
    group.addApart(piece, 0.5 * kGrazeReach * share * share + 1e-15);
  }
}

}  // namespace

Group grazingBalls(double share, int count, Random& random) {
  Group group =
      makeGroup("ball, ball", geometry::Sphere{0.5 * kGrazeReach}, geometry::Sphere{0.5 * kGrazeReach});
  const double path = 1e-9 * static_cast<double>(Setting().step_ns) * kGrazeSpeed;
  for (int i = 0; i < count; ++i) {
    const Vec3 along = share > 0.0 ? random.direction() : Vec3(Vec3::UnitX());
    const Vec3 across = share > 0.0 ? random.across(along, 1.0, 1.0) : Vec3(Vec3::UnitY());
    const Vec3 nearest = aside(share, i % 2 == 0) * across;
    const double before = share > 0.0 ? random.in(0.4, 0.6) : 0.5;
    record(group, Quat::Identity(), nearest - before * path * along, nearest + (1.0 - before) * path * along,
           share);
  }
  return group;
}

Group grazingEdge(double share, int count, Random& random) {
  constexpr double kCube = 4.0;  // [m]
  Group group = makeGroup("ball, edge", geometry::Mesh{cubeMesh(kCube)}, geometry::Sphere{kGrazeReach});
  const double path = 1e-9 * static_cast<double>(Setting().step_ns) * kGrazeSpeed;
  for (int i = 0; i < count; ++i) {
    const Quat q = share > 0.0 ? random.orientation() : Quat::Identity();
    const Vec3 out = std::sqrt(0.5) * Vec3(1.0, 1.0, 0.0);
    const Vec3 nearest =
        Vec3(0.5 * kCube, 0.5 * kCube, random.in(-0.5, 0.5)) + aside(share, i % 2 == 0) * out;
    const Vec3 along = std::sqrt(0.5) * Vec3(1.0, -1.0, 0.0);
    const double before = random.in(0.4, 0.6);
    record(group, q, q * (nearest - before * path * along), q * (nearest + (1.0 - before) * path * along),
           share);
  }
  return group;
}

}  // namespace collision_node::report

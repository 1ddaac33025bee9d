/// What the tests of the nasty cases share: shapes by one word, one frame of flight, and what a case may
/// claim.
#pragma once

#include <gtest/gtest.h>

#include "test/impact/watched_pair.h"

namespace nasty {

namespace motion = collision_node::motion;
using collision_node::geometry::Body;
using collision_node::geometry::Box;
using collision_node::geometry::Cylinder;
using collision_node::geometry::PlacedShape;
using collision_node::geometry::Point;
using collision_node::geometry::Quat;
using collision_node::geometry::SolidChoice;
using collision_node::geometry::Sphere;
using collision_node::geometry::Vec3;
using collision_node::impact::Answer;
using collision_node::impact::Certificate;
using collision_node::impact::Feature;
using collision_node::impact::Kind;
using collision_node::impact::PairEvent;
using collision_node::impact::PairOptions;
using collision_node::impact::PairState;
using collision_node::impact::Piece;
using collision_node::impact::PieceOutcome;
using collision_node::impact::Reason;
using moving::Corners;
using moving::flight;
using moving::holds;
using moving::kFrame;
using moving::kInAndOut;
using moving::Nanoseconds;
using moving::resting;
using moving::RigidMotion;
using moving::Watched;
using moving::widthOf;
using oracle::Real;
using Phase = PairState::Phase;

constexpr double kPi = 3.141592653589793;
constexpr Real kExactPi = 3.14159265358979323846L;
constexpr double kFrameSeconds = kFrame * 1e-9;
constexpr Nanoseconds kSecond = 1'000'000'000;

inline PlacedShape point() { return moving::placed(Point{}); }
inline PlacedShape sphere(double radius, const Vec3& at = Vec3::Zero()) {
  return moving::placed(Sphere{radius}, at);
}
inline PlacedShape box(double x, double y, double z, const Vec3& at = Vec3::Zero()) {
  return moving::placed(Box{{x, y, z}}, at);
}
/// Every edge direction and every corner of it is a small dyadic number.
inline PlacedShape octahedron(double r) {
  return moving::mesh(
      {{r, 0, 0}, {-r, 0, 0}, {0, r, 0}, {0, -r, 0}, {0, 0, r}, {0, 0, -r}},
      {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}});
}
/// A ridge along x at z = 0 over |x| <= half, its body below it; `turned` makes it hang with the body above.
inline PlacedShape ridge(double half, bool turned = false) {
  const double down = turned ? 1 : -1;
  std::vector<Corners> faces = {{0, 1, 3}, {0, 3, 2}, {1, 0, 4}, {1, 4, 5},
                                {2, 3, 5}, {2, 5, 4}, {0, 2, 4}, {1, 5, 3}};
  if (turned)
    for (Corners& c : faces) std::swap(c[1], c[2]);
  return moving::mesh(
      {{-half, 0, 0}, {half, 0, 0}, {-half, -1, down}, {half, -1, down}, {-half, 1, down}, {half, 1, down}},
      faces);
}

/// b from `from` at `velocity` for one frame, a at rest in the origin.
inline PieceOutcome fly(Watched& pair, const Vec3& from, const Vec3& velocity,
                        const Vec3& omega = Vec3::Zero(), const Quat& turn = Quat::Identity()) {
  return pair.advance(0, kFrame, resting(), flight(0, kFrame, from, velocity, omega, turn));
}

/// Whether some bracket of this kind holds the time [s after `from_ns`].
inline bool anyHolds(const Watched& pair, Kind kind, Nanoseconds from_ns, Real time, Real error = 1e-15L) {
  for (const PairEvent& e : pair.events)
    if (e.kind == kind && holds(e, from_ns, time, error)) return true;
  return false;
}

/// The reported ball holds the point.
inline bool ballHolds(const PairEvent& e, const Vec3& at) {
  return (e.position - at).norm() <= e.position_error;
}
/// The reported cone holds the direction.
inline bool coneHolds(const PairEvent& e, const Vec3& n) {
  return e.normal.allFinite() &&
         std::atan2(e.normal.cross(n).norm(), e.normal.dot(n)) <= e.normal_error + 1e-15;
}

}  // namespace nasty

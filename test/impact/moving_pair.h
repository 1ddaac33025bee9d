/// Bodies, motions and pieces for the solver's unit tests, each with its twin in the oracle.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "collision_node/geometry/body.h"
#include "collision_node/impact/pair_piece.h"
#include "test/impact/fuzz_shapes.h"
#include "test/oracle/pair.h"

namespace moving {

using collision_node::geometry::Body;
using collision_node::geometry::Element;
using collision_node::geometry::Mat3;
using collision_node::geometry::PlacedShape;
using collision_node::geometry::Pose;
using collision_node::geometry::Quat;
using collision_node::geometry::SolidChoice;
using collision_node::geometry::Vec3;
using collision_node::impact::PairPiece;
using collision_node::impact::Piece;
using collision_node::motion::Nanoseconds;
using collision_node::motion::RigidMotion;
using fuzz::Random;
using oracle::Real;

using Corners = std::array<std::int32_t, 3>;
using Shapes = std::vector<PlacedShape>;

inline Vec3 randomVec(Random& random, double size) {
  return {random.in(-size, size), random.in(-size, size), random.in(-size, size)};
}

inline PlacedShape placed(collision_node::geometry::Shape shape, const Vec3& position = Vec3::Zero()) {
  return {std::move(shape), {position, Quat::Identity()}, "made"};
}

inline PlacedShape mesh(std::vector<Vec3> vertices, std::vector<Corners> triangles,
                        SolidChoice solid = SolidChoice::kAuto, const Vec3& position = Vec3::Zero()) {
  auto made =
      collision_node::geometry::makeTriangleMesh(std::move(vertices), std::move(triangles), solid, "made");
  return placed(
      collision_node::geometry::Mesh{std::make_shared<collision_node::geometry::TriangleMesh>(made)},
      position);
}

/// Two triangles in the plane z = 0 that share the diagonal x = y, over |x|, |y| <= half.
inline PlacedShape sheet(double half, const Vec3& position = Vec3::Zero()) {
  return mesh({{-half, -half, 0}, {half, -half, 0}, {half, half, 0}, {-half, half, 0}},
              {{0, 1, 2}, {0, 2, 3}}, SolidChoice::kAuto, position);
}

/// A closed box of twelve triangles, outward; inward when `inside_out`.
inline void addBox(std::vector<Vec3>& vertices, std::vector<Corners>& triangles, const Vec3& centre,
                   const Vec3& half, bool inside_out = false) {
  const auto base = static_cast<std::int32_t>(vertices.size());
  for (int i = 0; i < 8; ++i)
    vertices.push_back(centre + Vec3(i & 1 ? half.x() : -half.x(), i & 2 ? half.y() : -half.y(),
                                     i & 4 ? half.z() : -half.z()));
  for (Corners c : {Corners{0, 2, 1}, Corners{1, 2, 3}, Corners{4, 5, 6}, Corners{5, 7, 6}, Corners{0, 1, 4},
                    Corners{1, 5, 4}, Corners{2, 6, 3}, Corners{3, 6, 7}, Corners{0, 4, 2}, Corners{2, 4, 6},
                    Corners{1, 3, 5}, Corners{3, 7, 5}}) {
    if (inside_out) std::swap(c[1], c[2]);
    triangles.push_back({base + c[0], base + c[1], base + c[2]});
  }
}

inline PlacedShape boxMesh(const Vec3& half, const Vec3& position = Vec3::Zero(),
                           SolidChoice solid = SolidChoice::kAuto) {
  std::vector<Vec3> vertices;
  std::vector<Corners> triangles;
  addBox(vertices, triangles, Vec3::Zero(), half);
  return mesh(vertices, triangles, solid, position);
}

/// A closed torus about z, outward.
inline PlacedShape torus(double ring, double tube, int around, int across,
                         SolidChoice solid = SolidChoice::kAuto) {
  constexpr double kTurn = 6.283185307179586;
  std::vector<Vec3> vertices;
  std::vector<Corners> triangles;
  for (int i = 0; i < around; ++i) {
    for (int j = 0; j < across; ++j) {
      const double u = kTurn * i / around, v = kTurn * j / across, r = ring + tube * std::cos(v);
      vertices.push_back({r * std::cos(u), r * std::sin(u), tube * std::sin(v)});
      const auto at = [&](int k, int l) { return (k % around) * across + l % across; };
      triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return mesh(vertices, triangles, solid);
}

/// A straight path and a constant spin from `start_ns` on.
inline RigidMotion flight(Nanoseconds start_ns, Nanoseconds end_ns, const Vec3& from, const Vec3& velocity,
                          const Vec3& omega = Vec3::Zero(), const Quat& turn = Quat::Identity()) {
  RigidMotion motion;
  motion.start_ns = start_ns;
  motion.end_ns = end_ns;
  motion.c[0] = from;
  motion.c[1] = velocity;
  motion.omega = omega;
  motion.q0 = turn;
  return motion;
}

inline RigidMotion resting(const Vec3& position = Vec3::Zero(), const Quat& turn = Quat::Identity()) {
  return collision_node::motion::fixedAt({position, turn});
}

/// The element as the oracle's part, taken exactly; boxes and hulls have too many vertices for one.
inline oracle::Part exactPart(const Element& e) {
  oracle::Part part;
  part.radius = e.radius;
  if (e.vertices == nullptr) {
    part.cylinder = {oracle::exact(e.centre), oracle::exact(e.axis), e.rim_radius, e.half_length};
    return part;
  }
  part.count = e.count;
  for (int i = 0; i < e.count; ++i) part.vertex[i] = oracle::exact(e.vertices[i]);
  return part;
}

/// Two bodies on one piece for the solver, and the same in extended precision.
class Pair {
 public:
  Pair(Shapes a, Shapes b, const Piece& p, double contact_distance = 0.0)
      : body_a(a),
        body_b(b),
        piece(p),
        solver(body_a, body_b, piece, contact_distance),
        exact(oracle::makePair(a, b, piece.a, piece.b, piece.start_ns, piece.end_ns)) {}

  const Body body_a, body_b;
  const Piece piece;
  const PairPiece solver;
  const oracle::Pair exact;
};

/// Spins up to 20 rad in the piece, cubic paths, segments that begin before the piece; b's point `aim_b`
/// meets a's `aim_a` at `at` seconds, off by `offset`.
inline Piece randomPiece(Random& random, double size, const Vec3& aim_a, const Vec3& aim_b, double at_share,
                         const Vec3& offset) {
  Piece piece;
  const auto span = static_cast<Nanoseconds>(random.decade(5, 8.5));
  piece.start_ns = 1'700'000'000'000'000'000 + static_cast<Nanoseconds>(random.in(0, 1e12));
  piece.end_ns = piece.start_ns + span;
  const double duration = 1e-9 * static_cast<double>(span);
  const double path = size * random.decade(-1, 1.5);
  for (RigidMotion* m : {&piece.a, &piece.b}) {
    m->start_ns = piece.start_ns - static_cast<Nanoseconds>(random.chance(0.5) ? 0.0 : random.in(0, 2e8));
    m->end_ns = piece.end_ns + 1000;
    m->q0 = random.orientation();
    m->omega = (random.chance(0.2) ? 0.0 : random.in(0, 20)) / duration * random.direction();
    m->c[1] = path / duration * randomVec(random, 1);
    if (random.chance(0.5)) {
      m->c[2] = 0.3 * path / (duration * duration) * randomVec(random, 1);
      m->c[3] = 0.3 * path / (duration * duration * duration) * randomVec(random, 1);
    }
  }
  const Real t = static_cast<Real>(at_share) * duration;
  const oracle::Frame fa = oracle::Path(piece.a, piece.start_ns, {}).at(t);
  const oracle::Frame fb = oracle::Path(piece.b, piece.start_ns, {}).at(t);
  const oracle::V3 shift =
      fa.place(oracle::exact(aim_a)) - fb.place(oracle::exact(aim_b)) + oracle::exact(offset);
  piece.b.c[0] = {static_cast<double>(shift.x), static_cast<double>(shift.y), static_cast<double>(shift.z)};
  return piece;
}

}  // namespace moving

/// Shots past bumpy closed meshes, and what brute force over all triangles in extended precision says of
/// them. Shares no code with the solver.
#pragma once

#include <array>
#include <vector>

#include "test/impact/moving_pair.h"
#include "test/oracle/flat_distance.h"

namespace moving {

using oracle::V3;

constexpr Nanoseconds kSpan = 33'333'333;

/// Triangles, where they stand, and a shot past them.
struct Shot {
  std::vector<Vec3> vertices;
  std::vector<Corners> triangles;
  Pose pose;
  Vec3 from = Vec3::Zero(), velocity = Vec3::Zero();  // in the world, at the start
  double radius = 0.0;

  double duration() const { return static_cast<double>(kSpan) * 1e-9; }
  /// The shot in the triangles' frame, in extended precision.
  V3 at(Real t) const {
    const oracle::M3 r = oracle::rotationOf(pose.orientation);
    const V3 d = oracle::exact(from) - oracle::exact(pose.position) + t * oracle::exact(velocity);
    return {oracle::dot(r.column[0], d), oracle::dot(r.column[1], d), oracle::dot(r.column[2], d)};
  }
  Piece piece() const {
    Piece p;
    p.start_ns = 1'700'000'000'000'000'000;
    p.end_ns = p.start_ns + kSpan;
    p.a = resting(pose.position, pose.orientation);
    p.b = flight(p.start_ns, p.end_ns, from, velocity);
    return p;
  }
  std::array<V3, 3> corners(const Corners& c) const {
    return {oracle::exact(vertices[c[0]]), oracle::exact(vertices[c[1]]), oracle::exact(vertices[c[2]])};
  }
};

/// When the line crosses the triangle; `sure` is false where the signs are too small to tell.
struct Truth {
  bool hit = false, sure = true;
  Real time = 0;
  int triangle = -1;
};
inline Truth crossing(const V3& p, const V3& v, const std::array<V3, 3>& c) {
  Real side[3], size = 0;
  for (int k = 0; k < 3; ++k) {
    const V3 i = c[(k + 1) % 3] - p, j = c[(k + 2) % 3] - p;
    side[k] = oracle::dot(v, oracle::cross(i, j));
    size = std::max(size, oracle::norm(i) * oracle::norm(j) * oracle::norm(v));
  }
  Truth truth;
  const Real least = std::min({side[0], side[1], side[2]}), most = std::max({side[0], side[1], side[2]});
  const Real unsure = 1e-13L * size;
  truth.sure = std::abs(side[0]) > unsure && std::abs(side[1]) > unsure && std::abs(side[2]) > unsure;
  truth.hit = least > 0 || most < 0;
  const V3 n = oracle::cross(c[1] - c[0], c[2] - c[0]);
  if (truth.hit) truth.time = oracle::dot(n, c[0] - p) / oracle::dot(n, v);
  return truth;
}
inline Truth firstCrossing(const Shot& shot) {
  const V3 p = shot.at(0), v = shot.at(1) - p;
  Truth first;
  for (std::size_t i = 0; i < shot.triangles.size(); ++i) {
    const Truth one = crossing(p, v, shot.corners(shot.triangles[i]));
    first.sure &= one.sure || !one.hit;
    if (!one.hit || one.time < 0 || one.time > shot.duration()) continue;
    if (!first.hit || one.time < first.time) first = {true, first.sure, one.time, static_cast<int>(i)};
  }
  return first;
}

/// A closed, star-shaped body of about `size`, bumpy.
inline void addStar(Random& random, Shot& shot, int rows, int columns, double size) {
  const auto base = static_cast<std::int32_t>(shot.vertices.size());
  const auto radius = [&] { return size * random.in(0.8, 1.2); };
  for (int i = 1; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) {
      const double u = M_PI * i / rows, v = 2.0 * M_PI * j / columns;
      shot.vertices.push_back(radius() *
                              Vec3(std::sin(u) * std::cos(v), std::sin(u) * std::sin(v), std::cos(u)));
    }
  }
  const auto top = static_cast<std::int32_t>(shot.vertices.size()), bottom = top + 1;
  shot.vertices.push_back(radius() * Vec3(0, 0, 1));
  shot.vertices.push_back(radius() * Vec3(0, 0, -1));
  const auto at = [&](int i, int j) { return base + (i - 1) * columns + j % columns; };
  for (int j = 0; j < columns; ++j) {
    shot.triangles.push_back({top, at(1, j), at(1, j + 1)});
    shot.triangles.push_back({bottom, at(rows - 1, j + 1), at(rows - 1, j)});
    for (int i = 1; i + 1 < rows; ++i) {
      shot.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      shot.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
}

inline Shot starShot(Random& random, double radius = 0.0, int rows = 16, int columns = 24) {
  Shot shot;
  addStar(random, shot, rows, columns, 3.0);
  shot.pose = {randomVec(random, 100.0), random.orientation()};
  shot.velocity = 2000.0 * random.direction();
  const Vec3 aim = shot.pose.position + randomVec(random, 3.5);
  shot.from = aim - random.in(0.1, 0.9) * shot.duration() * shot.velocity;
  shot.radius = radius;
  return shot;
}

}  // namespace moving

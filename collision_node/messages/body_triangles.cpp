#include "collision_node/messages/body_triangles.h"

#include <array>
#include <cmath>
#include <utility>

namespace collision_node::messages {

namespace {

using geometry::Vec3;

constexpr int kSegments = 24;
constexpr double kPointSize = 0.02;  // [m] half extent of what stands for a point
const double kPi = std::acos(-1.0);

using Triangles = std::vector<Vec3>;

void quad(Triangles& out, const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  for (const Vec3& v : {a, b, c, a, c, d}) out.push_back(v);
}

Triangles box(const Vec3& lower, const Vec3& upper) {
  const auto corner = [&](int i) {
    return Vec3(i & 1 ? upper.x() : lower.x(), i & 2 ? upper.y() : lower.y(), i & 4 ? upper.z() : lower.z());
  };
  Triangles out;
  for (const auto& f :
       {std::array<int, 4>{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}})
    quad(out, corner(f[0]), corner(f[1]), corner(f[2]), corner(f[3]));
  return out;
}

/// The surface of revolution of a profile of (radius, z), from the top down.
Triangles revolve(const std::vector<std::pair<double, double>>& profile) {
  const auto at = [](const std::pair<double, double>& p, int i) {
    const double angle = 2.0 * kPi * i / kSegments;
    return Vec3(p.first * std::cos(angle), p.first * std::sin(angle), p.second);
  };
  Triangles out;
  for (std::size_t row = 0; row + 1 < profile.size(); ++row)
    for (int i = 0; i < kSegments; ++i)
      quad(out, at(profile[row], i), at(profile[row + 1], i), at(profile[row + 1], i + 1),
           at(profile[row], i + 1));
  return out;
}

/// Two half balls of `radius`, `length` apart; a sphere when length is 0.
Triangles capsule(double radius, double length) {
  std::vector<std::pair<double, double>> profile;
  constexpr int rows = kSegments / 4;
  for (int cap = 0; cap < 2; ++cap)
    for (int row = 0; row <= rows; ++row) {
      const double angle = 0.5 * kPi * (cap + static_cast<double>(row) / rows);
      profile.emplace_back(radius * std::sin(angle),
                           radius * std::cos(angle) + (cap == 0 ? 0.5 : -0.5) * length);
    }
  return revolve(profile);
}

struct Draw {
  Triangles operator()(const geometry::Point&) const {
    const double s = kPointSize;
    const Vec3 x(s, 0, 0), y(0, s, 0), z(0, 0, s);
    Triangles out;
    for (const Vec3& top : {z, Vec3(-z)})
      for (const auto& side : {std::pair{x, y}, {y, Vec3(-x)}, {Vec3(-x), Vec3(-y)}, {Vec3(-y), x}}) {
        const bool up = top.z() > 0;
        for (const Vec3& v : {top, up ? side.first : side.second, up ? side.second : side.first})
          out.push_back(v);
      }
    return out;
  }
  Triangles operator()(const geometry::Sphere& s) const { return capsule(s.radius, 0.0); }
  Triangles operator()(const geometry::Box& b) const { return box(-0.5 * b.size, 0.5 * b.size); }
  Triangles operator()(const geometry::Cylinder& c) const {
    const double h = 0.5 * c.length;
    return revolve({{0.0, h}, {c.radius, h}, {c.radius, -h}, {0.0, -h}});
  }
  Triangles operator()(const geometry::Capsule& c) const { return capsule(c.radius, c.length); }
  Triangles operator()(const geometry::Mesh& m) const { return mesh(*m.mesh); }
  Triangles operator()(const geometry::Convex& c) const { return mesh(*c.mesh); }

  static Triangles mesh(const geometry::TriangleMesh& m) {
    if (m.triangles.size() > kMostTriangles) return box(m.report.lower, m.report.upper);
    Triangles out;
    out.reserve(3 * m.triangles.size());
    for (const auto& t : m.triangles)
      for (const auto v : t) out.push_back(m.vertices[static_cast<std::size_t>(v)]);
    return out;
  }
};

}  // namespace

std::vector<Vec3> drawnTriangles(const geometry::PlacedShape& shape) {
  Triangles out = std::visit(Draw{}, shape.shape);
  for (Vec3& v : out) v = shape.origin * v;
  return out;
}

}  // namespace collision_node::messages

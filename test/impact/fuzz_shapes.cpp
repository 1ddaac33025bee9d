#include "test/impact/fuzz_shapes.h"

#include <array>
#include <vector>

namespace fuzz {

namespace g = collision_node::geometry;
using g::Vec3;
using Faces = std::vector<std::array<std::int32_t, 3>>;

Vec3 Random::direction() {
  for (;;) {
    const Vec3 v(in(-1, 1), in(-1, 1), in(-1, 1));
    const double n = v.norm();
    if (n > 0.1 && n <= 1.0) return v / n;
  }
}

g::Quat Random::orientation() {
  for (;;) {
    const Eigen::Vector4d v(in(-1, 1), in(-1, 1), in(-1, 1), in(-1, 1));
    const double n = v.norm();
    if (n > 0.1 && n <= 1.0) return g::Quat(v[0] / n, v[1] / n, v[2] / n, v[3] / n);
  }
}

const char* toString(ShapeKind kind) {
  constexpr const char* kNames[] = {"point",   "sphere", "box",  "cylinder",
                                    "capsule", "closed", "open", "convex"};
  return kNames[static_cast<int>(kind)];
}

namespace {

struct Soup {
  std::vector<Vec3> vertices;
  Faces faces;
};

void quad(Soup& soup, int a, int b, int c, int d) {
  soup.faces.push_back({a, b, c});
  soup.faces.push_back({a, c, d});
}

Soup octahedron() {
  Soup soup;
  soup.vertices = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  for (int sx : {0, 1}) {
    for (int sy : {0, 1}) {
      for (int sz : {0, 1}) {
        const bool even = (sx + sy + sz) % 2 == 0;
        if (even) soup.faces.push_back({sx, 2 + sy, 4 + sz});
        if (!even) soup.faces.push_back({sx, 4 + sz, 2 + sy});
      }
    }
  }
  return soup;
}

/// Every triangle into four, new vertices on the unit sphere.
Soup refined(const Soup& in) {
  Soup out;
  out.vertices = in.vertices;
  const auto middle = [&](int i, int j) {
    const Vec3 m = (in.vertices[i] + in.vertices[j]).normalized();
    for (std::size_t k = in.vertices.size(); k < out.vertices.size(); ++k) {
      if ((out.vertices[k] - m).norm() < 1e-9) return static_cast<int>(k);
    }
    out.vertices.push_back(m);
    return static_cast<int>(out.vertices.size() - 1);
  };
  for (const auto& f : in.faces) {
    const int ab = middle(f[0], f[1]), bc = middle(f[1], f[2]), ca = middle(f[2], f[0]);
    out.faces.push_back({f[0], ab, ca});
    out.faces.push_back({ab, f[1], bc});
    out.faces.push_back({ca, bc, f[2]});
    out.faces.push_back({ab, bc, ca});
  }
  return out;
}

Soup noisySphere(Random& random) {
  Soup soup = octahedron();
  if (random.chance(0.7)) soup = refined(soup);
  const double noise = random.in(0.0, 0.3);
  for (Vec3& v : soup.vertices) v *= 1.0 + random.in(-noise, noise);
  return soup;
}

Soup torus(Random& random) {
  Soup soup;
  const int n = 3 + random.below(6), m = 3 + random.below(3);
  const double tube = random.in(0.15, 0.4), noise = random.in(0.0, 0.1);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < m; ++j) {
      const double u = 2 * M_PI * i / n, v = 2 * M_PI * j / m, r = tube * (1 + random.in(-noise, noise));
      soup.vertices.push_back(
          {(1 + r * std::cos(v)) * std::cos(u), (1 + r * std::cos(v)) * std::sin(u), r * std::sin(v)});
      const int i1 = (i + 1) % n, j1 = (j + 1) % m;
      quad(soup, i * m + j, i1 * m + j, i1 * m + j1, i * m + j1);
    }
  }
  return soup;
}

Soup boxMesh(const Vec3& half) {
  Soup soup;
  for (int k = 0; k < 8; ++k) {
    soup.vertices.push_back(
        {k & 1 ? half.x() : -half.x(), k & 2 ? half.y() : -half.y(), k & 4 ? half.z() : -half.z()});
  }
  quad(soup, 0, 2, 3, 1), quad(soup, 4, 5, 7, 6), quad(soup, 0, 1, 5, 4);
  quad(soup, 2, 6, 7, 3), quad(soup, 0, 4, 6, 2), quad(soup, 1, 3, 7, 5);
  return soup;
}

Soup sheet(Random& random) {
  Soup soup;
  const int n = 1 + random.below(5), m = 1 + random.below(5);
  const double noise = random.chance(0.3) ? 0.0 : random.in(0.0, 0.3);
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; j <= m; ++j) {
      soup.vertices.push_back({2.0 * i / n - 1, 2.0 * j / m - 1, random.in(-noise, noise)});
      if (i < n && j < m)
        quad(soup, i * (m + 1) + j, (i + 1) * (m + 1) + j, (i + 1) * (m + 1) + j + 1, i * (m + 1) + j + 1);
    }
  }
  if (n == 1 && m == 1 && random.chance(0.5)) soup.faces.pop_back();
  return soup;
}

Soup cloud(Random& random) {
  Soup soup;
  const int n = 6 + random.below(6);
  const Vec3 stretch(random.in(0.2, 1), random.in(0.2, 1), random.in(0.2, 1));
  for (int i = 0; i < n; ++i) soup.vertices.push_back(random.direction().cwiseProduct(stretch));
  // Only the vertices of a convex shape count; the triangles just have to name them all.
  for (int i = 0; i + 2 < n; ++i) soup.faces.push_back({i, i + 1, i + 2});
  return soup;
}

double snapped(double value, double grid) {
  return grid > 0 ? grid * std::max(1.0, std::round(value / grid)) : value;
}

std::shared_ptr<const g::TriangleMesh> meshOf(Soup soup, double scale, double grid, const char* source) {
  for (Vec3& v : soup.vertices) {
    v *= scale;
    if (grid > 0) v = (v / grid).array().round().matrix() * grid;
  }
  return std::make_shared<const g::TriangleMesh>(
      g::makeTriangleMesh(std::move(soup.vertices), std::move(soup.faces), g::SolidChoice::kAuto, source));
}

}  // namespace

g::Shape makeShape(Random& random, ShapeKind kind, double scale, double grid) {
  const auto length = [&](double lo, double hi) { return snapped(scale * random.in(lo, hi), grid); };
  switch (kind) {
    case ShapeKind::kPoint:
      return g::Point{};
    case ShapeKind::kSphere:
      return g::Sphere{length(0.2, 1)};
    case ShapeKind::kBox:
      return g::Box{{length(0.05, 2), length(0.2, 2), length(0.2, 2)}};
    case ShapeKind::kCylinder:
      return g::Cylinder{length(0.1, 1), length(0.1, 2)};
    case ShapeKind::kCapsule:
      return g::Capsule{length(0.05, 0.5), length(0.1, 2)};
    case ShapeKind::kClosedMesh:
      switch (random.below(4)) {
        case 0:
          return g::Mesh{meshOf(noisySphere(random), scale, grid, "noisy sphere")};
        case 1:
          return g::Mesh{meshOf(torus(random), scale, grid, "torus")};
        case 2:
          return g::Mesh{meshOf(boxMesh({random.in(0.1, 1), random.in(0.1, 1), random.in(0.1, 1)}), scale,
                                grid, "box mesh")};
        default:
          return g::Mesh{meshOf(boxMesh({0.002, random.in(0.002, 0.05), 1}), scale, grid, "needle")};
      }
    case ShapeKind::kOpenMesh:
      return g::Mesh{meshOf(sheet(random), scale, grid, "sheet")};
    case ShapeKind::kConvex:
      return g::Convex{meshOf(cloud(random), scale, grid, "convex cloud")};
  }
  return g::Point{};
}

Vec3 pointOf(Random& random, const g::Shape& shape) {
  if (std::holds_alternative<g::Point>(shape)) return Vec3::Zero();
  if (const auto* sphere = std::get_if<g::Sphere>(&shape))
    return sphere->radius * random.in(0, 0.9) * random.direction();
  if (const auto* box = std::get_if<g::Box>(&shape)) {
    return 0.45 * box->size.cwiseProduct(Vec3(random.in(-1, 1), random.in(-1, 1), random.in(-1, 1)));
  }
  if (const auto* c = std::get_if<g::Cylinder>(&shape)) {
    const double r = 0.9 * c->radius * random.unit(), u = random.in(0, 2 * M_PI);
    return {r * std::cos(u), r * std::sin(u), 0.45 * c->length * random.in(-1, 1)};
  }
  if (const auto* c = std::get_if<g::Capsule>(&shape)) return {0, 0, 0.5 * c->length * random.in(-1, 1)};
  const auto* mesh = std::get_if<g::Mesh>(&shape);
  const auto& data = mesh ? *mesh->mesh : *std::get<g::Convex>(shape).mesh;
  const auto& f = data.triangles[random.below(static_cast<int>(data.triangles.size()))];
  double u = random.in(0.05, 0.9), v = random.in(0.05, 0.9);
  if (u + v > 0.95) u *= 0.5, v *= 0.5;
  return (1 - u - v) * data.vertices[f[0]] + u * data.vertices[f[1]] + v * data.vertices[f[2]];
}

}  // namespace fuzz

#include "collision_node/report/made_meshes.h"

#include <cmath>
#include <utility>
#include <vector>

#include "collision_node/report/random.h"

namespace collision_node::report {
namespace {

using geometry::Vec3;

constexpr double kPi = 3.141592653589793;

struct Soup {
  std::vector<Vec3> vertices;
  std::vector<std::array<std::int32_t, 3>> triangles;

  /// Corners are welded by position later: a point must be computed the same way each time.
  void add(const Vec3& p, const Vec3& q, const Vec3& r) {
    const auto first = static_cast<std::int32_t>(vertices.size());
    vertices.insert(vertices.end(), {p, q, r});
    triangles.push_back({first, first + 1, first + 2});
  }
  MeshPtr mesh(const char* source) {
    return std::make_shared<geometry::TriangleMesh>(geometry::makeTriangleMesh(
        std::move(vertices), std::move(triangles), geometry::SolidChoice::kAuto, source));
  }
};

/// In [-1, 1], by the point alone.
double scatter(int i, int j, int k, std::uint64_t seed) {
  const auto key = static_cast<std::uint64_t>((i + 1000) * 4000 + (j + 1000)) * 4000 + (k + 1000);
  return Random(seed ^ (key * 0x9e3779b97f4a7c15u)).in(-1.0, 1.0);
}

/// A ring of a body of revolution, or of a box when `squareness` is high: its middle and half widths.
struct Ring {
  Vec3 middle;
  Vec3 y, z;  ///< half axes
};

/// A closed tube through `rings`, its ends closed by fans, outside out when it runs along y x z; `squareness`
/// 2 is an ellipse.
void addTube(Soup& soup, const std::vector<Ring>& rings, int sides, double squareness) {
  const auto at = [&](const Ring& ring, int side) -> Vec3 {
    const double angle = 2.0 * kPi * (side % sides) / sides, c = std::cos(angle), s = std::sin(angle);
    const double power = 2.0 / squareness;
    return ring.middle + std::copysign(std::pow(std::abs(c), power), c) * ring.y +
           std::copysign(std::pow(std::abs(s), power), s) * ring.z;
  };
  for (int side = 0; side < sides; ++side) {
    soup.add(rings.front().middle, at(rings.front(), side + 1), at(rings.front(), side));
    soup.add(rings.back().middle, at(rings.back(), side), at(rings.back(), side + 1));
    for (std::size_t i = 0; i + 1 < rings.size(); ++i) {
      const Vec3 p = at(rings[i], side), q = at(rings[i], side + 1);
      const Vec3 r = at(rings[i + 1], side), s = at(rings[i + 1], side + 1);
      soup.add(p, q, s);
      soup.add(p, s, r);
    }
  }
}

/// `count` rings from `from` to `to`, with the widths that `width(0..1)` gives as a share of `y` and `z`.
template <typename Width>
std::vector<Ring> taper(const Vec3& from, const Vec3& to, const Vec3& y, const Vec3& z, int count,
                        Width width) {
  std::vector<Ring> rings;
  for (int i = 0; i < count; ++i) {
    const double share = static_cast<double>(i) / (count - 1);
    const double w = width(share);
    rings.push_back({from + share * (to - from), w * y, w * z});
  }
  return rings;
}

double bluntEnds(double share) { return std::min(1.0, 0.55 + 4.0 * std::min(share, 1.0 - share)); }
double straight(double) { return 1.0; }

}  // namespace

MeshPtr noisySphere(int rows, std::uint64_t seed) {
  Random random(seed);
  constexpr int kWaves = 6;
  Vec3 wave[kWaves];
  double phase[kWaves];
  for (int w = 0; w < kWaves; ++w) {
    wave[w] = random.vector(2.0, 8.0);
    phase[w] = random.in(0.0, 2.0 * kPi);
  }
  const double roughness = std::min(0.05, 0.25 * 1.6 / rows);
  const auto at = [&](int i, int j, int k) -> Vec3 {
    const Vec3 unit = Vec3(i, j, k).normalized();
    double radius = 1.0 + roughness * scatter(i, j, k, seed);
    for (int w = 0; w < kWaves; ++w) radius += 0.025 * std::cos(wave[w].dot(unit) + phase[w]);
    return radius * unit;
  };
  Soup soup;
  for (int octant = 0; octant < 8; ++octant) {
    const int x = octant & 1 ? -1 : 1, y = octant & 2 ? -1 : 1, z = octant & 4 ? -1 : 1;
    const auto add = [&](int i0, int j0, int i1, int j1, int i2, int j2) {
      const Vec3 p = at(x * i0, y * j0, z * (rows - i0 - j0)), q = at(x * i1, y * j1, z * (rows - i1 - j1)),
                 r = at(x * i2, y * j2, z * (rows - i2 - j2));
      if (x * y * z > 0) {
        soup.add(p, q, r);
      } else {
        soup.add(p, r, q);
      }
    };
    for (int i = 0; i < rows; ++i) {
      for (int j = 0; i + j < rows; ++j) {
        add(i, j, i + 1, j, i, j + 1);
        if (i + j + 1 < rows) add(i + 1, j, i + 1, j + 1, i, j + 1);
      }
    }
  }
  return soup.mesh("noisy sphere");
}

MeshPtr vehicle() {
  Soup soup;
  const Vec3 y = Vec3::UnitY(), z = Vec3::UnitZ();
  addTube(soup, taper({-3.0, 0, 0}, {2.8, 0, 0}, 1.25 * y, 0.55 * z, 40, bluntEnds), 64, 6.0);
  addTube(soup, taper({-1.4, 0, 0.85}, {1.0, 0, 0.85}, 1.0 * y, 0.4 * z, 30, bluntEnds), 64, 4.0);
  addTube(soup, taper({0.8, 0, 0.95}, {4.0, 0, 1.05}, 0.09 * y, 0.09 * z, 34, straight), 28, 2.0);
  for (const double side : {-1.0, 1.0}) {
    const Vec3 middle = 1.45 * side * y - 0.45 * z;
    addTube(
        soup,
        taper(middle - 3.1 * Vec3::UnitX(), middle + 3.0 * Vec3::UnitX(), 0.3 * y, 0.5 * z, 28, bluntEnds),
        64, 5.0);
    for (int wheel = 0; wheel < 6; ++wheel) {
      const Vec3 hub(-2.4 + 0.95 * wheel, side * 1.6, -0.6);
      addTube(soup, taper(hub - 0.2 * y, hub + 0.2 * y, 0.4 * z, 0.4 * Vec3::UnitX(), 12, straight), 16, 2.0);
    }
  }
  return soup.mesh("vehicle");
}

MeshPtr splinter(std::uint64_t seed) {
  Soup soup;
  Random random(seed);
  const auto jagged = [&](double share) { return random.in(0.6, 1.0) * (0.3 + 2.8 * share * (1.0 - share)); };
  addTube(soup, taper({-0.05, 0, 0}, {0.05, 0, 0}, {0, 0.025, 0}, {0, 0, 0.018}, 30, jagged), 16, 2.0);
  return soup.mesh("splinter");
}

}  // namespace collision_node::report

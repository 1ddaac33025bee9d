/// What must hold between answers for different descriptions of about the same body: triangles in another
/// order, meshes within and around a round shape.
#include <gtest/gtest.h>

#include <cstring>
#include <numeric>

#include "test/impact/any_scene.h"
#include "test/impact/claims.h"

namespace moving {
namespace {

namespace g = collision_node::geometry;

/// The same surface: triangles shuffled, each begun at another corner, vertices in another order.
g::TriangleMesh shuffled(const g::TriangleMesh& mesh, Random& random) {
  const auto shuffle = [&](auto& list) {
    for (std::size_t i = list.size(); i > 1; --i)
      std::swap(list[i - 1], list[static_cast<std::size_t>(random.below(static_cast<int>(i)))]);
  };
  std::vector<std::int32_t> order(mesh.vertices.size());
  std::iota(order.begin(), order.end(), 0);
  shuffle(order);
  std::vector<Vec3> vertices(mesh.vertices.size());
  for (std::size_t i = 0; i < order.size(); ++i)
    vertices[static_cast<std::size_t>(order[i])] = mesh.vertices[i];
  std::vector<Corners> triangles;
  for (const auto& t : mesh.triangles) {
    Corners c;
    const int turn = random.below(3);
    for (int k = 0; k < 3; ++k)
      c[static_cast<std::size_t>(k)] =
          order[static_cast<std::size_t>(t[static_cast<std::size_t>((k + turn) % 3)])];
    triangles.push_back(c);
  }
  shuffle(triangles);
  return g::makeTriangleMesh(std::move(vertices), std::move(triangles), SolidChoice::kAuto, "shuffled");
}

TEST(MetamorphicMeshes, PermutedTrianglesAgreeAndTheSameOrderGivesTheSameBytes) {
  int permuted = 0;
  forAll(1, [&](const Scene& s, const std::vector<PairEvent>& events) {
    const std::vector<PairEvent> again = answer(s);
    ASSERT_EQ(again.size(), events.size());
    for (std::size_t i = 0; i < again.size(); ++i) {
      ASSERT_EQ(std::memcmp(&again[i].toi_lower, &events[i].toi_lower, sizeof(double)), 0);
      ASSERT_EQ(std::memcmp(&again[i].toi_upper, &events[i].toi_upper, sizeof(double)), 0);
      ASSERT_EQ(std::memcmp(again[i].position.data(), events[i].position.data(), 3 * sizeof(double)), 0);
    }
    Random random(kAnySeed + 1, static_cast<int>(events.size()));
    Scene other = s;
    bool meshes = false;
    for (Shapes* shapes : {&other.a, &other.b}) {
      for (PlacedShape& shape : *shapes) {
        auto* mesh = std::get_if<g::Mesh>(&shape.shape);
        if (mesh == nullptr) continue;
        meshes = true;
        mesh->mesh = std::make_shared<g::TriangleMesh>(shuffled(*mesh->mesh, random));
      }
    }
    if (!meshes) return;
    ++permuted;
    const std::vector<PairEvent> said = answer(other);
    const std::string wrong = contradiction(events, said, s.duration(), 0.0, 4 * s.options.time_precision);
    ASSERT_TRUE(wrong.empty()) << wrong << listOf(events) << "permuted:\n" << listOf(said);
    if (events.empty() || said.empty()) return;
    // The first contact is one instant, in both brackets.
    if (events[0].certificate != Certificate::kConfirmed || said[0].certificate != Certificate::kConfirmed)
      return;
    ASSERT_LE(events[0].toi_lower, said[0].toi_upper) << listOf(events) << "permuted:\n" << listOf(said);
    ASSERT_LE(said[0].toi_lower, events[0].toi_upper) << listOf(events) << "permuted:\n" << listOf(said);
  });
  EXPECT_GE(permuted, 150);
}

/// A closed convex surface of revolution about z through rings of (radius, height), ends first and last on
/// the axis.
std::vector<Vec3> rings(const std::vector<std::pair<double, double>>& profile, int around,
                        std::vector<Corners>& triangles) {
  std::vector<Vec3> v = {{0, 0, profile.front().second}};
  for (std::size_t i = 1; i + 1 < profile.size(); ++i) {
    for (int k = 0; k < around; ++k) {
      const double phi = 6.283185307179586 * k / around;
      v.push_back({profile[i].first * std::cos(phi), profile[i].first * std::sin(phi), profile[i].second});
    }
  }
  v.push_back({0, 0, profile.back().second});
  const int inner = static_cast<int>(profile.size()) - 2, top = static_cast<int>(v.size()) - 1;
  const auto at = [&](int ring, int k) { return 1 + ring * around + k % around; };
  for (int k = 0; k < around; ++k) {
    triangles.push_back({0, at(0, k + 1), at(0, k)});
    for (int i = 0; i + 1 < inner; ++i) {
      triangles.push_back({at(i, k), at(i, k + 1), at(i + 1, k + 1)});
      triangles.push_back({at(i, k), at(i + 1, k + 1), at(i + 1, k)});
    }
    triangles.push_back({at(inner - 1, k), at(inner - 1, k + 1), top});
  }
  return v;
}

/// How far the shape, a sphere, capsule or cylinder, reaches along n.
double reachAlong(const g::Shape& shape, const Vec3& n) {
  if (const auto* s = std::get_if<g::Sphere>(&shape)) return s->radius;
  if (const auto* c = std::get_if<g::Capsule>(&shape)) return c->radius + 0.5 * c->length * std::abs(n.z());
  const auto& c = std::get<g::Cylinder>(shape);
  return c.radius * std::hypot(n.x(), n.y()) + 0.5 * c.length * std::abs(n.z());
}

/// A mesh within the shape, and the same one grown until it holds the shape.
struct Around {
  PlacedShape within, around;
};

Around meshesOf(const PlacedShape& placed, int around) {
  std::vector<std::pair<double, double>> profile;
  const auto caps = [&](double radius, double half) {
    for (int i = 0; i <= 8; ++i) {
      const double phi = -1.5707963267948966 + 3.141592653589793 * i / 8;
      if (i == 4 && half > 0) profile.push_back({radius, -half});
      profile.push_back(
          {radius * std::cos(phi), radius * std::sin(phi) + (i < 4 || (i == 4 && half == 0) ? -half : half)});
    }
  };
  if (const auto* s = std::get_if<g::Sphere>(&placed.shape)) caps(s->radius, 0);
  if (const auto* c = std::get_if<g::Capsule>(&placed.shape)) caps(c->radius, 0.5 * c->length);
  if (const auto* c = std::get_if<g::Cylinder>(&placed.shape)) {
    const double h = 0.5 * c->length;
    profile = {{0, -h}, {c->radius, -h}, {c->radius, h}, {0, h}};
  }
  std::vector<Corners> triangles;
  std::vector<Vec3> v = rings(profile, around, triangles);
  double grow = 1;
  for (const Corners& t : triangles) {
    const Vec3 p = v[static_cast<std::size_t>(t[0])];
    const Vec3 n =
        (v[static_cast<std::size_t>(t[1])] - p).cross(v[static_cast<std::size_t>(t[2])] - p).normalized();
    grow = std::max(grow, reachAlong(placed.shape, n) / n.dot(p));
  }
  const auto made = [&](double by) {
    std::vector<Vec3> scaled = v;
    for (Vec3& x : scaled) x *= by;
    PlacedShape shape = mesh(scaled, triangles);
    shape.origin = placed.origin;
    return shape;
  };
  return {made(1 - 1e-12), made(grow * (1 + 1e-12))};
}

TEST(MetamorphicMeshes, MeshesWithinRoundShapesTouchLaterAndThoseAroundThemEarlier) {
  constexpr fuzz::ShapeKind kRound[] = {fuzz::ShapeKind::kSphere, fuzz::ShapeKind::kCapsule,
                                        fuzz::ShapeKind::kCylinder};
  int later = 0, earlier = 0, tried = 0;
  for (const fuzz::ShapeKind kind : kRound) {
    for (int other = 0; other < fuzz::kShapeKinds; ++other) {
      for (const Way way : kWays) {
        for (int round = 0; round < 2; ++round) {
          const Scene s = makeScene(kind, static_cast<fuzz::ShapeKind>(other), way, 50 + round);
          if (s.a.size() > 1) continue;
          SCOPED_TRACE("seed " + std::to_string(kAnySeed) + ", " + s.name);
          const Around meshes = meshesOf(s.a[0], 10 + 7 * round);
          const std::vector<PairEvent> events = answer(s);
          Scene small = s, large = s;
          small.a = {meshes.within}, large.a = {meshes.around};
          const std::vector<PairEvent> within = answer(small), around = answer(large);
          ++tried;
          const auto sure = [](const std::vector<PairEvent>& list) {
            return !list.empty() && list[0].certificate == Certificate::kConfirmed;
          };
          const auto text = [&] {
            return "within:\n" + listOf(within) + "shape:\n" + listOf(events) + "around:\n" + listOf(around);
          };
          if (sure(within)) {
            ASSERT_FALSE(events.empty()) << text();
            ASSERT_LE(events[0].toi_lower, within[0].toi_upper) << text();
            later += events[0].toi_upper < within[0].toi_lower;
          }
          if (sure(events)) {
            ASSERT_FALSE(around.empty()) << text();
            ASSERT_LE(around[0].toi_lower, events[0].toi_upper) << text();
            earlier += around[0].toi_upper < events[0].toi_lower;
          }
        }
      }
    }
  }
  std::printf("%d of %d strictly later within, %d strictly earlier around\n", later, tried, earlier);
  EXPECT_GE(later, tried / 5);
  EXPECT_GE(earlier, tried / 5);
}

}  // namespace
}  // namespace moving

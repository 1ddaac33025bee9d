#include <array>
#include <cmath>

#include "collision_node/report/made_meshes.h"
#include "collision_node/report/scenes/building.h"
#include "collision_node/report/scenes/scenes.h"

namespace collision_node::report {
namespace {

using geometry::Pose;
using geometry::Quat;
using geometry::Vec3;
using Real = long double;

constexpr Real kRealUnit = 5.5e-20L;  // half an ulp of 1

Truth apart() {
  Truth truth;
  truth.verdict = Verdict::kClear;
  return truth;
}

/// `error` is what the closed form itself may be off [s]; a double cannot say it better than to its last bit.
Truth hitAt(Real toi, Real error) {
  Truth truth;
  truth.verdict = Verdict::kHit;
  truth.toi = static_cast<double>(toi);
  truth.toi_error = static_cast<double>(error) + 0x1p-53 * truth.toi;
  return truth;
}

/// 1e-2 to 1e-10 m, as often one side as the other.
double anyDepth(Random& random) {
  const double exponent = random.in(-10.0, -2.0), side = random.in(-1.0, 1.0);
  return std::copysign(std::pow(10.0, exponent), side);
}

MeshPtr octahedron(const Vec3& low, const Vec3& high) {
  const std::vector<Vec3> corners = {{low.x(), 0, 0},  {high.x(), 0, 0}, {0, low.y(), 0},
                                     {0, high.y(), 0}, {0, 0, low.z()},  {0, 0, high.z()}};
  std::vector<std::array<std::int32_t, 3>> faces;
  for (int octant = 0; octant < 8; ++octant) {
    const int x = octant & 1, y = octant >> 1 & 1, z = octant >> 2 & 1;
    std::array<std::int32_t, 3> face = {x, 2 + y, 4 + z};
    if ((x + y + z) % 2 == 0) std::swap(face[1], face[2]);
    faces.push_back(face);
  }
  return std::make_shared<geometry::TriangleMesh>(
      geometry::makeTriangleMesh(corners, faces, geometry::SolidChoice::kAuto, "octahedron"));
}

/// A plate of `half` metres to each side, its upper face z = 0, in 2 rows^2 triangles above.
MeshPtr plate(double half, double thick, int rows) {
  std::vector<Vec3> corners;
  std::vector<std::array<std::int32_t, 3>> faces;
  const auto quad = [&](const Vec3& p, const Vec3& q, const Vec3& r, const Vec3& s) {
    const auto first = static_cast<std::int32_t>(corners.size());
    corners.insert(corners.end(), {p, q, r, s});
    faces.push_back({first, first + 1, first + 2});
    faces.push_back({first, first + 2, first + 3});
  };
  const auto at = [&](int i) { return half * (2.0 * i / rows - 1.0); };
  for (int i = 0; i < rows; ++i) {
    const double a = at(i), b = at(i + 1);
    for (int j = 0; j < rows; ++j) {
      const double c = at(j), d = at(j + 1);
      quad({a, c, 0}, {b, c, 0}, {b, d, 0}, {a, d, 0});
      quad({a, d, -thick}, {b, d, -thick}, {b, c, -thick}, {a, c, -thick});
    }
    quad({a, -half, -thick}, {b, -half, -thick}, {b, -half, 0}, {a, -half, 0});
    quad({a, half, 0}, {b, half, 0}, {b, half, -thick}, {a, half, -thick});
    quad({-half, a, 0}, {-half, b, 0}, {-half, b, -thick}, {-half, a, -thick});
    quad({half, a, -thick}, {half, b, -thick}, {half, b, 0}, {half, a, 0});
  }
  return std::make_shared<geometry::TriangleMesh>(
      geometry::makeTriangleMesh(corners, faces, geometry::SolidChoice::kAuto, "plate"));
}

/// |start + t way| = reach for the first time in [0, duration], start outside. Written so that nothing
/// cancels where the path grazes: with n the normal part of `start`, reach^2 - |n|^2 = (reach - |n|)(reach +
/// |n|).
Truth firstAtReach(const Vec3& start, const Vec3& way, Real reach, Real duration) {
  Real dot = 0, way2 = 0, cross2 = 0;
  for (int k = 0; k < 3; ++k)
    dot += static_cast<Real>(start[k]) * way[k], way2 += static_cast<Real>(way[k]) * way[k];
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    const Real c = static_cast<Real>(start[i]) * way[j] - static_cast<Real>(start[j]) * way[i];
    cross2 += c * c;
  }
  const Real aside = std::sqrt(cross2 / way2), depth = reach - aside;
  if (depth <= 0 || dot >= 0) return apart();
  const Real half = std::sqrt(depth * (reach + aside) / way2);
  const Real toi = -dot / way2 - half;
  if (toi > duration) return apart();
  // `aside` is good to a few roundings of |start|: so is depth, and half's share of that error is 1 / (2
  // depth).
  const Real size = start.norm();
  return hitAt(toi, 20 * kRealUnit * (size * half / depth + size / std::sqrt(way2)));
}

}  // namespace

Trials grazingSpheres(std::size_t count) {
  constexpr double kBig = 1.0, kSmall = 0.125;
  Trials trials{"grazing_spheres", "two spheres that pass 1e-2 to 1e-10 m deep or apart, 100 m/s", {}, {}};
  addBody(trials.set, geometry::Sphere{kBig});
  addBody(trials.set, geometry::Sphere{kSmall});
  Random random(7001);
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 velocity = random.vector(100.0, 100.0);
    const Vec3 aside = random.across(velocity, 1.0, 1.0);
    const Vec3 start = (kBig + kSmall - anyDepth(random)) * aside - random.in(0.3, 0.7) / 30.0 * velocity;
    trials.set.queries.push_back(query(0, 1, flight(Pose(), Vec3::Zero(), kFrame),
                                       flight({start, Quat::Identity()}, velocity, kFrame), kFrame));
    Truth truth = firstAtReach(start, velocity, static_cast<Real>(kBig) + kSmall, 1e-9L * kFrame);
    if (truth.verdict == Verdict::kHit) {
      truth.point = kBig * (start + truth.toi * velocity).normalized();
      truth.point_error = 100.0 * truth.toi_error + 1e-15;
    }
    trials.truths.push_back(truth);
  }
  return trials;
}

Trials grazingTip(std::size_t count) {
  Trials trials{"grazing_tip",
                "the tip of a turning mesh, 1e-2 to 1e-10 m into or over a plate of 960 triangles",
                {},
                {}};
  addBody(trials.set, geometry::Mesh{plate(2.0, 0.5, 20)});
  addBody(trials.set, geometry::Mesh{octahedron({-0.3, -0.1, -0.1}, {1.0, 0.1, 0.1})});
  Random random(7101);
  for (std::size_t i = 0; i < count; ++i) {
    // The tip (1, 0, 0) goes down by sin(angle); it is in contact from sin(angle) = height on.
    const double height = 1.0 - anyDepth(random), spin = random.in(3.0, 20.0), early = random.in(0.6, 1.2);
    const double half = 0.5 * (1.5707963267948966 - early);
    const Quat q0(std::cos(half), 0.0, std::sin(half), 0.0);
    const Vec3 place(random.in(-0.5, 0.5), random.in(-0.5, 0.5), 0.0), common = random.vector(0.0, 20.0);
    const auto duration = static_cast<motion::Nanoseconds>(1.4 / spin * 1e9);
    trials.set.queries.push_back(
        query(0, 1, flight({place - height * Vec3::UnitZ(), Quat::Identity()}, common, duration),
              flight({place, q0}, common, duration, spin * Vec3::UnitY()), duration));
    const Real depth = 1 - static_cast<Real>(height);
    if (depth <= 0) {
      trials.truths.push_back(apart());
      continue;
    }
    const Real quarter = std::acos(-1.0L) / 2, lead = 2 * std::asin(std::sqrt(depth / 2));
    const Real toi =
        (quarter - lead - 2 * std::atan2(static_cast<Real>(q0.y()), static_cast<Real>(q0.w()))) / spin;
    Truth truth = hitAt(toi, 10 * kRealUnit / spin);
    const double angle = static_cast<double>(quarter - lead);
    truth.point = place + truth.toi * common + Vec3(std::cos(angle), 0.0, -height);
    truth.point_error = 1e-15 * (1.0 + truth.point.norm()) + 20.0 * truth.toi_error;
    trials.truths.push_back(truth);
  }
  return trials;
}

Trials sliding(std::size_t count) {
  Trials trials{"sliding",
                "a box over a plate, parallel faces, 10 m/s along and 1e-1 to 1e-5 m/s down or level",
                {},
                {}};
  addBody(trials.set, geometry::Box{{4.0, 4.0, 0.25}});
  addBody(trials.set, geometry::Box{{0.5, 0.5, 0.5}});
  Random random(7201);
  const motion::Nanoseconds duration = kSecond / 10;
  for (std::size_t i = 0; i < count; ++i) {
    const double sink = std::pow(10.0, random.in(-5.0, -1.0)), meets = random.in(0.03, 0.09);
    const double round = random.in(0.0, 6.28);
    const bool level = random.in(0.0, 1.0) < 0.4;
    const double z = 0.375 + sink * meets;
    const Vec3 start(random.in(-0.7, 0.7), random.in(-0.7, 0.7), z);
    const Vec3 velocity(10.0 * std::cos(round), 10.0 * std::sin(round), level ? 0.0 : -sink);
    trials.set.queries.push_back(query(0, 1, flight(Pose(), Vec3::Zero(), duration),
                                       flight({start, Quat::Identity()}, velocity, duration), duration));
    const Real gap = static_cast<Real>(z) - 0.375L;  // both heights are exact doubles
    trials.truths.push_back(level ? apart() : hitAt(gap / sink, 4 * kRealUnit * gap / sink));
  }
  return trials;
}

}  // namespace collision_node::report

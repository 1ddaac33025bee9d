/// contact_proof.h: "true only if the elements are within contact_distance of each other in exact arithmetic
/// of the loaded geometry and the motion model", at the instant, throughout, or at some time of an interval.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <optional>

#include "collision_node/impact/proof/contact_proof.h"
#include "collision_node/impact/proof/passage_proof.h"
#include "test/impact/moving_pair.h"

namespace collision_node::impact {
namespace {

using moving::Corners;
using moving::Nanoseconds;
using moving::Random;
using moving::RigidMotion;
using oracle::Real;
using oracle::V3;

constexpr std::uint64_t kSeed = 77002;

geometry::PlacedShape randomShape(Random& random, double size) {
  const auto length = [&] { return size * random.decade(-1, 0); };
  switch (random.below(6)) {
    case 0:
      return moving::placed(geometry::Sphere{length()});
    case 1:
      return moving::placed(geometry::Capsule{length(), length()});
    case 2:
      return moving::placed(geometry::Box{{length(), length(), length()}});
    case 3:
      return moving::placed(geometry::Cylinder{length(), length()});
    default:
      return moving::mesh(
          {moving::randomVec(random, size), moving::randomVec(random, size), moving::randomVec(random, size)},
          {{0, 1, 2}});
  }
}

/// Extended precision ends somewhere: what it cannot tell from zero.
Real resolution(const moving::Pair& pair) {
  return pair.exact.hasTwoCylinders() ? 1e-12L * pair.exact.scale() : pair.exact.touchDistance();
}

struct Looked {
  moving::Pair pair;
  Vec3 buffer_a[3], buffer_b[3];
  Element a, b;

  Looked(const moving::Shapes& sa, const moving::Shapes& sb, const Piece& piece, double contact_distance)
      : pair(sa, sb, piece, contact_distance),
        a(pair.body_a.element(0, buffer_a)),
        b(pair.body_b.element(0, buffer_b)) {}

  bool touches(const Instant& now, ContactWitness& witness) const {
    return touchesAt(pair.solver, now, a, b, closestPoints(Cores(now, a, b), Vec3::Zero()), witness);
  }
};

/// Moves b to where the two just touch, give or take the rounding: there a sloppy proof would fail.
void pushToTouch(Random& random, const moving::Shapes& a, const moving::Shapes& b, Piece& piece, double at,
                 double size) {
  const Vec3 from = piece.b.c[0], along = random.direction();
  double touching = 0.0, apart = 8.0 * size;
  for (int k = 0; k < 52; ++k) {
    const double mid = 0.5 * (touching + apart);
    piece.b.c[0] = from + mid * along;
    const oracle::Pair pair = oracle::makePair(a, b, piece.a, piece.b, piece.start_ns, piece.end_ns);
    (pair.distance(static_cast<Real>(at) * pair.duration()) == 0 ? touching : apart) = mid;
  }
  const double hair = (random.chance(0.3) ? -1 : 1) * size * random.decade(-16, -9);
  piece.b.c[0] = from + (touching + hair) * along;
}

TEST(ContactProof, WhatIsSaidToTouchTouches) {
  Random random(kSeed, 0);
  int said = 0, deep = 0, deep_said = 0;
  for (int i = 0; i < 4000; ++i) {
    const double size = random.decade(-2, 2), at = random.unit();
    const moving::Shapes a = {randomShape(random, size)}, b = {randomShape(random, size)};
    Piece piece = moving::randomPiece(random, size, fuzz::pointOf(random, a[0].shape),
                                      fuzz::pointOf(random, b[0].shape), at,
                                      size * random.decade(-15, 0) * random.direction());
    if (random.chance(0.6)) pushToTouch(random, a, b, piece, at, size);
    const double contact_distance = random.chance(0.2) ? size * random.decade(-9, -1) : 0.0;
    const Looked look(a, b, piece, contact_distance);
    const double t = at * look.pair.solver.motion.duration();
    const Real distance = look.pair.exact.distance(t);
    ContactWitness witness;
    const bool touches = look.touches(look.pair.solver.at(t), witness);
    said += touches;
    if (touches) {
      ASSERT_LE(distance, contact_distance + resolution(look.pair)) << "seed " << kSeed << " case " << i;
    }
    // Deep: they touch still when moved by a millionth of their size in any of six directions.
    if (distance > 0) continue;
    bool still = true;
    for (int k = 0; k < 6 && still; ++k) {
      Piece pushed = piece;
      pushed.b.c[0] += (k % 2 ? 1e-6 : -1e-6) * size * Vec3::Unit(k / 2);
      still = oracle::makePair(a, b, pushed.a, pushed.b, pushed.start_ns, pushed.end_ns).distance(t) == 0;
    }
    deep += still;
    deep_said += still && touches;
  }
  std::printf("%d contacts proved; %d of %d deep ones\n", said, deep_said, deep);
  EXPECT_GT(said, 1200);
  EXPECT_GT(deep_said, 0.98 * deep) << "not a guarantee, but the solver would confirm nothing";
}

TEST(ContactProof, AFeatureThatIsSaidToReachIntoTheOtherTouchesIt) {
  // "a known feature of one of them reaches into the other": two that are apart are moved together along
  // their closest vector, to within rounding of touching or a hair through it.
  Random random(kSeed, 7);
  int said = 0, deep = 0, deep_said = 0;
  for (int i = 0; i < 3000; ++i) {
    const double size = random.decade(-2, 2), at = random.unit();
    const auto solid = [&]() -> geometry::PlacedShape {
      const auto length = [&] { return size * random.decade(-1, 0); };
      geometry::PlacedShape out;
      out.source = "random";
      out.origin = {moving::randomVec(random, random.chance(0.5) ? 0.0 : size), random.orientation()};
      if (random.chance(0.5)) {
        out.shape = geometry::Box{{length(), length(), length()}};
      } else {
        out.shape = geometry::Cylinder{length(), length()};
      }
      return out;
    };
    const moving::Shapes a = {solid()}, b = {solid()};
    Piece piece =
        moving::randomPiece(random, size, Vec3::Zero(), Vec3::Zero(), at, 8.0 * size * random.direction());
    const Looked apart(a, b, piece, 0.0);
    const Instant far = apart.pair.solver.at(at * apart.pair.solver.motion.duration());
    const Vec3 between = closestPoints(Cores(far, apart.a, apart.b), Vec3::Zero()).v;
    const double budget = apart.pair.solver.point_error;
    const double depth = (random.chance(0.2) ? -1.0 : 1.0) * budget * random.decade(-1, 6);
    piece.b.c[0] -= between + depth * between.normalized();
    const Looked look(a, b, piece, 0.0);
    const double t = at * look.pair.solver.motion.duration();
    const Instant now = look.pair.solver.at(t);
    Instant before = now;
    before.d += (std::abs(depth) + 1e-9 * size) * between.normalized();
    const Closest closest = closestPoints(Cores(before, look.a, look.b), between);
    if (closest.overlap) continue;
    const Vec3 direction = closest.v.normalized();
    ContactWitness witness;
    const bool touches = touchesSliding(look.pair.solver, now, look.a, look.b, closest,
                                        random.chance(0.9) ? &direction : nullptr, witness);
    said += touches;
    if (touches) {
      ASSERT_LE(look.pair.exact.distance(t), resolution(look.pair)) << "seed " << kSeed << " case " << i;
    }
    const bool is_deep = depth > 1e3 * budget;
    deep += is_deep;
    deep_said += is_deep && touches;
  }
  std::printf("%d contacts proved; %d of %d deeper ones\n", said, deep_said, deep);
  EXPECT_GT(said, 1000);
  EXPECT_GT(deep_said, 0.7 * deep) << "not a guarantee, but without it each contact is searched for";
}

TEST(ContactProof, WhatIsSaidToTouchThroughoutTouchesAtFiftyTimes) {
  Random random(kSeed, 1);
  int said = 0;
  for (int i = 0; i < 1200; ++i) {
    const double size = random.decade(-2, 2), at = random.in(0, 0.9);
    const moving::Shapes a = {randomShape(random, size)}, b = {randomShape(random, size)};
    const Piece piece = moving::randomPiece(random, size, fuzz::pointOf(random, a[0].shape),
                                            fuzz::pointOf(random, b[0].shape), at, Vec3::Zero());
    const Looked look(a, b, piece, random.chance(0.2) ? size * random.decade(-6, -1) : 0.0);
    const double duration = look.pair.solver.motion.duration();
    double t = at * duration;
    Instant from = look.pair.solver.at(t);
    ContactWitness witness;
    if (!look.touches(from, witness)) continue;
    // "If so, it holds them at `to`": so one interval follows the other.
    for (int leg = 0; leg < 3 && t < duration; ++leg) {
      double span = duration - t, share = 0.0;
      Instant to = from;
      while (span > 1e-9 * duration) {
        to = look.pair.solver.at(t + span);
        if (touchesThrough(look.pair.solver, from, to, look.a, look.b, witness, share)) break;
        ASSERT_TRUE(share > 0.0 && share < 1.0) << share;
        span *= std::clamp(share, 0.1, 0.9);
      }
      if (!(span > 1e-9 * duration)) break;
      ++said;
      for (int k = 0; k <= 50; ++k) {
        const Real u = t + static_cast<Real>(span) * k / 50;
        ASSERT_LE(look.pair.exact.distance(u), look.pair.solver.contact_distance + resolution(look.pair))
            << "seed " << kSeed << " case " << i << " leg " << leg << " share " << k << "/50 of " << span
            << " s";
      }
      t += span;
      from = to;
    }
  }
  std::printf("%d intervals of contact proved\n", said);
  EXPECT_GT(said, 900);
}

/// Triangles around the origin whose inner corner is shared: a fan that is a graph over z = 0.
TrianglePatch randomPatch(Random& random, double size, int count) {
  TrianglePatch patch;
  const auto corner = [&] { return Vec3(0, 0, size * random.in(-0.2, 0.2)); };
  if (count < 3) {  // one triangle, or two on an edge
    const Vec3 p = size * Vec3(random.in(-1, -0.3), 0, 0) + corner();
    const Vec3 q = size * Vec3(random.in(0.3, 1), 0, 0) + corner();
    for (int k = 0; k < count; ++k) {
      const Vec3 r = size * Vec3(random.in(-1, 1), (k == 0 ? 1 : -1) * random.in(0.3, 1), 0) + corner();
      patch.push_back(k == 0 || random.chance(0.5) ? std::array<Vec3, 3>{p, q, r}
                                                   : std::array<Vec3, 3>{q, p, r});
    }
    return patch;
  }
  std::vector<Vec3> rim;
  for (int k = 0; k < count; ++k) {
    const double angle = 6.283185307179586 * (k + random.in(-0.2, 0.2)) / count, r = size * random.in(0.3, 1);
    rim.push_back(Vec3(r * std::cos(angle), r * std::sin(angle), 0) + corner());
  }
  const Vec3 middle = corner();
  for (int k = 0; k < count; ++k) {
    std::array<Vec3, 3> t = {middle, rim[k], rim[(k + 1) % count]};
    if (random.chance(0.3)) std::swap(t[1], t[2]);  // wound as a bad exporter winds
    patch.push_back(t);
  }
  return patch;
}

/// Height of p over the patch along z; nothing when p is not over it.
std::optional<Real> heightOver(const TrianglePatch& patch, const V3& p) {
  for (const auto& t : patch) {
    Real area[3], sum = 0;
    for (int k = 0; k < 3; ++k) {
      const V3 u = oracle::exact(t[(k + 1) % 3]) - p, v = oracle::exact(t[(k + 2) % 3]) - p;
      area[k] = u.x * v.y - u.y * v.x;
      sum += area[k];
    }
    if (sum < 0) {
      for (Real& x : area) x = -x;
      sum = -sum;
    }
    if (!(sum > 0) || area[0] < 0 || area[1] < 0 || area[2] < 0) continue;
    return p.z - (area[0] * t[0].z() + area[1] * t[1].z() + area[2] * t[2].z()) / sum;
  }
  return std::nullopt;
}

/// Does the point's exact path cross the patch, seen from sides that 400 samples can tell, its crossing
/// bisected?
bool crosses(const moving::Pair& pair, const TrianglePatch& patch, bool point_is_a, double from, double to) {
  const auto over = [&](Real t) {
    const oracle::Frame fa = pair.exact.pathA().at(t), fb = pair.exact.pathB().at(t);
    const oracle::Frame &tri = point_is_a ? fb : fa, &point = point_is_a ? fa : fb;
    const V3 x = point.position - tri.position;
    return heightOver(patch, {oracle::dot(tri.rotation.column[0], x), oracle::dot(tri.rotation.column[1], x),
                              oracle::dot(tri.rotation.column[2], x)});
  };
  constexpr int kSamples = 400;
  for (int k = 0; k < kSamples; ++k) {
    Real low = from + (static_cast<Real>(to) - from) * k / kSamples;
    Real high = from + (static_cast<Real>(to) - from) * (k + 1) / kSamples;
    std::optional<Real> h_low = over(low), h_high = over(high);
    if (!h_low || !h_high || (*h_low > 0) == (*h_high > 0)) continue;
    bool inside = true;
    for (int i = 0; i < 70 && inside; ++i) {
      const Real mid = (low + high) / 2;
      const std::optional<Real> h = over(mid);
      inside = h.has_value();
      if (inside) ((*h > 0) == (*h_low > 0) ? low : high) = mid;
    }
    if (inside) return true;
  }
  return false;
}

geometry::PlacedShape patchShape(const TrianglePatch& patch) {
  std::vector<Vec3> vertices;
  std::vector<Corners> triangles;
  for (const auto& t : patch) {
    const int base = static_cast<int>(vertices.size());
    vertices.insert(vertices.end(), t.begin(), t.end());
    triangles.push_back({base, base + 1, base + 2});
  }
  return moving::mesh(vertices, triangles);
}

TEST(ContactProof, WhatIsSaidToPassThroughCrosses) {
  Random random(kSeed, 2);
  int said = 0, said_centre = 0;
  for (int i = 0; i < 8000; ++i) {
    const double size = random.decade(-2, 2), at = random.in(0.1, 0.9);
    auto patch = randomPatch(random, size, 1 + random.below(6));
    const bool complete = random.chance(0.8);
    if (!complete && patch.size() > 1) patch.pop_back();  // now the shared corner lies on the border
    // Aim at the shared edge or corner, nearly there, or anywhere; every third path runs flat over the patch.
    Vec3 aim = patch.size() < 3 && complete ? Vec3(0.5 * (patch[0][0] + patch[0][1])) : patch[0][0];
    const bool centre = random.chance(0.5);
    if (!centre) aim += size * random.decade(-12, 0) * random.direction();
    const bool point_is_a = random.chance(0.5);
    const moving::Shapes point = {moving::placed(geometry::Point{})}, tri = {patchShape(patch)};
    const Piece piece = point_is_a ? moving::randomPiece(random, size, Vec3::Zero(), aim, at, Vec3::Zero())
                                   : moving::randomPiece(random, size, aim, Vec3::Zero(), at, Vec3::Zero());
    const moving::Pair pair(point_is_a ? point : tri, point_is_a ? tri : point, piece);
    const double duration = pair.solver.motion.duration(), half = duration * random.decade(-8, -1);
    const double from = at * duration - half * random.unit(), to = at * duration + half * random.unit();
    if (!passesThrough(pair.solver, pair.solver.at(from), pair.solver.at(to), point_is_a, Vec3::Zero(),
                       patch))
      continue;
    ++said;
    said_centre += centre && complete && patch.size() > 1;
    ASSERT_TRUE(crosses(pair, patch, point_is_a, from, to))
        << "seed " << kSeed << " case " << i << ", " << patch.size() << " triangles";
  }
  std::printf("%d passages proved, %d of them through a shared edge or corner\n", said, said_centre);
  EXPECT_GT(said, 2000);
  EXPECT_GT(said_centre, 700);
}

/// A point flies along z past the triangles of `patch` (in A, at rest), from z = 1 to z = -1, at (x, y).
bool passesAt(const TrianglePatch& patch, const Vec3& from, const Vec3& to) {
  const Piece piece{0, 1'000'000, moving::resting(), moving::flight(0, 1'000'000, from, (to - from) / 1e-3)};
  const moving::Pair pair({patchShape(patch)}, {moving::placed(geometry::Point{})}, piece);
  // The bracket of a solver is short: a few nanoseconds around the plane.
  return passesThrough(pair.solver, pair.solver.at(0.0004999), pair.solver.at(0.0005001), false, Vec3::Zero(),
                       patch);
}

TEST(ContactProof, NothingPassesWhereThereIsNoTriangle) {
  const Vec3 p(-1, -1, 0), q(1, -1, 0), r(0, 1, 0), s(0, -3, 0);
  const TrianglePatch one = {{p, q, r}}, two = {{p, q, r}, {q, p, s}};
  EXPECT_TRUE(passesAt(one, {0, 0, 1}, {0, 0, -1}));
  EXPECT_TRUE(passesAt(one, {0, 0, -1}, {0, 0, 1})) << "from behind";
  EXPECT_FALSE(passesAt(one, {0.6, 0.6, 1}, {0.6, 0.6, -1})) << "beside the triangle";
  EXPECT_FALSE(passesAt(one, {0, -1.0001, 1}, {0, -1.0001, -1})) << "just beyond an edge";
  EXPECT_FALSE(passesAt(one, {0, -1, 1}, {0, -1, -1})) << "on the border";
  EXPECT_FALSE(passesAt(one, {0, 0, 1}, {0, 0, 0.1})) << "stays on one side";
  EXPECT_FALSE(passesAt(one, {0, 0, 0}, {0.1, 0, 0})) << "in the plane";
  EXPECT_TRUE(passesAt(two, {0, -1, 1}, {0, -1, -1})) << "through the shared edge";
  EXPECT_FALSE(passesAt(two, {-1, -1, 1}, {-1, -1, -1})) << "through the end of the shared edge";
  EXPECT_FALSE(passesAt({{p, q, r}, {q, p, r}}, {0, -1, 1}, {0, -1, -1})) << "a triangle and its reverse";
  EXPECT_FALSE(passesAt({{p, p, q}}, {0, -1, 1}, {0, -1, -1})) << "no area";
}

/// A way of the point, seen by the surface, that bends: `surface` turns or rests, `carrier` has the point at
/// `offset`. Both last 1 ms; in the middle the point is level with where the surface lies, at z = 0.
struct BentWay {
  const char* why;
  RigidMotion surface, carrier;
  Vec3 offset;
};

std::vector<BentWay> bentWays() {
  constexpr Nanoseconds kEnd = 1'000'000;
  constexpr double kTime = 1e-3, kTurn = 0.4, kLow = 1e-4;  // turns [rad], heights [m]
  const Vec3 sinks(0, 0, -2.0 * kLow / kTime);
  const auto about = [](double angle) {
    return geometry::Quat(std::cos(0.5 * angle), 0, 0, std::sin(0.5 * angle));
  };
  const auto spinning = [&](double turn) {
    return moving::flight(0, kEnd, Vec3::Zero(), Vec3::Zero(), {0, 0, turn / kTime}, about(-0.5 * turn));
  };
  RigidMotion curved = moving::flight(0, kEnd, {0, -1, kLow}, {0.4 / kTime, 2.0 / kTime, sinks.z()});
  curved.c[2].x() = -0.4 / (kTime * kTime);
  RigidMotion wheel = spinning(kTurn);
  wheel.c[0] = {0, 0, kLow};
  wheel.c[1] = sinks;
  const RigidMotion falls = moving::flight(0, kEnd, {0.3, 1, kLow}, sinks),
                    crosses_axis = moving::flight(0, kEnd, {-1, 0, kLow}, {2.0 / kTime, 0, sinks.z()});
  return {{"its own acceleration", moving::resting(), curved, Vec3::Zero()},
          {"the turn of what carries it", moving::resting(), wheel, {0, 0.7, 0}},
          {"the turn of the surface", spinning(kTurn), falls, Vec3::Zero()},
          {"its speed across a surface that turns", spinning(0.1 * kTurn), crosses_axis, Vec3::Zero()}};
}

/// passage_proof.h: "`true` only if it does". A triangle covers both ends of a bent way and all of its chord,
/// but not the middle, where the way goes through the triangle's plane beside its edge.
TEST(ContactProof, WhoseWayBendsPastTheBorderDoesNotPass) {
  for (const BentWay& way : bentWays()) {
    for (const bool point_is_a : {false, true}) {
      SCOPED_TRACE(testing::Message() << way.why << (point_is_a ? ", the point is A" : ", the point is B"));
      const oracle::Path surface(way.surface, 0, {}), carrier(way.carrier, 0, {});
      const auto seen = [&](Real t) -> Vec3 {
        const V3 x = carrier.at(t).place(oracle::exact(way.offset)) - surface.at(t).position;
        const auto& axes = surface.at(t).rotation.column;
        return {static_cast<double>(oracle::dot(axes[0], x)), static_cast<double>(oracle::dot(axes[1], x)),
                0};
      };
      const Vec3 first = seen(0), last = seen(1e-3L);
      // At half the time it is farthest from the chord.
      const Vec3 chord = last - first, across = Vec3(chord.y(), -chord.x(), 0).normalized();
      const double bulge = across.dot(seen(5e-4L) - first);
      const Vec3 out = bulge < 0 ? Vec3(-across) : across;
      ASSERT_GT(std::abs(bulge), 5e-3);
      for (const double share : {0.98, 1.2}) {
        const Vec3 edge = first + share * std::abs(bulge) * out;
        const TrianglePatch patch = {{edge - 9.0 * chord, edge + 9.0 * chord, edge - 20.0 * out}};
        const moving::Shapes point = {moving::placed(geometry::Point{}, way.offset)},
                             tri = {patchShape(patch)};
        const Piece piece{0, 1'000'000, point_is_a ? way.carrier : way.surface,
                          point_is_a ? way.surface : way.carrier};
        const moving::Pair pair(point_is_a ? point : tri, point_is_a ? tri : point, piece);
        const bool passes = passesThrough(pair.solver, pair.solver.at(0.0), pair.solver.at(1e-3), point_is_a,
                                          way.offset, patch);
        EXPECT_EQ(passes, share > 1.0) << "the edge " << share << " bulges from the chord";
      }
    }
  }
}

TEST(ContactProof, NothingTouchesBesideEachOther) {
  const auto touch = [](const geometry::PlacedShape& a, const geometry::PlacedShape& b, const Vec3& d,
                        double contact_distance = 0.0) {
    const Piece piece{0, 1'000'000, moving::resting(), moving::flight(0, 1'000'000, d, Vec3::Zero())};
    const Looked look({a}, {b}, piece, contact_distance);
    ContactWitness witness;
    return look.touches(look.pair.solver.at(0.0), witness);
  };
  const auto sphere = moving::placed(geometry::Sphere{0.5}),
             cylinder = moving::placed(geometry::Cylinder{0.5, 1.0});
  const auto box = moving::placed(geometry::Box{{1, 1, 1}});
  EXPECT_TRUE(touch(sphere, sphere, {0.99, 0, 0}));
  EXPECT_FALSE(touch(sphere, sphere, {1.0 + 1e-12, 0, 0}));
  EXPECT_FALSE(touch(sphere, sphere, {0.7072, 0.7072, 0})) << "boxes overlap, spheres do not";
  EXPECT_TRUE(touch(cylinder, cylinder, {0.99, 0, 0.99}));
  EXPECT_FALSE(touch(cylinder, cylinder, {1.0 + 1e-12, 0, 0}));
  EXPECT_FALSE(touch(cylinder, cylinder, {0, 0, 1.0 + 1e-12}));
  EXPECT_FALSE(touch(cylinder, cylinder, {0.7072, 0.7072, 0}));
  EXPECT_TRUE(touch(box, box, {0.99, 0.99, 0.99}));
  EXPECT_FALSE(touch(box, box, {0, 1.0 + 1e-12, 0}));
  EXPECT_TRUE(touch(sphere, sphere, {1.009, 0, 0}, 0.01));
  EXPECT_FALSE(touch(sphere, sphere, {1.011, 0, 0}, 0.01));
  EXPECT_TRUE(touch(box, box, {0, 1.009, 0}, 0.01));
  EXPECT_FALSE(touch(box, box, {0, 1.011, 0}, 0.01));
  const auto point = moving::placed(geometry::Point{});
  EXPECT_FALSE(touch(point, point, {0, 0, 0})) << "two points: never provable";
}

}  // namespace
}  // namespace collision_node::impact

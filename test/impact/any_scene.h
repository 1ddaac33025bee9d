/// Scenes for what must hold of any pair: every shape against every other under every kind of motion.
#pragma once

#include <gtest/gtest.h>

#include "test/impact/fuzz_object.h"
#include "test/impact/watched_pair.h"

namespace moving {

inline constexpr std::uint64_t kAnySeed = 20261127;

/// Of a, of b: at rest, straight, an arc, many turns, cubic, cubic and turning.
enum class Way { kRest, kStraight, kArc, kTurns, kCubic, kCubicTurns };
inline constexpr Way kWays[] = {Way::kRest,  Way::kStraight, Way::kArc,
                                Way::kTurns, Way::kCubic,    Way::kCubicTurns};

struct Scene {
  Shapes a, b;
  Piece piece;
  PairOptions options;
  std::string name;

  double duration() const { return collision_node::motion::secondsBetween(piece.start_ns, piece.end_ns); }
};

inline RigidMotion motionOf(Random& random, Way way, const Piece& piece, double speed) {
  RigidMotion m;
  if (way == Way::kRest) return collision_node::motion::fixedAt({Vec3::Zero(), random.orientation()});
  const double h = collision_node::motion::secondsBetween(piece.start_ns, piece.end_ns);
  m.start_ns = piece.start_ns - (random.chance(0.5) ? 0 : 7'654'321);
  m.end_ns = piece.end_ns + (random.chance(0.5) ? 0 : 1'234'567);
  m.q0 = random.orientation();
  m.c[1] = speed * random.direction();
  if (way == Way::kCubic || way == Way::kCubicTurns) {
    m.c[2] = random.in(0.2, 1) * speed / h * random.direction();
    m.c[3] = random.in(0.2, 1) * speed / (h * h) * random.direction();
  }
  if (way == Way::kArc) m.omega = random.in(0.1, 3) / h * random.direction();
  if (way == Way::kTurns || way == Way::kCubicTurns) m.omega = random.in(10, 60) / h * random.direction();
  return m;
}

/// The aimed points of both meet during the piece, exactly or a little to the side.
inline Scene makeScene(fuzz::ShapeKind kind_a, fuzz::ShapeKind kind_b, Way way, int round) {
  Random random(
      kAnySeed,
      ((static_cast<int>(kind_a) * 8 + static_cast<int>(kind_b)) * 6 + static_cast<int>(way)) * 100 + round);
  Scene s;
  const fuzz::Object a = fuzz::makeObject(random, kind_a, 1.0),
                     b = fuzz::makeObject(random, kind_b, random.decade(-0.7, 0.3));
  s.a = a.shapes, s.b = b.shapes;
  s.name = a.kind + " - " + b.kind + ", way " + std::to_string(static_cast<int>(way)) + ", round " +
           std::to_string(round);
  s.piece.start_ns = 1'700'000'000'000'000'000;
  s.piece.end_ns = s.piece.start_ns + static_cast<Nanoseconds>(random.decade(7, 9));
  const double reach = std::max(a.reach + b.reach, 0.1), h = s.duration();
  const double speed = reach * random.decade(0.1, 0.8) / h;
  const Way other = kWays[random.below(6)];
  s.piece.a = motionOf(random, other, s.piece, 0.3 * speed);
  s.piece.b =
      motionOf(random, way == Way::kRest && other == Way::kRest ? Way::kStraight : way, s.piece, speed);
  const Real at = h * random.in(0.2, 0.9);
  const oracle::Frame fa = oracle::Path(s.piece.a, s.piece.start_ns, {}).at(at),
                      fb = oracle::Path(s.piece.b, s.piece.start_ns, {}).at(at);
  const double aside = random.chance(0.6) ? 0.0 : reach * random.in(0, 1.2);
  const oracle::V3 shift = fa.place(oracle::exact(a.aim)) - fb.place(oracle::exact(b.aim)) +
                           oracle::exact(Vec3(aside * random.direction()));
  s.piece.b.c[0] =
      Vec3(static_cast<double>(shift.x), static_cast<double>(shift.y), static_cast<double>(shift.z));
  if (random.chance(0.2)) s.options.contact_distance = 0.02 * reach;
  return s;
}

inline std::vector<PairEvent> answer(const Scene& s) {
  Watched pair(s.a, s.b, s.options);
  pair.advance(s.piece);
  pair.finish();
  return pair.events;
}

template <class Check>
void forAll(int rounds, Check&& check) {
  int touching = 0, all = 0;
  for (int i = 0; i < fuzz::kShapeKinds; ++i) {
    for (int j = 0; j < fuzz::kShapeKinds; ++j) {
      for (const Way way : kWays) {
        for (int round = 0; round < rounds; ++round) {
          const Scene s =
              makeScene(static_cast<fuzz::ShapeKind>(i), static_cast<fuzz::ShapeKind>(j), way, round);
          SCOPED_TRACE("seed " + std::to_string(kAnySeed) + ", " + s.name);
          const std::vector<PairEvent> events = answer(s);
          touching += !events.empty();
          ++all;
          check(s, events);
          if (testing::Test::HasFatalFailure()) return;
        }
      }
    }
  }
  EXPECT_GE(touching, all / 3);
}

}  // namespace moving

/// Clean contacts: the same facts from either side, the same bits anywhere in the world, and how narrow the
/// answers are. What else must not change an answer: test_metamorphic.cpp.
#include <gtest/gtest.h>

#include <cstring>

#include "test/impact/fuzz_case.h"
#include "test/impact/watched_pair.h"

namespace collision_node::impact {
namespace {

using moving::flight;
using moving::kFrame;
using moving::kInAndOut;
using moving::Random;
using moving::resting;
using moving::Watched;
using oracle::Real;

constexpr std::uint64_t kSeed = 77006;

/// A random case of the fuzz test whose contacts begin and end cleanly within the piece.
struct Clean {
  fuzz::Case c;
  std::vector<PairEvent> events;
};

std::vector<PairEvent> solve(const moving::Shapes& a, const moving::Shapes& b, const Piece& piece,
                             const PairOptions& options) {
  Watched pair(a, b, options);
  pair.advance(piece);
  pair.finish();
  return pair.events;
}

bool isClean(const std::vector<PairEvent>& events, double duration) {
  if (events.empty() || events.size() % 2 != 0) return false;
  for (std::size_t i = 0; i < events.size(); ++i) {
    if (events[i].certificate != Certificate::kConfirmed) return false;
    if (events[i].kind != (i % 2 == 0 ? Kind::kImpact : Kind::kSeparation)) return false;
    if (events[i].toi_lower < 1e-6 * duration || events[i].toi_upper > (1 - 1e-6) * duration) return false;
    if (moving::widthOf(events[i]) > 1e-6 * duration) return false;
    if (i > 0 && events[i].toi_lower - events[i - 1].toi_upper < 1e-5 * duration) return false;
  }
  return true;
}

template <class Check>
void forCleanCases(std::uint64_t seed, int wanted, Check&& check) {
  int found = 0;
  for (int i = 0; found < wanted && i < 60 * wanted; ++i) {
    const fuzz::Case c = fuzz::makeCase(seed, i);
    if (oracle::makeModel(c.a).only_points || oracle::makeModel(c.b).only_points) continue;
    const std::vector<PairEvent> events = solve(c.a, c.b, c.piece, c.options);
    if (!isClean(events, c.duration())) continue;
    ++found;
    SCOPED_TRACE(c.describe());
    check(Clean{c, events});
    if (testing::Test::HasFatalFailure()) return;
  }
  EXPECT_EQ(found, wanted) << "clean cases, seed " << seed;
}

/// Both brackets hold the same instant, so they overlap.
void expectSameTimes(const PairEvent& x, Real x_lower, Real x_upper, const PairEvent& y) {
  EXPECT_LE(x_lower, y.toi_upper) << toString(x.kind);
  EXPECT_GE(x_upper, y.toi_lower) << toString(x.kind);
}

TEST(CertifiedProperties, SwappingTheBodiesSwapsTheSides) {
  forCleanCases(kSeed, 40, [](const Clean& clean) {
    const fuzz::Case& c = clean.c;
    const Piece piece{c.piece.start_ns, c.piece.end_ns, c.piece.b, c.piece.a};
    const std::vector<PairEvent> swapped = solve(c.b, c.a, piece, c.options);
    ASSERT_EQ(swapped.size(), clean.events.size());
    for (std::size_t i = 0; i < swapped.size(); ++i) {
      const PairEvent &x = swapped[i], &y = clean.events[i];
      ASSERT_EQ(x.kind, y.kind);
      EXPECT_EQ(x.certificate, y.certificate);
      expectSameTimes(x, x.toi_lower, x.toi_upper, y);
      if (!x.multiple && !y.multiple) {
        EXPECT_LE((x.position - y.position).norm(), x.position_error + y.position_error);
      }
      if (!(x.normal_error + y.normal_error < 0.5)) continue;
      EXPECT_LE(std::acos(std::clamp(-x.normal.dot(y.normal), -1.0, 1.0)),
                x.normal_error + y.normal_error + 1e-7);
    }
  });
}

bool sameBits(double x, double y) { return std::memcmp(&x, &y, sizeof x) == 0; }

TEST(CertifiedProperties, AnExactWorldOffsetGivesIdenticalBits) {
  // "A common offset cancels before it can round": 2^24 m, positions on a grid of 2^-20 m.
  forCleanCases(kSeed + 3, 30, [](const Clean& clean) {
    fuzz::Case c = clean.c;
    const Vec3 first = c.piece.a.c[0];
    for (auto* m : {&c.piece.a, &c.piece.b}) {
      m->c[0] = ((m->c[0] - first) * 0x1p20).array().round().matrix() * 0x1p-20;
    }
    const std::vector<PairEvent> here = solve(c.a, c.b, c.piece, c.options);
    const Vec3 offset(0x1p24, -0x1p24, 0x1p23);
    for (auto* m : {&c.piece.a, &c.piece.b}) m->c[0] += offset;
    const std::vector<PairEvent> there = solve(c.a, c.b, c.piece, c.options);
    ASSERT_EQ(here.size(), there.size());
    for (std::size_t i = 0; i < here.size(); ++i) {
      const PairEvent &x = here[i], &y = there[i];
      EXPECT_EQ(x.kind, y.kind);
      EXPECT_EQ(x.certificate, y.certificate);
      EXPECT_TRUE(sameBits(x.toi_lower, y.toi_lower) && sameBits(x.toi_upper, y.toi_upper));
      EXPECT_TRUE(sameBits(x.normal_error, y.normal_error));
      for (int k = 0; k < 3; ++k) {
        EXPECT_TRUE(sameBits(x.normal[k], y.normal[k]));
        EXPECT_TRUE(sameBits(x.a.point[k], y.a.point[k]));
        EXPECT_TRUE(sameBits(x.b.point[k], y.b.point[k]));
      }
      // The witness is in the world, where it has to round.
      EXPECT_LE((y.position - offset - x.position).norm(), 1e-8);
    }
  });
}

TEST(CertifiedProperties, CleanHitsAtTwoKilometresASecondAreNarrow) {
  // Width <= precision.time = 1e-9 s and ball <= precision.distance = 1e-6 m for vertex/face and sphere/face
  // hits.
  Random random(kSeed, 0);
  double widest = 0, largest = 0;
  for (int i = 0; i < 300; ++i) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + " case " + std::to_string(i));
    const bool vertex = random.chance(0.5);
    const moving::Shapes b = {vertex ? moving::boxMesh({0.05, 0.04, 0.03})
                                     : moving::placed(geometry::Sphere{0.05})};
    const geometry::PlacedShape a =
        random.chance(0.5) ? moving::boxMesh({1, 1, 1}) : moving::placed(geometry::Box{{2, 2, 2}});
    const Vec3 down = (Vec3(0, 0, -1) + moving::randomVec(random, 0.2)).normalized();
    // Turned so that one corner is clearly lowest.
    const geometry::Quat turn = geometry::Quat::FromTwoVectors(
        Vec3(0.05, 0.04, 0.03), Vec3(0, 0, -1) + moving::randomVec(random, 0.1));
    const auto m = flight(0, kFrame, Vec3(random.in(-0.3, 0.3), random.in(-0.3, 0.3), 0) - 30.0 * down,
                          2000.0 * down, random.in(0, 3) * random.direction(), turn);
    Watched pair({a}, b);
    pair.advance(0, kFrame, resting(), m);
    ASSERT_GE(pair.events.size(), 1u);
    const PairEvent& e = pair.events[0];
    ASSERT_EQ(e.kind, Kind::kImpact);
    ASSERT_EQ(e.certificate, Certificate::kConfirmed) << pair.list();
    EXPECT_EQ(e.reason, Reason::kNone) << pair.list();
    EXPECT_LE(moving::widthOf(e), 1e-9) << pair.list();
    EXPECT_LE(e.position_error, 1e-6) << pair.list();
    EXPECT_EQ(e.a.feature, Feature::kFace) << pair.list();
    EXPECT_EQ(e.b.feature, vertex ? Feature::kVertex : Feature::kSmooth) << pair.list();
    EXPECT_NEAR(e.normal.z(), 1.0, 1e-6 + e.normal_error);
    widest = std::max(widest, moving::widthOf(e));
    largest = std::max(largest, e.position_error);
  }
  std::printf("widest bracket %.3g s, largest ball %.3g m\n", widest, largest);
}

TEST(CertifiedProperties, TheOwnSpinOfAPointAddsNothingToBallAndCone) {
  // solver.md, "The ball": "the point's own spin moves nothing". Slow, so that a bracket of 1 ns is open for
  // a quarter of a milliradian of its turn.
  const double spin = 2.5e5;
  const auto capsule = moving::placed(geometry::Capsule{0.02, 0.05});
  const auto point = moving::placed(geometry::Point{});
  for (const bool swapped : {false, true}) {
    double ball[2], cone[2];
    for (const bool spins : {false, true}) {
      const Piece fall{0, kFrame, resting(),
                       flight(0, kFrame, {0.004, 0.003, 0.05}, {0, 0, -0.6}, {spins ? spin : 0.0, 0.0, 0.0})};
      const Piece piece = swapped ? Piece{fall.start_ns, fall.end_ns, fall.b, fall.a} : fall;
      Watched pair({swapped ? point : capsule}, {swapped ? capsule : point});
      pair.advance(piece);
      ASSERT_FALSE(pair.events.empty());
      ASSERT_EQ(pair.events[0].kind, Kind::kImpact) << pair.list();
      ASSERT_EQ(pair.events[0].certificate, Certificate::kConfirmed) << pair.list();
      ball[spins] = pair.events[0].position_error;
      cone[spins] = pair.events[0].normal_error;
    }
    EXPECT_LE(ball[true], 1.01 * ball[false]) << (swapped ? "point first" : "point second");
    EXPECT_LE(cone[true], 1.01 * cone[false]) << (swapped ? "point first" : "point second");
  }
}

TEST(Certified, APassageBesideAnEdgeThatSpinsIsProved) {
  // Two triangles of 5e-5 m turn in their plane at 1800 rad/s, and both fly so fast that a budget is 5e-10 m:
  // while a point comes through by some budgets, the edge between them goes by a hundred, but straight on.
  constexpr Nanoseconds kFrom = -600'000'000, kStart = 0, kEnd = 350'000'000;
  constexpr double kSize = 2.6e-5, kSpin = 1800, kSpeed = 0.0148, kMeet = 0.1;
  const geometry::PlacedShape sheet =
      moving::mesh({{-kSize, 0, 0}, {kSize, 0, 0}, {0, kSize, 0}, {0, -kSize, 0}}, {{0, 1, 2}, {1, 0, 3}});
  const Vec3 both(20000, -7000, 4000);
  const double since = kMeet - 1e-9 * static_cast<double>(kFrom);
  for (double beside = 3e-9; beside < 1e-5; beside *= 1.3) {
    const auto turns = flight(kFrom, kEnd, Vec3::Zero(), both, {0, 0, kSpin},
                              geometry::Quat(Eigen::AngleAxisd(-kSpin * since, Vec3::UnitZ())));
    const auto falls = flight(kFrom, kEnd, {0.4 * kSize, beside, kSpeed * since}, both - Vec3(0, 0, kSpeed));
    Watched pair({sheet}, {moving::placed(geometry::Point{})});
    pair.advance(kStart, kEnd, turns, falls);
    EXPECT_EQ(pair.story(), "IMPACT CONFIRMED, SEPARATION CONFIRMED") << beside << '\n' << pair.list();
  }
}

TEST(Certified, WhoPassesASurfaceKnowsOnWhichSideHoweverFineTheBracket) {
  // A point through a triangle that turns: with a bracket near the rounding, its passage is proved from a
  // little farther on. What parted the two before still tells the side.
  constexpr Nanoseconds kSecond = 1'000'000'000;
  const geometry::PlacedShape sheet = moving::mesh({{-1, -1, 0.1}, {1, -1, 0.1}, {0, 1, 0.1}}, {{0, 1, 2}});
  Random random(kSeed, 0);
  for (const double precision : {1e-9, 1e-13}) {
    PairOptions options;
    options.time_precision = precision;
    int passages = 0;
    for (int i = 0; i < 100; ++i) {
      const Vec3 toward(random.in(-0.5, 0.5), random.in(-0.3, 0.3), random.in(-0.3, 0.3));
      const Vec3 way = 3.0 * Vec3(random.in(-1, 1), random.in(-1, 1), random.in(-1, 1)).normalized();
      const Vec3 omega = 30.0 * Vec3(random.in(-1, 1), random.in(-1, 1), random.in(-1, 1));
      Watched pair({sheet}, {moving::placed(geometry::Point{})}, options);
      pair.advance(0, kSecond, flight(0, kSecond, Vec3::Zero(), Vec3::Zero(), omega),
                   flight(0, kSecond, toward - way, 2.0 * way));
      for (const PairEvent& e : pair.events) {
        if (e.certificate != Certificate::kConfirmed) continue;
        ++passages;
        EXPECT_LT(e.normal_error, 1e-3) << precision << ' ' << i << '\n' << pair.list();
      }
    }
    EXPECT_GT(passages, 100);
  }
}

}  // namespace
}  // namespace collision_node::impact

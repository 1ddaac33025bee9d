/// The whole solver against rational arithmetic: a point, a segment or a triangle under pure translation
/// against a triangle. The bits of the input are taken literally, and half of the cases are degenerate on
/// purpose: through vertices, along edges, in the triangle's plane, from or to an exact touch.
#include "test/impact/nasty.h"
#include "test/oracle/exact_translation.h"

namespace nasty {
namespace {

using oracle::contactTimes;
using oracle::ContactTimes;
using oracle::R3;
using oracle::Rational;

constexpr std::uint64_t kSeed = 20240811;

TEST(ExactTranslation, TheOracleKnowsTheObviousTimes) {
  const std::vector<R3> triangle = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const std::vector<R3> point = {{0, 0, 0}};
  const auto at = [&](const R3& from, const R3& velocity) {
    return contactTimes(triangle, point, from, velocity);
  };
  const auto middle = at({Rational(1, 4), Rational(1, 4), 3}, {0, 0, -2});
  ASSERT_TRUE(middle);
  EXPECT_EQ(middle->first, Rational(3, 2));
  EXPECT_EQ(middle->last, Rational(3, 2));
  EXPECT_FALSE(at({Rational(3, 4), Rational(3, 4), 3}, {0, 0, -2}));
  EXPECT_TRUE(at({1, 0, 3}, {0, 0, -2})) << "a vertex belongs to the triangle";
  const auto plane = at({-1, Rational(1, 2), 0}, {1, 0, 0});
  ASSERT_TRUE(plane) << "in its plane";
  EXPECT_EQ(plane->first, 1);
  EXPECT_EQ(plane->last, Rational(3, 2));
  const auto edges = contactTimes(triangle, {{0, -1, -1}, {0, -1, 1}}, {Rational(1, 3), 0, 0}, {0, 3, 0});
  ASSERT_TRUE(edges);
  EXPECT_EQ(edges->first, Rational(1, 3));
  EXPECT_EQ(edges->last, Rational(1, 3) + Rational(2, 9));
  EXPECT_EQ(edges->point[0], Rational(1, 3));
}

/// Corners of a at rest in its frame and of b, both frames moving straight on.
struct Flight {
  std::vector<Vec3> a, b;
  Vec3 a0, va, b0, vb;
};

Flight gridFlight(moving::Random& random, int corners) {
  const auto whole = [&](int n) { return static_cast<double>(random.below(2 * n + 1) - n); };
  const auto vec = [&](int n) { return Vec3(whole(n), whole(n), whole(n)); };
  Flight f;
  for (int i = 0; i < 3; ++i) f.a.push_back(vec(3));
  for (int i = 0; i < corners; ++i) f.b.push_back(vec(2));
  f.a0 = vec(1000);
  f.va = vec(500);
  f.vb = f.va + Vec3(whole(8), whole(8), whole(8));
  f.b0 = f.a0 + vec(6);
  return f;
}

Flight aimedFlight(moving::Random& random, int corners) {
  Flight f;
  const double size = random.decade(-3, 2);
  for (int i = 0; i < 3; ++i) f.a.push_back(moving::randomVec(random, size));
  for (int i = 0; i < corners; ++i) f.b.push_back(moving::randomVec(random, size * random.decade(-2, 0.3)));
  f.a0 = moving::randomVec(random, random.decade(0, 7));
  f.va = moving::randomVec(random, random.decade(0, 4));
  const Vec3 v = moving::randomVec(random, random.decade(0, 3.5));
  f.vb = f.va + v;
  // A corner of b at a corner, on an edge, inside or beside the triangle, at some time up to the end.
  double u = random.unit(), w = random.unit() * (1 - u);
  const int where = random.below(4);
  if (where <= 1) w = 0;
  if (where == 0) u = random.below(2);
  Vec3 aim = f.a[0] + u * (f.a[1] - f.a[0]) + w * (f.a[2] - f.a[0]);
  if (random.chance(0.3)) aim += moving::randomVec(random, size * random.decade(-15, 0));
  const double at = random.chance(0.1) ? 1.0 : random.chance(0.1) ? 0.0 : random.unit();
  f.b0 = f.a0 + (aim - f.b[0] - at * v);
  return f;
}

PlacedShape shapeOf(const std::vector<Vec3>& corners) {
  std::vector<Vec3> three = corners;
  while (three.size() < 3) three.push_back(three.back());  // a segment is a triangle without area
  return moving::mesh(three, {{0, 1, 2}});
}

struct Counts {
  int met = 0, confirmed = 0, apart = 0, possible_though_apart = 0, from_the_start = 0;
};

void check(const Flight& f, bool as_point, Counts& counts) {
  Watched pair({shapeOf(f.a)}, {as_point ? point() : shapeOf(f.b)});
  pair.advance(0, kSecond, flight(0, kSecond, f.a0, f.va), flight(0, kSecond, f.b0, f.vb));
  pair.finish();
  std::vector<R3> a, b;
  for (const Vec3& x : f.a) a.push_back(oracle::rational(x));
  for (const Vec3& x : f.b) b.push_back(oracle::rational(x));
  const R3 offset = oracle::rational(f.b0) - oracle::rational(f.a0);
  const R3 velocity = oracle::rational(f.vb) - oracle::rational(f.va);
  auto truth = contactTimes(a, b, offset, velocity);
  if (truth && (truth->last < 0 || truth->first > 1)) truth.reset();
  const auto holdsExactly = [](const PairEvent& e, const Rational& t) {
    return Rational(e.toi_lower) <= t && t <= Rational(e.toi_upper);
  };
  if (!truth) {
    ++counts.apart;
    counts.possible_though_apart += !pair.events.empty();
    for (const PairEvent& e : pair.events) ASSERT_NE(e.certificate, Certificate::kConfirmed) << pair.list();
    return;
  }
  ++counts.met;
  ASSERT_FALSE(pair.events.empty()) << "MISS of contact at " << truth->first.get_d();
  const bool from_start = truth->first <= 0;
  counts.from_the_start += from_start;
  // A touch that begins at the first instant, or a rounding before, may be an impact of which nothing is
  // known before.
  const bool at_the_start = from_start && truth->first > Rational(-1e-9);
  if (from_start) {
    ASSERT_TRUE(pair.events[0].kind == Kind::kInitialOverlap || at_the_start) << pair.list();
    ASSERT_EQ(pair.events[0].toi_lower, 0.0) << pair.list();
  }
  bool held = from_start;
  for (const PairEvent& e : pair.events) {
    if (e.kind != Kind::kSeparation && holdsExactly(e, truth->first)) held = true;
    if (e.certificate != Certificate::kConfirmed) continue;
    counts.confirmed += e.kind != Kind::kSeparation;
    if (e.kind == Kind::kInitialOverlap) {
      ASSERT_TRUE(from_start) << pair.list();
    }
    if (e.kind == Kind::kSeparation) {
      ASSERT_TRUE(holdsExactly(e, truth->last)) << truth->last.get_d() << '\n' << pair.list();
    }
    if (e.kind != Kind::kImpact || from_start) continue;
    ASSERT_TRUE(holdsExactly(e, truth->first)) << truth->first.get_d() << '\n' << pair.list();
    if (e.multiple) continue;
    const R3 world = truth->point + oracle::rational(f.a0) + truth->first * oracle::rational(f.va);
    const R3 off = oracle::rational(e.position) - world;
    const Rational radius(e.position_error);
    ASSERT_LE(off[0] * off[0] + off[1] * off[1] + off[2] * off[2], radius * radius) << pair.list();
  }
  ASSERT_TRUE(held) << "contact at " << truth->first.get_d() << '\n' << pair.list();
}

TEST(ExactTranslation, EveryBracketHoldsTheRationalTimeAndNothingIsMissed) {
  Counts counts;
  for (int i = 0; i < 1500; ++i) {
    moving::Random random(kSeed, i);
    const int corners = 1 + i % 3;
    const Flight f = i % 2 ? gridFlight(random, corners) : aimedFlight(random, corners);
    if (f.va == f.vb) continue;
    SCOPED_TRACE("seed " + std::to_string(kSeed) + " index " + std::to_string(i));
    Flight g = f;
    const bool as_point = corners == 1 && random.chance(0.7);
    if (as_point) {  // a point lies in its frame's origin
      g.b0 += g.b[0];
      g.b[0].setZero();
    }
    check(g, as_point, counts);
    if (HasFatalFailure()) return;
  }
  std::printf(
      "%d meet (%d from the start), %d of them confirmed; %d apart, %d of them with an undecided bracket\n",
      counts.met, counts.from_the_start, counts.confirmed, counts.apart, counts.possible_though_apart);
  EXPECT_GE(counts.met, 300);
  EXPECT_GE(counts.apart, 300);
  EXPECT_GE(counts.confirmed, counts.met / 4);
  EXPECT_LE(counts.possible_though_apart, counts.apart / 4);
}

}  // namespace
}  // namespace nasty

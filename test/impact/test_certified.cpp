/// The certified solver's state machine (certified.cpp, pair_method.h; DESIGN's meaning of each event).
#include <gtest/gtest.h>

#include "test/impact/watched_pair.h"

namespace collision_node::impact {
namespace {

using motion::RigidMotion;
using moving::flight;
using moving::holds;
using moving::kFrame;
using moving::kInAndOut;
using moving::resting;
using moving::Watched;
using Phase = PairState::Phase;

geometry::PlacedShape point() { return moving::placed(geometry::Point{}); }
geometry::PlacedShape sphere(double radius) { return moving::placed(geometry::Sphere{radius}); }
geometry::PlacedShape box(double size) { return moving::placed(geometry::Box{Vec3::Constant(size)}); }

/// b flies down from z = 10 at `speed`, over (x, y).
void drop(Watched& pair, double x, double y, double speed) {
  pair.advance(0, kFrame, resting(), flight(0, kFrame, {x, y, 10}, {0, 0, -speed}));
}

TEST(Certified, APointThroughASurfaceGivesBothEventsInOneBracket) {
  // "Through a surface both in the same bracket."
  Watched pair({moving::sheet(1)}, {point()});
  drop(pair, 0.3, 0.1, 2000);
  ASSERT_EQ(pair.story(), kInAndOut) << pair.list();
  const PairEvent &in = pair.events[0], &out = pair.events[1];
  EXPECT_EQ(in.toi_lower, out.toi_lower);
  EXPECT_EQ(in.toi_upper, out.toi_upper);
  EXPECT_TRUE(holds(in, 0, 0.005L)) << pair.list();
  EXPECT_LE(moving::widthOf(in), 1e-9);
  EXPECT_LE((in.position - Vec3(0.3, 0.1, 0)).norm(), in.position_error);
  EXPECT_LE(in.position_error, 1e-6);
  EXPECT_NEAR(in.normal.z(), 1.0, in.normal_error + 1e-12) << "from a to b";
  EXPECT_NEAR(in.closing_speed, 2000.0, 1e-6);
  EXPECT_EQ(pair.state.phase, Phase::kApart);
}

TEST(Certified, InsideASolidIsTouching) {
  // "A point through a solid gives IMPACT at entry and SEPARATION at exit ... Fully inside a solid is
  // touching."
  struct Row {
    geometry::PlacedShape solid, body;
    double radius;
  };
  for (const Row& row :
       {Row{moving::boxMesh({1, 1, 1}), sphere(0.05), 0.05}, Row{moving::boxMesh({1, 1, 1}), point(), 0},
        Row{box(2), point(), 0}, Row{box(2), sphere(0.05), 0.05}, Row{sphere(1), point(), 0},
        Row{moving::placed(geometry::Cylinder{1, 2}), sphere(0.05), 0.05}}) {
    Watched pair({row.solid}, {row.body});
    drop(pair, 0, 0, 2000);
    ASSERT_EQ(pair.story(), kInAndOut) << row.solid.shape.index() << '\n' << pair.list();
    EXPECT_TRUE(holds(pair.events[0], 0, (10 - 1 - static_cast<long double>(row.radius)) / 2000))
        << pair.list();
    EXPECT_TRUE(holds(pair.events[1], 0, (10 + 1 + static_cast<long double>(row.radius)) / 2000))
        << pair.list();
    for (const PairEvent& e : pair.events) EXPECT_LE(moving::widthOf(e), 1e-9) << pair.list();
  }
}

TEST(Certified, InsideASurfaceIsNotTouching) {
  Watched pair({moving::boxMesh({1, 1, 1}, Vec3::Zero(), geometry::SolidChoice::kNo)}, {sphere(0.05)});
  drop(pair, 0.3, 0.1, 2000);
  ASSERT_EQ(pair.story(), std::string(kInAndOut) + ", " + kInAndOut) << pair.list();
  const long double heights[] = {1.05L, 0.95L, -0.95L, -1.05L};
  for (int i = 0; i < 4; ++i)
    EXPECT_TRUE(holds(pair.events[i], 0, (10 - heights[i]) / 2000)) << i << pair.list();
}

TEST(Certified, PosesAreThoseAtTheLowerEnd) {
  // "world <- object at toi_lower": to rounding, however fast the bodies turn, and also where two events are
  // so close that hardly any turn is between them: every other one is a speck through a foil.
  int events = 0;
  for (int i = 0; i < 40; ++i) {
    const bool is_speck = i % 2 == 1;
    const double pace = is_speck ? 1e-3 : 1.0;
    const Vec3 spin_a = pace * Vec3(5.0 + i, -3.0, 0.1 * i * i), spin_b = pace * Vec3(-2.0, 40.0 - i, 7.0);
    const RigidMotion motions[] = {flight(0, kFrame, Vec3::Zero(), Vec3::Zero(), spin_a),
                                   flight(0, kFrame, {0.02 * i, 0.1, 10}, {0, 0, -600}, spin_b)};
    Watched pair({moving::placed(geometry::Box{{2, 2, is_speck ? 1e-5 : 1.0}})},
                 {box(is_speck ? 1e-5 : 0.5)});
    pair.advance(0, kFrame, motions[0], motions[1]);
    for (const PairEvent& e : pair.events) {
      ++events;
      for (const bool of_b : {false, true}) {
        const RigidMotion& m = motions[of_b];
        const long double rate = m.omega.cast<long double>().norm(), half = 0.5L * rate * e.toi_lower;
        const Eigen::Quaternion<long double> turn(std::cos(half), m.omega.x() / rate * std::sin(half),
                                                  m.omega.y() / rate * std::sin(half),
                                                  m.omega.z() / rate * std::sin(half));
        const geometry::Pose& pose = of_b ? e.b.pose : e.a.pose;
        const auto q = pose.orientation.cast<long double>();
        EXPECT_LE(std::min((q.coeffs() - turn.coeffs()).norm(), (q.coeffs() + turn.coeffs()).norm()), 2e-15L)
            << i << pair.list();
        EXPECT_LE((pose.position - m.positionAt(e.toi_lower)).norm(), 1e-14);
      }
    }
  }
  EXPECT_GT(events, 60);
}

TEST(Certified, AnOverlapAtTheStartIsSaidOnce) {
  // "INITIAL_OVERLAP: toi_lower = toi_upper = 0; normal NaN."
  Watched pair({box(2)}, {sphere(0.5)});
  for (int i = 0; i < 5; ++i) {
    pair.advance(i * kFrame, (i + 1) * kFrame, resting(),
                 flight(i * kFrame, (i + 1) * kFrame, {0.1 * i, 0, 1.2}, {0.1 / (kFrame * 1e-9), 0, 0}));
  }
  ASSERT_EQ(pair.story(), "INITIAL_OVERLAP CONFIRMED") << pair.list();
  const PairEvent& e = pair.events[0];
  EXPECT_EQ(e.toi_lower, 0.0);
  EXPECT_EQ(e.toi_upper, 0.0);
  EXPECT_TRUE(std::isnan(e.normal.x()) && std::isnan(e.normal.y()) && std::isnan(e.normal.z()));
  EXPECT_EQ(pair.state.phase, Phase::kTouching);
  // It leaves upwards: z = 1.5 after 0.3 m at 300 m/s.
  pair.advance(5 * kFrame, 6 * kFrame, resting(), flight(5 * kFrame, 6 * kFrame, {0.5, 0, 1.2}, {0, 0, 300}));
  ASSERT_EQ(pair.story(), "INITIAL_OVERLAP CONFIRMED, SEPARATION CONFIRMED") << pair.list();
  EXPECT_TRUE(holds(pair.events[1], 5 * kFrame, 0.001L)) << pair.list();
}

TEST(Certified, ACutPieceGivesTheSameAnswer) {
  // A tumbling box against a fixed one: one piece, or two, or ten.
  const auto b = flight(-1000, 2 * kFrame, {0.2, 0.1, 4}, {3, 1, -120}, {40, 25, -60});
  Watched whole({box(2)}, {box(1)});
  whole.advanceInParts(0, 2 * kFrame, resting(), b, 1);
  ASSERT_EQ(whole.story(), kInAndOut) << whole.list();
  for (const int parts : {2, 3, 10, 57}) {
    Watched cut({box(2)}, {box(1)});
    cut.advanceInParts(0, 2 * kFrame, resting(), b, parts);
    ASSERT_EQ(cut.story(), kInAndOut) << parts << " parts\n" << cut.list();
    for (int i = 0; i < 2; ++i) {
      EXPECT_LE(moving::lowerOf(cut.events[i], 0), moving::upperOf(whole.events[i], 0))
          << parts << cut.list();
      EXPECT_GE(moving::upperOf(cut.events[i], 0), moving::lowerOf(whole.events[i], 0))
          << parts << cut.list();
      EXPECT_LE(moving::widthOf(cut.events[i]), 4 * moving::widthOf(whole.events[i]) + 1e-15)
          << parts << cut.list();
      EXPECT_LE((cut.events[i].position - whole.events[i].position).norm(),
                cut.events[i].position_error + whole.events[i].position_error);
    }
  }
}

TEST(Certified, AnImpactAtACutIsSaidOnce) {
  // The cut runs through the bracket, or just beside it: at 1 ns steps around the true time.
  const auto b = flight(0, 3 * kFrame, {0.2, 0.1, 10}, {0, 0, -2000});
  const Nanoseconds hit = 4'475'000;  // z = 1 + 0.05
  for (Nanoseconds cut = hit - 3; cut <= hit + 3; ++cut) {
    Watched pair({box(2)}, {sphere(0.05)});
    pair.advance(0, cut, resting(), b);
    pair.advance(cut, kFrame, resting(), b);
    ASSERT_EQ(pair.story(), kInAndOut) << "cut at " << cut << '\n' << pair.list();
    EXPECT_TRUE(holds(pair.events[0], 0, 0.004475L)) << pair.list();
    EXPECT_LE(moving::widthOf(pair.events[0]), 1e-8) << "cut at " << cut << '\n' << pair.list();
  }
}

TEST(Certified, AnImpactExactlyAtTheLastStamp) {
  // "A piece owns (start, end]": published by finish or with the next piece, never twice.
  constexpr Nanoseconds kSecond = 1'000'000'000;
  const auto down = flight(0, kSecond, {0, 0, 2.5}, {0, 0, -1});  // touches z = 1.5 at 1 s
  for (const double next : {-1.0, 0.0, 1.0}) {
    Watched pair({box(2)}, {sphere(0.5)});
    pair.advance(0, kSecond, resting(), down);
    pair.advance(kSecond, 2 * kSecond, resting(), flight(kSecond, 2 * kSecond, {0, 0, 1.5}, {0, 0, next}));
    pair.finish();
    EXPECT_EQ(pair.count(Kind::kImpact), 1) << "then at " << next << " m/s\n" << pair.list();
    EXPECT_EQ(pair.count(Kind::kInitialOverlap), 0);
    ASSERT_FALSE(pair.events.empty());
    EXPECT_TRUE(holds(pair.events[0], 0, 1.0L)) << pair.list();
  }
  Watched ended({box(2)}, {sphere(0.5)});
  ended.advance(0, kSecond, resting(), down);
  ended.finish();
  EXPECT_EQ(ended.count(Kind::kImpact), 1) << ended.list();
  EXPECT_EQ(ended.events.size(), 1u);
  const std::size_t before = ended.events.size();
  ended.finish();
  EXPECT_EQ(ended.events.size(), before) << "finish() twice";
}

TEST(Certified, InterruptEndsAnOpenContactOnce) {
  // "finish(), then for an open contact one UNCERTIFIED SEPARATION at its last decided instant with
  // `reason`."
  Watched pair({box(2)}, {sphere(0.5)});
  pair.advance(0, kFrame, resting(), flight(0, kFrame, {0, 0, 2.5}, {0, 0, -60}));
  ASSERT_EQ(pair.story(), "IMPACT CONFIRMED") << pair.list();
  pair.interrupt(Reason::kGap);
  ASSERT_EQ(pair.story(), "IMPACT CONFIRMED, SEPARATION UNCERTIFIED") << pair.list();
  const PairEvent& end = pair.events[1];
  EXPECT_EQ(end.reason, Reason::kGap);
  EXPECT_EQ(moving::lowerOf(end, 0), moving::upperOf(end, 0));
  EXPECT_NEAR(static_cast<double>(moving::upperOf(end, 0)), kFrame * 1e-9, 1e-12);
  EXPECT_EQ(pair.state.phase, Phase::kNew);
  pair.interrupt(Reason::kReset);
  EXPECT_EQ(pair.events.size(), 2u) << "nothing is open";

  Watched apart({box(2)}, {sphere(0.5)});
  apart.advance(0, kFrame, resting(), flight(0, kFrame, {0, 0, 9}, {0, 0, -60}));
  apart.interrupt(Reason::kTimeout);
  EXPECT_EQ(apart.story(), "");
  // And the pair begins anew behind the gap.
  apart.advance(9 * kFrame, 10 * kFrame, resting(), flight(9 * kFrame, 10 * kFrame, {0, 0, 1}, Vec3::Zero()));
  EXPECT_EQ(apart.story(), "INITIAL_OVERLAP CONFIRMED");
}

/// One box on another without any gap, for `frames` pieces from `first` on.
void rest(Watched& pair, int first, int frames) {
  for (int i = first; i < first + frames; ++i)
    pair.advance(i * kFrame, (i + 1) * kFrame, resting(),
                 flight(i * kFrame, (i + 1) * kFrame, {0.1, 0.2, 1.5}, Vec3::Zero()));
}

TEST(Certified, ABoxRestingOnABoxIsNoFlood) {
  // "POSSIBLE is published alone, without SEPARATION; the search goes on behind it."
  Watched pair({box(2)}, {box(1)});
  rest(pair, 0, 100);
  EXPECT_LE(pair.events.size(), 1u) << pair.list();
  pair.advance(100 * kFrame, 101 * kFrame, resting(),
               flight(100 * kFrame, 101 * kFrame, {0.1, 0.2, 1.5}, {0, 0, 10}));
  pair.finish();
  ASSERT_GE(pair.events.size(), 1u) << "what touches must be said";
  EXPECT_LE(pair.events.size(), 2u) << pair.list();
  EXPECT_EQ(pair.events[0].kind, Kind::kInitialOverlap);
  EXPECT_EQ(pair.events[0].certificate, Certificate::kPossible);
  EXPECT_EQ(pair.count(Kind::kImpact), 0) << pair.list();
  EXPECT_EQ(pair.state.phase, Phase::kApart);
  // And a real impact afterwards is one.
  pair.advance(101 * kFrame, 103 * kFrame, resting(),
               flight(101 * kFrame, 103 * kFrame, {0.1, 0.2, 1.5 + 10e-9 * kFrame}, {0, 0, -10}));
  EXPECT_EQ(pair.events.back().kind, Kind::kImpact);
  EXPECT_EQ(pair.events.back().certificate, Certificate::kConfirmed) << pair.list();
}

TEST(Certified, ABoxThatLandsAndRestsIsNoFlood) {
  Watched pair({box(2)}, {box(1)});
  const double h = 1e-9 * kFrame;
  pair.advance(0, kFrame, resting(), flight(0, kFrame, {0.1, 0.2, 1.5 + 10 * h}, {0, 0, -10}));
  rest(pair, 1, 100);
  pair.advance(101 * kFrame, 102 * kFrame, resting(),
               flight(101 * kFrame, 102 * kFrame, {0.1, 0.2, 1.5}, {0, 0, 10}));
  pair.finish();
  EXPECT_EQ(pair.count(Kind::kImpact), 1) << pair.list();
  EXPECT_LE(pair.count(Kind::kSeparation), 1) << pair.list();
  EXPECT_EQ(pair.state.phase, Phase::kApart);
}

TEST(Certified, ASpentBudgetIsSaidAndNeverClear) {
  // "budget met: POSSIBLE, reason BUDGET": the truth lies in the bracket; a larger budget only shrinks it.
  const auto b = flight(0, kFrame, {0.2, 0.1, 10}, {0, 0, -2000}, {10, 20, 30});
  double last_width = 1.0;
  bool confirmed = false;
  for (std::uint64_t budget = 1; budget < 100000; budget *= 3) {
    PairOptions options;
    options.node_budget = budget;
    Watched pair({moving::torus(1.0, 0.9, 40, 20)}, {moving::boxMesh({0.05, 0.05, 0.05})}, options);
    const PieceOutcome outcome = pair.advance(0, kFrame, resting(), b);
    pair.finish();
    ASSERT_FALSE(pair.events.empty()) << "budget " << budget;
    ASSERT_NE(outcome.answer, Answer::kClear) << "budget " << budget;
    const PairEvent& e = pair.events[0];
    EXPECT_TRUE(e.certificate == Certificate::kConfirmed || outcome.budget_met) << pair.list();
    if (e.certificate == Certificate::kPossible) {
      EXPECT_EQ(e.reason, Reason::kBudget) << pair.list();
      EXPECT_EQ(outcome.answer, Answer::kUndecided);
    }
    EXPECT_LE(moving::widthOf(e), last_width) << "budget " << budget << '\n' << pair.list();
    last_width = moving::widthOf(e);
    confirmed = e.certificate == Certificate::kConfirmed;
  }
  EXPECT_TRUE(confirmed);
}

TEST(Certified, APairThatIsStillToBePartedSpendsNoMoreThanTheBudget) {
  // Two bars turn about themselves like the blades of a mixer, 500 times, and never meet: thousands of steps
  // of one pair of elements.
  const double spin = 500 * 2 * M_PI / 0.033333333;
  const geometry::PlacedShape bar = moving::placed(geometry::Box{{1.0, 0.05, 0.05}});
  for (const std::uint64_t budget : {100, 500, 4000000}) {
    PairOptions options;
    options.node_budget = budget;
    Watched pair({bar}, {bar}, options);
    const auto turning = [&](const Vec3& at, double turned) {
      return flight(0, kFrame, at, Vec3::Zero(), {0, 0, spin},
                    geometry::Quat(Eigen::AngleAxisd(turned, Vec3::UnitZ())));
    };
    const PieceOutcome outcome =
        pair.advance(0, kFrame, turning({0, 0, 0}, 0.0), turning({0.85, 0, 0}, 0.5 * M_PI));
    EXPECT_LE(outcome.node_tests, budget + 40);
    EXPECT_EQ(outcome.answer, budget > 1000 ? Answer::kClear : Answer::kUndecided) << outcome.node_tests;
  }
}

TEST(Certified, APointThatAllButTouchesForAWhileCostsNoMoreThanItsBounds) {
  // Its path ends within the rounding of a cylinder's face: brackets open one after the other, and a second
  // look proves each of them free.
  const auto start = Nanoseconds{1'700'000'000'893'499'737}, end = Nanoseconds{1'700'000'000'962'230'486};
  RigidMotion path = flight(
      start, end, {0x1.aac088f520036p-2, 0x1.82c77fe5e1b77p+0, -0x1.76e3636b89c71p-5},
      {0, -0x1.f382a0ab1b7p-3, 0}, {0x1.13dcae9c46676p-50, 0x1.6fd0e8d05ddf3p+1, 0x1.6fd0e8d05ddf3p-52},
      {0x1.fb6f7967c4fa2p-2, -0x1.2b9fd4cd5819p-4, -0x1.5bff5918408fcp-1, -0x1.1258dedef2bb4p-1});
  path.c[2] = {-0x1.5b20e269c3f78p+3, -0x1.8d72f1c497829p+3, -0x1.9af0be77dd553p+5};
  path.c[3] = {0x1.a4e12e8037b6dp+6, 0x1.135dd03715babp+7, 0x1.f23fc50b5486bp+8};
  PairOptions options;
  options.time_precision = 8.3828e-10;
  Watched pair({moving::placed(geometry::Point{})},
               {moving::placed(geometry::Cylinder{0x1.38dac18be6483p+0, 0x1.de6554fd85065p+0})}, options);
  const PieceOutcome outcome = pair.advance(start, end, resting(), path);
  EXPECT_LE(outcome.node_tests, 20000u) << pair.list();
}

TEST(Certified, ABallThatSpinsOnAFloorCostsNoMoreThanItsBounds) {
  // Its core is a point, which does not turn, however fast and however shallow: it sinks by a picometre a
  // second.
  constexpr Nanoseconds kTurnsFor = 1'000'000'000;
  for (const double spin : {0.1, 3.0, 1e3}) {
    for (const double gap : {-1e-9, -1e-14, 0.0, 1e-14}) {
      Watched pair({moving::placed(geometry::Box{{4, 4, 1}}, Vec3(0, 0, -0.5))},
                   {moving::placed(geometry::Sphere{0.25})});
      const PieceOutcome outcome =
          pair.advance(0, kTurnsFor, resting(),
                       flight(0, kTurnsFor, {-0.5, 0, 0.25 + gap}, {1e-3, 0, -1e-12}, {0, 0, spin}));
      EXPECT_LE(outcome.node_tests, 1000u) << "spin " << spin << " gap " << gap << '\n' << pair.list();
    }
  }
}

TEST(Certified, ABoxThatSpinsInPlaceAndBarelyReachesAWallIsDecidedInBoundedWork) {
  // The corner that reaches farthest is not the one that is nearest now, and nothing else comes closer.
  moving::Random random(20261127, 0);
  constexpr double kHalf = 0.5;
  constexpr Nanoseconds kTurnsFor = 1'000'000'000;
  std::uint64_t most = 0;
  for (int i = 0; i < 60; ++i) {
    const Vec3 axis = random.direction();
    double reach = 0.0;  // of the circle of each corner, along x
    for (int k = 0; k < 8; ++k) {
      const Vec3 corner = kHalf * Vec3(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1);
      const double along = corner.dot(axis);
      reach = std::max(reach, along * axis.x() + (corner - along * axis).norm() * axis.tail<2>().norm());
    }
    const double depth = random.decade(-8, -4), omega = random.in(7, 30);
    Watched pair({moving::placed(geometry::Box{{1, 8, 8}}, Vec3(reach - depth + 0.5, 0, 0))},
                 {moving::placed(geometry::Box{Vec3::Constant(2 * kHalf)})});
    const PieceOutcome outcome =
        pair.advance(0, kTurnsFor, resting(), flight(0, kTurnsFor, Vec3::Zero(), Vec3::Zero(), omega * axis));
    most = std::max(most, outcome.node_tests);
    ASSERT_FALSE(pair.events.empty()) << "axis " << axis.transpose() << " depth " << depth;
    EXPECT_EQ(pair.events[0].kind, Kind::kImpact) << pair.list();
    EXPECT_EQ(pair.events[0].certificate, Certificate::kConfirmed) << pair.list();
  }
  EXPECT_LE(most, 20000u);
  std::printf("%llu node tests at most\n", static_cast<unsigned long long>(most));
}

TEST(Certified, WhoStartsWithinTheRoundingOfAMeshHasAnyNormal) {
  for (const double above : {-3e-15, -0x1p-53, 0x1p-52, 3e-15}) {
    Watched pair({moving::boxMesh({1, 1, 1})}, {point()});
    pair.advance(0, kFrame, resting(), flight(0, kFrame, {0.3, 0.2, 1 + above}, {0.1, 0, -1}));
    ASSERT_EQ(pair.story(), "IMPACT CONFIRMED") << pair.list();
    const PairEvent& e = pair.events[0];
    EXPECT_EQ(e.normal_error, M_PI) << pair.list();
    EXPECT_GT(e.closing_speed, 0.0) << pair.list();
  }
}

TEST(Certified, APieceThatBeginsInAnOpenQuestionIsUndecidedAndTheRestOfOneIsTold) {
  // "What cannot be decided is published as POSSIBLE, never as clear." With a tube of 0.1 m a slow point may
  // be in the plate from 35 to 65 s; what is left at a stamp is shorter than a bracket of this tube may be.
  constexpr Nanoseconds kSecond = 1'000'000'000;
  for (const Nanoseconds cut : {54, 60}) {
    Watched pair({moving::placed(geometry::Box{{2, 2, 0.1}})}, {point()});
    double covered = 35.0;
    Nanoseconds from = 0;
    for (const Nanoseconds to : {Nanoseconds{40}, cut, Nanoseconds{100}}) {
      Piece piece{from * kSecond, to * kSecond, resting(),
                  flight(0, 100 * kSecond, {0.3, 0.2, -0.5}, {0, 0, 0.01})};
      piece.tube = 0.1;
      EXPECT_EQ(pair.advance(piece).answer, Answer::kUndecided) << "up to " << to << " s\n" << pair.list();
      from = to;
    }
    for (const PairEvent& e : pair.events) {
      const double start = 1e-9 * static_cast<double>(e.interval_start_ns);
      EXPECT_EQ(e.certificate, Certificate::kPossible) << pair.list();
      EXPECT_LE(start + e.toi_lower, covered + 1e-9) << pair.list();
      covered = start + e.toi_upper;
    }
    EXPECT_GE(covered, 65.0) << pair.list();
  }
  // Without one, the rest may be shorter than a bracket: no event, but not clear either.
  Watched flush({box(1)}, {box(1)});
  for (int i = 0; i < 3; ++i) flush.advance(i * kSecond, (i + 1) * kSecond, resting(), resting({0, 0, 1}));
  const std::size_t told = flush.events.size();
  const auto rises = flight(3 * kSecond, 4 * kSecond, {0, 0, 1}, {0, 0, 0.5});
  EXPECT_EQ(flush.advance(3 * kSecond, 4 * kSecond, resting(), rises).answer, Answer::kUndecided);
  EXPECT_EQ(flush.events.size(), told) << flush.list();
  EXPECT_EQ(flush.advance(4 * kSecond, 5 * kSecond, resting(), resting({0, 0, 1.5})).answer, Answer::kClear);
}

TEST(Certified, ASlowHitOfALargeTurningBodyIsOneImpact) {
  // Where kilometres turn, the instants looked at are closer than a slow approach can tell apart: which of
  // the last few budgets before the contact are proved free is an accident, and no end of the bracket.
  moving::Random random(20261127, 1);
  constexpr double kSpeed = 0.1, kHalfFrame = 0.5e-9 * kFrame;  // [m/s], [s]
  constexpr int kCases = 200;
  int several = 0;
  double widest = 0.0;
  for (int i = 0; i < kCases; ++i) {
    const double size = i % 2 == 0 ? 1e4 : 1e5;
    const Vec3 axis = random.direction(), omega = 0.3 * axis,
               other = random.decade(-2, 0) * size * Vec3(0.5, 0.25, 0.5);
    const Mat3 turned(Eigen::AngleAxisd(omega.norm() * kHalfFrame, axis)),
        leaning(Eigen::AngleAxisd(1.0, random.direction()));
    // What is touched in the middle of the frame: a sphere, or a box somewhere on a face; by a corner.
    Vec3 normal = random.direction(), touched = 0.5 * size * normal;
    if (i % 4 < 2) {
      normal = turned.col(i % 3);
      touched = moving::randomVec(random, 0.45 * size);
      touched += normal * (0.5 * size - normal.dot(touched));
    }
    const Vec3 corner = leaning * Vec3(other.array() * (leaning.transpose() * normal).array().sign());
    const Vec3 velocity = omega.cross(touched) - kSpeed * normal;
    const moving::Shapes large = {i % 4 < 2 ? moving::placed(geometry::Box{Vec3::Constant(size)})
                                            : moving::placed(geometry::Sphere{0.5 * size})},
                         small = {moving::placed(geometry::Box{2 * other})};
    const Piece piece{0, kFrame, flight(0, kFrame, Vec3::Zero(), Vec3::Zero(), omega),
                      flight(0, kFrame, touched + corner - kHalfFrame * velocity, velocity, Vec3::Zero(),
                             geometry::Quat(leaning))};
    Watched pair(large, small);
    pair.advance(piece);
    SCOPED_TRACE("case " + std::to_string(i) + '\n' + pair.list());
    several += pair.count(Kind::kImpact) > 1;
    const auto hit = std::find_if(pair.events.begin(), pair.events.end(), [](const PairEvent& e) {
      return e.kind == Kind::kImpact && e.certificate == Certificate::kConfirmed;
    });
    ASSERT_NE(hit, pair.events.end());
    const geometry::Body a(large), b(small);
    const double budget = PairPiece(a, b, piece, 0.0).point_error;
    widest = std::max(widest, moving::widthOf(*hit) * kSpeed / (8 * budget));
  }
  EXPECT_LE(widest, 1.0);  // W
  EXPECT_LE(several, kCases / 20);
  std::printf("%d of %d in several events, widest %.3f W\n", several, kCases, widest);
}

TEST(Certified, AMeshAsSmallAsItsRoundingEntersASolidWithinW) {
  // No pair of triangles so narrow can be proved to meet; their points can be proved to be inside (inside.h).
  // W is DESIGN section 5's: eight budgets over the closing speed.
  constexpr double kSolid = 1e6, kSpeed = 1000.0, kAbove = 10.0;  // [m], [m/s], [m]
  for (const double budgets : {0.3, 1.0, 3.0, 5.0, 8.0, 12.0, 20.0, 40.0}) {
    const RigidMotion falls =
        flight(0, kFrame, {3e5, 1e5, kSolid + kAbove}, {0, 0, -kSpeed}, {0.4, 0.3, 0.1});
    const geometry::Body solid({moving::boxMesh(Vec3::Constant(kSolid))});
    const auto upright = [](double half) {  // a strip of narrow rows
      constexpr int kRows = 20;
      std::vector<Vec3> vertices;
      std::vector<moving::Corners> triangles;
      for (int i = 0; i <= kRows; ++i) {
        const double z = half * (2.0 * i / kRows - 1.0);
        vertices.insert(vertices.end(), {{-half, 0, z}, {half, 0, z}});
        const int k = 2 * i;
        if (i < kRows) triangles.insert(triangles.end(), {{k, k + 1, k + 3}, {k, k + 3, k + 2}});
      }
      return moving::mesh(vertices, triangles);
    };
    const geometry::Body speck({upright(1e-9)});
    const double budget = PairPiece(solid, speck, {0, kFrame, resting(), falls}, 0.0).point_error;
    const double half = 0.5 * budgets * budget;
    Watched pair({moving::boxMesh(Vec3::Constant(kSolid))}, {upright(half)});
    pair.advance(0, kFrame, resting(), falls);
    ASSERT_EQ(pair.story(), "IMPACT CONFIRMED") << budgets << '\n' << pair.list();
    EXPECT_LE(moving::widthOf(pair.events[0]), 8.0 * budget / kSpeed) << budgets << '\n' << pair.list();
    const Vec3 omega(0.4, 0.3, 0.1);
    const geometry::Quat turn(Eigen::AngleAxisd(omega.norm() * kAbove / kSpeed, omega.normalized()));
    double down = 0.0;  // of the strip's lowest corner
    for (const double x : {-half, half})
      for (const double z : {-half, half}) down = std::max(down, -(turn * Vec3(x, 0, z)).z());
    EXPECT_TRUE(holds(pair.events[0], 0, (kAbove - static_cast<long double>(down)) / kSpeed, 1e-14L))
        << budgets << pair.list();
  }
}

TEST(Certified, AMeshWithPoleRowsSinksIntoAFloorInBoundedWork) {
  // The collapsed triangles of a pole are as narrow as can be: their points tell how the contact begins, and
  // are not followed.
  constexpr int kAround = 32, kRows = 16;
  std::vector<Vec3> vertices;
  std::vector<moving::Corners> triangles;
  for (int i = 0; i <= kRows; ++i) {
    for (int j = 0; j < kAround; ++j) {
      const double down = M_PI * i / kRows, round = 2.0 * M_PI * j / kAround;
      const double across = i % kRows == 0 ? 0.0 : 0.5 * std::sin(down);
      vertices.push_back({across * std::cos(round), across * std::sin(round), 0.5 * std::cos(down)});
      const int k = i * kAround + j, right = i * kAround + (j + 1) % kAround;
      if (i == kRows) continue;
      triangles.push_back({k, k + kAround, right + kAround});
      triangles.push_back({k, right + kAround, right});
    }
  }
  Watched pair({moving::boxMesh({100, 100, 1})}, {moving::mesh(vertices, triangles)});
  const PieceOutcome outcome =
      pair.advance(0, 1'000'000'000, resting(), flight(0, 1'000'000'000, {-25, 0, 1.55}, {50, 0, -0.1}));
  ASSERT_EQ(pair.story(), "IMPACT CONFIRMED") << pair.list();
  EXPECT_TRUE(holds(pair.events[0], 0, 0.5L, 1e-12L)) << pair.list();
  EXPECT_LE(outcome.node_tests, 20000u);
}

TEST(Certified, WhatIsTooThinForItsNormalsLengthIsStillKeptAtTheContactDistance) {
  // Lengths below 1e-154 m have no squares in doubles.
  for (const double thin : {1e-100, 1e-150, 1e-163, 1e-200, 1e-300}) {
    const auto needle = [&] { return moving::mesh({{0, 0, 0}, {1, 0, 0}, {0, thin, 0}}, {{0, 1, 2}}); };
    PairOptions options;
    options.contact_distance = 1.0;
    Watched pair({needle()}, {needle()}, options);
    pair.advance(0, kFrame, resting(), flight(0, kFrame, {0, 0, 2.5}, {0, 0, -60}));
    ASSERT_EQ(pair.story(), "IMPACT CONFIRMED") << thin << '\n' << pair.list();
    EXPECT_TRUE(holds(pair.events[0], 0, 0.025L)) << thin << pair.list();
  }
  for (const double size : {1e-163, 1e-200, 1e-300}) {
    for (const auto& shape : {sphere(size), moving::placed(geometry::Cylinder{size, size})}) {
      Watched pair({shape}, {shape});
      pair.advance(0, kFrame, resting(), resting({10 * size, 0, 0}));
      for (const PairEvent& e : pair.events) EXPECT_EQ(e.certificate, Certificate::kPossible) << pair.list();
    }
  }
}

TEST(Certified, ABudgetSpentAnywhereLosesNoImpact) {
  // "Time that no event and no bracket covers is proved free of contact", wherever the budget ends.
  struct Row {
    geometry::PlacedShape a, b;
    std::vector<double> heights;  ///< of b at its true impacts
    double omega;
  };
  const auto surface = moving::boxMesh({1, 1, 1}, Vec3::Zero(), geometry::SolidChoice::kNo);
  const auto small_box = moving::boxMesh({0.05, 0.05, 0.05});
  const Row rows[] = {{moving::boxMesh({1, 1, 1}), sphere(0.05), {1.05}, 2.0},
                      {box(2), sphere(0.05), {1.05}, 0.0},
                      {moving::sheet(1), point(), {0.0}, 0.0},
                      {moving::boxMesh({1, 1, 1}), small_box, {1.05}, 0.0},
                      {surface, sphere(0.05), {1.05, -0.95}, 2.0},
                      {surface, point(), {1.0, -1.0}, 0.0}};
  constexpr std::uint64_t kFacts = 40;  // tests that tell where the events are
  for (const Row& row : rows) {
    for (std::uint64_t budget = 0; budget < 600; budget += budget < 250 ? 1 : 7) {
      PairOptions options;
      options.node_budget = budget;
      Watched pair({row.a}, {row.b}, options);
      const PieceOutcome outcome = pair.advance(
          0, kFrame, resting(), flight(0, kFrame, {0.3, 0.1, 10}, {0, 0, -2000}, {0, 0, row.omega}));
      pair.finish();
      SCOPED_TRACE("shapes " + std::to_string(row.a.shape.index()) + ", " +
                   std::to_string(row.b.shape.index()) + " budget " + std::to_string(budget) + "\n" +
                   pair.list());
      ASSERT_FALSE(pair.events.empty());
      EXPECT_LE(outcome.node_tests, budget + kFacts) << "no search goes on";
      ASSERT_NE(pair.events[0].kind, Kind::kSeparation);
      for (std::size_t i = 0; i < pair.events.size(); ++i) {
        ASSERT_EQ(pair.events[i].interval_end_ns, kFrame);
        if (i > 0 && pair.events[i].kind == Kind::kImpact) {
          ASSERT_GE(pair.events[i].toi_lower, pair.events[i - 1].toi_upper)
              << "what was decided is asked again";
        }
      }
      // An IMPACT that no SEPARATION follows says that the rest is contact or not known; so does a POSSIBLE
      // bracket.
      const bool open = pair.events.back().kind != Kind::kSeparation;
      for (const double height : row.heights) {
        const auto at = (10 - static_cast<long double>(height)) / 2000;
        bool covered = open && moving::lowerOf(pair.events.back(), 0) < at;
        for (const PairEvent& e : pair.events)
          covered |= (e.kind == Kind::kImpact || e.certificate == Certificate::kPossible) && holds(e, 0, at);
        ASSERT_TRUE(covered) << "impact at height " << height;
      }
      if (open) {
        ASSERT_EQ(outcome.answer, Answer::kUndecided);
      }
    }
  }
}

}  // namespace
}  // namespace collision_node::impact

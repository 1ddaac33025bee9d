/// What the certified solver spends: no more than its bounds need, and with a spent budget nothing is lost.
#include "test/impact/certified.h"

namespace collision_node::impact {
namespace {

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

TEST(Certified, WhatIsSmallAndDeepInATurningSolidCostsNoMoreThanWhatIsLarge) {
  // limits.md: "The depth of the cores counts, too, so what is deep inside a solid, by more than 8 times its
  // radius, costs no more than what is large.". A proof by such a ball's radius would last no longer than the
  // root of it.
  constexpr Nanoseconds kEnd = 400'000'000;
  const auto turns = flight(0, kEnd, Vec3::Zero(), Vec3::Zero(), {100, 200, 50}),
             inside = flight(0, kEnd, {0.03, 0.02, -0.01}, Vec3::Zero(), {30, -20, 100});
  const geometry::PlacedShape box = moving::placed(geometry::Box{{0.2, 0.2, 0.2}}),
                              coin = moving::placed(geometry::Cylinder{0.2, 0.15});
  using Make = geometry::PlacedShape (*)(double);
  const Make round[] = {[](double size) { return sphere(size); },
                        [](double size) {
                          return moving::placed(geometry::Capsule{size, size});
                        },
                        [](double size) {
                          return moving::placed(geometry::Capsule{size, 1e-3});
                        }};
  for (const geometry::PlacedShape& solid : {box, coin}) {
    for (const Make& make : round) {
      double large = 0.0;
      for (const double size : {1e-2, 1e-6, 1e-9, 1e-12}) {
        Watched pair({solid}, {make(size)});
        const auto tests = static_cast<double>(pair.advance(0, kEnd, turns, inside).node_tests);
        EXPECT_EQ(pair.story(), "INITIAL_OVERLAP CONFIRMED") << size << '\n' << pair.list();
        if (large == 0.0) large = tests;
        EXPECT_LE(tests, 1.5 * large) << size;
      }
    }
  }
}

TEST(Certified, WhatIsTinyCostsNothingWhereNothingIsNear) {
  // A cube turns with the far end of a long arm, and a point stands a tenth of a radius beside its circle:
  // what the motion bends exceeds any share of the cube's size.
  const auto turns = flight(0, 1'000'000'000, Vec3::Zero(), Vec3::Zero(), {0, 0, 3}),
             stands = resting({-0.25, 0.1, 0});
  for (const double size : {1e-2, 1e-4, 1e-8, 1e-12, 0.0}) {
    for (const double distance : {0.0, 0.01}) {
      PairOptions options;
      options.contact_distance = distance;
      Watched pair({moving::boxMesh(Vec3::Constant(0.5 * size), {0.3, 0, 0})}, {point()}, options);
      const PieceOutcome outcome = pair.advance(0, 1'000'000'000, turns, stands);
      EXPECT_EQ(outcome.answer, Answer::kClear) << size << '\n' << pair.list();
      EXPECT_LT(outcome.node_tests, 50) << size;
    }
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

TEST(Certified, ABudgetSpentAnywhereLosesNoImpact) {
  // "Time that no event and no bracket covers … is proved free of contact", wherever the budget ends.
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

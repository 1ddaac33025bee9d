/// The certified solver's state machine (certified.cpp, pair_method.h; DESIGN's meaning of each event).
#include "collision_node/impact/solve.h"
#include "test/impact/certified.h"

namespace collision_node::impact {
namespace {

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
  EXPECT_NEAR(out.normal.z(), -1.0, out.normal_error + 1e-12) << "it leaves on the other side";
  EXPECT_NEAR(out.closing_speed, -2000.0, 1e-6);
  EXPECT_EQ(pair.state.phase, Phase::kApart);
  // And of one that turns, by proof rather than in closed form.
  Watched turning({moving::sheet(1)}, {point()});
  turning.advance(0, kFrame, flight(0, kFrame, Vec3::Zero(), Vec3::Zero(), {0, 0, 1}),
                  flight(0, kFrame, {0.3, 0.1, 10}, {0, 0, -2000}));
  ASSERT_EQ(turning.story(), kInAndOut) << turning.list();
  EXPECT_NEAR(turning.events[0].normal.z(), 1.0, 1e-9);
  EXPECT_NEAR(turning.events[1].normal.z(), -1.0, 1e-9);
  EXPECT_NEAR(turning.events[1].closing_speed, -2000.0, 1e-6);
}

/// solve.h: "else throws std::invalid_argument, which names the number".
TEST(Solve, RefusesNumbersWithWhichAllWouldSeemProved) {
  const Body a({sphere(0.05)}), b({sphere(0.05)});
  // They overlap by 5 mm.
  const Piece good{0, kFrame, resting(), flight(0, kFrame, {0.095, 0, 0}, Vec3::Zero())};
  const auto complaint = [&](const Piece& piece, const PairOptions& options) -> std::string {
    Workspace workspace;
    Solution solution;
    try {
      solve(a, b, piece, options, workspace, solution);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(complaint(good, {}), "");
  const auto with = [](double PairOptions::*number, double value) {
    PairOptions options;
    options.*number = value;
    return options;
  };
  EXPECT_EQ(complaint(good, with(&PairOptions::contact_distance, -0.01)),
            "impact: PairOptions::contact_distance [m] is -0.01; it must be 0 or more, and finite");
  for (const double bad : {-1e-9, std::nan(""), HUGE_VAL}) {
    EXPECT_NE(complaint(good, with(&PairOptions::contact_distance, bad)), "") << bad;
    EXPECT_NE(complaint(good, with(&PairOptions::time_precision, bad)), "") << bad;
    EXPECT_NE(complaint(good, with(&PairOptions::distance_precision, bad)), "") << bad;
    EXPECT_THROW(makeCertified(a, b, with(&PairOptions::time_precision, bad)), std::invalid_argument);
  }
  Piece thin = good, backwards = good;
  thin.tube = -1e-3;
  std::swap(backwards.start_ns, backwards.end_ns);
  EXPECT_EQ(complaint(thin, {}), "impact: Piece::tube [m] is -0.001; it must be 0 or more");
  EXPECT_NE(complaint(backwards, {}), "");
  Watched watched({sphere(0.05)}, {sphere(0.05)});
  EXPECT_THROW(watched.advance(thin), std::invalid_argument);
  EXPECT_THROW(watched.advance(backwards), std::invalid_argument);
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
  // "finish(), then for an open contact one UNCERTIFIED SEPARATION with `reason`"
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

  // "from the last instant at which contact is known (toi_lower) to the last piece's end": the depth fades as
  // (1 - t/T)^3, so that for the last part of T nobody knows.
  Watched fading({box(2)}, {box(1)});
  constexpr double kTime = 1e-9 * kFrame, kDepth = 1e-10;
  moving::RigidMotion rising = flight(0, kFrame, {0.1, 0.2, 1.5 - kDepth}, {0, 0, 3 * kDepth / kTime});
  rising.c[2].z() = -3 * kDepth / (kTime * kTime);
  rising.c[3].z() = kDepth / (kTime * kTime * kTime);
  fading.advance(0, kFrame, resting(), rising);
  ASSERT_EQ(fading.story(), "INITIAL_OVERLAP CONFIRMED") << fading.list();
  fading.interrupt(Reason::kGap);
  ASSERT_EQ(fading.story(), "INITIAL_OVERLAP CONFIRMED, SEPARATION UNCERTIFIED") << fading.list();
  EXPECT_LT(fading.events[1].toi_lower, 0.999 * kTime) << fading.list();
  EXPECT_GT(fading.events[1].toi_lower, 0.9 * kTime) << fading.list();
  EXPECT_NEAR(fading.events[1].toi_upper, kTime, 1e-12) << fading.list();

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

TEST(Certified, TheBallHoldsWhereWhatIsExactlyFlushBeganToTouch) {
  // "Every point that the reported elements share at the first (or last) instant of the contact lies within
  // position_error": of what has no volume and lies in a triangle's plane, no normal tells where.
  constexpr Nanoseconds kEnd = 1'000'000'000;
  constexpr double kSpeed = 1.0;
  const geometry::PlacedShape ground = moving::mesh({{-1, -1, 0}, {3, -1, 0}, {1, 3, 0}}, {{0, 1, 2}}),
                              plate =
                                  moving::mesh({{0, 0, 0}, {-0.01, 0.01, 0}, {-0.01, -0.01, 0}}, {{0, 1, 2}});
  for (const geometry::PlacedShape& slides : {point(), plate}) {
    {  // touches first at the first instant, and the bracket is carried over three stamps
      Watched pair({ground}, {slides});
      for (Nanoseconds t = 0; t < kEnd; t += kEnd / 4)
        pair.advance(t, t + kEnd / 4, resting(), flight(0, kEnd, Vec3::Zero(), {kSpeed, 0, 0}));
      pair.finish();
      ASSERT_FALSE(pair.events.empty());
      const PairEvent& e = pair.events[0];
      EXPECT_EQ(e.toi_lower, 0.0);
      EXPECT_LE(e.position.norm(), e.position_error) << pair.list();
    }
    {  // above the ground by 1e-17 m, below it from the middle on
      Watched pair({ground}, {slides});
      pair.advance(0, kEnd, resting(), flight(0, kEnd, {0, 0, 1e-17}, {kSpeed, 0, -2e-17}));
      pair.finish();
      ASSERT_FALSE(pair.events.empty());
      const PairEvent& e = pair.events[0];
      EXPECT_TRUE(e.toi_lower <= 0.5 && e.toi_upper >= 0.5) << pair.list();
      EXPECT_LE((e.position - Vec3(0.5 * kSpeed, 0, 0)).norm(), e.position_error) << pair.list();
    }
  }
}

TEST(Certified, WhoLeavesASolidPartsFromItsOuterSide) {
  // A point is in a plate of 1e-7 m for 6e-7 s. What parted it, inside, from the face through which it leaves
  // looks the other way.
  const double x = 0x1.7b7c41ba5f04dp-3, y = 0x1.2f0649d7d109fp-4, z = 0x1.b33e0bb37fbc2p-25;
  geometry::PlacedShape plate = moving::boxMesh({x, y, z});
  plate.origin = {
      {0x1.5651255cfe7b8p-4, -0x1.3848f1fc2fdcp-9, 0x1.a24a12afc2844p-5},
      {-0x1.27a98a342fae3p-4, -0x1.0c4274298abd4p-1, -0x1.0ed418efb7231p-2, -0x1.9ce3c2d5177dbp-1}};
  geometry::PlacedShape tip = point();
  tip.origin.position = {0x1.308eda28557p-9, -0x1.3a5e2843c8207p-10, 0x1.e111a4b0b359p-10};
  const auto a = flight(
                 1'699'999'999'775'073'173, 1'700'000'000'543'054'925,
                 {-0x1.7d33bf78e0f2dp+13, -0x1.dd5d2e2e6e715p+15, 0x1.4a5f1273247dep+13},
                 {-0x1.5d299d1c97fcp-2, -0x1.4c28941b1ca01p-3, -0x1.0e474d3984adfp-2},
                 {0x1.1b3b18aa180adp+2, 0x1.5081922afc376p-5, 0x1.7022a7f1f04c1p-1},
                 {-0x1.5d339d38d2982p-1, -0x1.bc0870c217451p-6, 0x1.6a6f28fd6b2ddp-2, -0x1.475e4d0a42b38p-1}),
             b = flight(
                 1'700'000'000'090'801'599, 1'700'000'000'543'054'925,
                 {-0x1.7d343f49c2017p+13, -0x1.dd5d5f849d46p+15, 0x1.4a5e961e37304p+13},
                 {0x1.12483bea6044ap-4, -0x1.61e1bd82c3e9fp-1, 0x1.51326258556c2p-2},
                 {-0x1.e587c743b8559p-5, 0x1.1beac8f2e888ap-2, 0x1.d2da9c6e79cffp-5},
                 {-0x1.306a632101e05p-1, -0x1.6dece505abe9dp-2, -0x1.504a2c505c441p-1, 0x1.2eb6ed0001466p-2});
  PairOptions options;
  options.time_precision = 1e-13;
  Watched pair({plate}, {tip}, options);
  pair.advance(1'700'000'000'203'864'680, 1'700'000'000'316'927'762, a, b);
  ASSERT_EQ(pair.story(), "IMPACT CONFIRMED, SEPARATION CONFIRMED") << pair.list();
  EXPECT_GT(pair.events[0].closing_speed, 0.0) << pair.list();
  EXPECT_LT(pair.events[1].closing_speed, 0.0) << pair.list();
}

TEST(Certified, WhetherAContactEndsWithThePieceIsUndecidedWithoutAnEvent) {
  // "Or all that is open is whether the last contact ends before the piece does: it has no SEPARATION."
  Piece piece{0, 1'000'000'000, resting(), flight(0, 1'000'000'000, {0, 0, 1 - 0x1p-10}, {0, 0, 0x1p-10})};
  const geometry::Body a({box(1)}), b({box(1)});
  Workspace workspace;
  Solution solution;
  solve(a, b, piece, {}, workspace, solution);
  EXPECT_EQ(solution.verdict, Answer::kUndecided);
  ASSERT_EQ(solution.events.size(), 1U) << moving::listOf(solution.events);
  EXPECT_EQ(solution.events[0].kind, Kind::kInitialOverlap);
  EXPECT_EQ(solution.events[0].certificate, Certificate::kConfirmed);
}

}  // namespace
}  // namespace collision_node::impact

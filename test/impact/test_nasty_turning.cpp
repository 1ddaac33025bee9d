/// Nasty cases of rotation: several turns, screws, far pivots, half turns, grazing arcs, curved paths.
#include "test/impact/nasty.h"

namespace nasty {
namespace {

/// A bar of 2 m about z and a ball of 0.05 m at 0.8 m and `at` radians; the motion model is `motion`.
struct TurningBar : Watched {
  TurningBar(const RigidMotion& bar, double at) : Watched({box(2, 0.04, 0.04)}, {sphere(0.05)}) {
    advance(0, kFrame, bar, resting({0.8 * std::cos(at), 0.8 * std::sin(at), 0}));
  }
};
const Real kLead = std::asin(0.07L / 0.8L);  // the bar's flank meets the ball this much before its axis would

motion::StampedPose turned(Nanoseconds stamp, double angle) {
  motion::StampedPose pose;
  pose.stamp_ns = stamp;
  pose.pose.orientation = Quat(std::cos(0.5 * angle), 0, 0, std::sin(0.5 * angle));
  return pose;
}

TEST(Nasty, C12_ABarThatTurns170DegreesHitsABallAt120) {
  const double turn = 170.0 / 180.0 * kPi, at = 120.0 / 180.0 * kPi;
  const RigidMotion motion = motion::straightSlerp(turned(0, 0), turned(kFrame, turn));
  const TurningBar pair(motion, at);
  ASSERT_EQ(pair.story(), kInAndOut) << pair.list();
  EXPECT_TRUE(holds(pair.events[0], 0, (at - kLead) / motion.omega.z(), 1e-13L)) << pair.list();
  EXPECT_TRUE(holds(pair.events[1], 0, (at + kLead) / motion.omega.z(), 1e-13L)) << pair.list();
  EXPECT_LE(widthOf(pair.events[0]), 1e-9);
}

TEST(Nasty, C13_OfSeveralPassesOfATurningBarEachIsFoundAndTheFirstComesFirst) {
  const double at = 100.0 / 180.0 * kPi;
  for (const double turns : {0.75, 1.0, 10.0, -10.0}) {
    motion::StampedPose from = turned(0, 0), to = turned(kFrame, 2 * kPi * turns);
    from.has_twist = to.has_twist = true;
    from.angular = to.angular = {0, 0, 2 * kPi * turns / kFrameSeconds};
    const RigidMotion motion = motion::spin(from, to);
    const double rate = motion.omega.z();
    ASSERT_NEAR(rate * kFrameSeconds, 2 * kPi * turns, 1e-9) << "the twist tells the turns";
    const TurningBar pair(motion, at);
    // Either half of the bar passes; the other way round the first pass is at 80 degrees before the middle.
    const Real first = turns > 0 ? at : kExactPi - at;
    const int passes = turns == 0.75 ? 1 : static_cast<int>(std::lround(2 * std::abs(turns)));
    ASSERT_EQ(pair.events.size(), 2u * static_cast<unsigned>(passes)) << turns << '\n' << pair.list();
    for (int i = 0; i < 2 * passes; ++i) {
      const PairEvent& e = pair.events[static_cast<unsigned>(i)];
      ASSERT_EQ(e.kind, i % 2 ? Kind::kSeparation : Kind::kImpact) << pair.list();
      EXPECT_EQ(e.certificate, Certificate::kConfirmed) << pair.list();
      const Real angle = first + kExactPi * (i / 2) + (i % 2 ? kLead : -kLead);
      EXPECT_TRUE(holds(e, 0, angle / std::abs(static_cast<Real>(rate)), 1e-13L)) << i << '\n' << pair.list();
    }
  }
}

TEST(Nasty, C14_TwoBladesAt1e5RadiansASecondMeetWithBoundedWork) {
  // Two blades turn some 32 times each in two milliseconds while they close in at 2 m/s; the march is the
  // truth.
  constexpr Nanoseconds kStep = 2'000'000;
  const moving::Shapes blade = {box(0.4, 0.02, 0.02)};
  const Piece piece{0, kStep, flight(0, kStep, Vec3::Zero(), Vec3::Zero(), {0, 0, 1e5}),
                    flight(0, kStep, {0.402, 0.001, 0.003}, {-2, 0, 0}, {0, 1e3, -1e5})};
  const oracle::Pair truth = oracle::makePair(blade, blade, piece.a, piece.b, 0, kStep);
  const oracle::FirstTouch touch = truth.firstTouch(0, truth.duration());
  ASSERT_TRUE(touch.found && touch.verified) << "the march found no contact";
  Watched pair(blade, blade);
  const PieceOutcome outcome = pair.advance(piece);
  pair.finish();
  ASSERT_FALSE(pair.events.empty());
  EXPECT_EQ(pair.events[0].kind, Kind::kImpact) << pair.list();
  EXPECT_LE(moving::lowerOf(pair.events[0], 0), touch.hi) << pair.list();
  EXPECT_GE(moving::upperOf(pair.events[0], 0), touch.lo) << pair.list();
  EXPECT_LE(widthOf(pair.events[0]), 1e-9) << pair.list();
  std::printf("node tests %llu, events %zu\n", static_cast<unsigned long long>(outcome.node_tests),
              pair.events.size());

  // A budget bounds the work; what was not looked at is said.
  PairOptions options;
  options.node_budget = 20;
  Watched hasty(blade, blade, options);
  const PieceOutcome short_work = hasty.advance(piece);
  hasty.finish();
  EXPECT_TRUE(short_work.budget_met);
  EXPECT_LE(short_work.node_tests, 2000u) << "what describes the open bracket comes on top";
  ASSERT_FALSE(hasty.events.empty());
  EXPECT_EQ(hasty.events[0].certificate, Certificate::kPossible) << hasty.list();
  EXPECT_EQ(hasty.events[0].reason, Reason::kBudget) << hasty.list();
  EXPECT_TRUE(anyHolds(hasty, Kind::kImpact, 0, touch.hi)) << hasty.list();
}

TEST(Nasty, C15_ABladeThatMissesAWallByAMicrometreFor530TurnsIsClear) {
  const double tip = std::hypot(0.5, 0.05);
  Watched pair({moving::boxMesh({1, 2, 2}, {tip + 1e-6 + 1, 0, 0})}, {box(1, 0.1, 0.02)});
  const PieceOutcome outcome = fly(pair, Vec3::Zero(), Vec3::Zero(), {0, 0, 1e5});
  EXPECT_EQ(pair.story(), "") << pair.list();
  EXPECT_EQ(outcome.answer, Answer::kClear);
  std::printf("node tests %llu\n", static_cast<unsigned long long>(outcome.node_tests));
}

TEST(Nasty, C16_AFarPivotIsAnArcAndNotItsChord) {
  // A rod tip 1 km from its pivot sweeps 1e-3 rad: a point on its arc, off the chord by 0.1 mm, is hit.
  const double reach = 1000.0, turn = 1e-3, rate = turn / kFrameSeconds;
  const auto tip = sphere(1e-4, {reach, 0, 0});
  const Real half = 0.5L * turn;
  // On the arc's middle; the chord passes reach (1 - cos(turn / 2)) = 1.25e-4 m nearer to the pivot.
  const Vec3 target(static_cast<double>(reach * std::cos(half)), static_cast<double>(reach * std::sin(half)),
                    0);
  Watched pair({tip}, {sphere(1e-5)});
  const auto turning = flight(0, kFrame, Vec3::Zero(), Vec3::Zero(), {0, 0, rate});
  pair.advance(0, kFrame, turning, resting(target));
  ASSERT_EQ(pair.story(), kInAndOut) << pair.list();
  const Real touch = half - 2 * std::asin(1.1e-4L / (2 * 1000.0L));
  EXPECT_TRUE(holds(pair.events[0], 0, touch / rate, 1e-13L)) << pair.list();

  Watched chord({tip}, {sphere(1e-5)});
  chord.advance(0, kFrame, turning, resting(target * static_cast<double>(std::cos(half))));
  EXPECT_EQ(chord.story(), "") << "the chord's middle is not on the path\n" << chord.list();
}

TEST(Nasty, C17_AScrewAdvancesByItsPathAlone) {
  // A drill on its own axis: the spin changes nothing. 1e5 rad/s is 3333 rad in the frame.
  for (const double rate : {0.0, 300.0, 1e5}) {
    Watched pair({box(2, 2, 2)}, {moving::placed(Cylinder{0.02, 0.5})});
    fly(pair, {0.1, 0.2, 2}, {0, 0, -30}, {0, 0, rate});
    ASSERT_FALSE(pair.events.empty()) << "rate " << rate;
    EXPECT_EQ(pair.events[0].kind, Kind::kImpact);
    EXPECT_TRUE(holds(pair.events[0], 0, 0.75L / 30)) << "rate " << rate << '\n' << pair.list();
    EXPECT_LE(widthOf(pair.events[0]), 1e-8) << "rate " << rate << '\n' << pair.list();
    EXPECT_EQ(pair.events[0].certificate, Certificate::kConfirmed) << "rate " << rate << '\n' << pair.list();
    EXPECT_EQ(pair.count(Kind::kImpact), 1) << pair.list();
  }
}

TEST(Nasty, C18_ATranslationGivenAsAScrewOfTinyAngleIsThatTranslation) {
  // 67 m in the frame; a turn of 1e-9 rad moves the 0.5 m box's flank by less than 1e-9 m.
  const auto at = [&](double angle) {
    motion::StampedPose from = turned(0, 0.25), to = turned(kFrame, 0.25);
    from.pose.position = {-33.3, 0.1, 0.2};
    to.pose.position = {33.4, 0.1, 0.2};
    to.pose.orientation = Quat(1, 0.5 * angle, 0, 0) * to.pose.orientation;  // sin x = x, cos x = 1 here
    Watched pair({box(2, 2, 2)}, {box(0.5, 0.5, 0.5)});
    pair.advance(0, kFrame, resting(), motion::straightSlerp(from, to));
    EXPECT_EQ(pair.story(), kInAndOut) << angle << '\n' << pair.list();
    return pair.events;
  };
  const std::vector<PairEvent> straight = at(0.0);
  ASSERT_EQ(straight.size(), 2u);
  // The leading corner edge lies 0.25 sqrt(2) cos(pi/4 - 0.25) before the centre.
  const Real lead = 0.25L * (std::cos(0.25L) + std::sin(0.25L)), h = static_cast<Real>(kFrame) * 1e-9L;
  const Real truth = h * (33.3L - 1 - lead) / 66.7L;
  EXPECT_TRUE(holds(straight[0], 0, truth, 1e-15L));
  for (const double angle : {1e-16, 1e-12, 1e-9}) {
    const std::vector<PairEvent> screw = at(angle);
    ASSERT_EQ(screw.size(), 2u);
    EXPECT_TRUE(holds(screw[0], 0, truth, angle / 2000 + 1e-15L)) << angle;
    EXPECT_LE(widthOf(screw[0]), 1e-9);
  }
}

TEST(Nasty, C19_HalfATurnTakesItsDocumentedArcWhateverTheQuaternionsSign) {
  // At exactly half a turn: the product's first non-zero component is positive, so +x, +y or +z. Near it: the
  // shorter arc.
  const double at = 100.0 / 180.0 * kPi;
  for (const double angle : {kPi, kPi - 1e-12, kPi + 1e-12}) {
    std::vector<PairEvent> first;
    for (const int signs : {0, 1, 2, 3}) {
      motion::StampedPose from = turned(0, 0), to = turned(kFrame, angle);
      if (angle == kPi) to.pose.orientation = Quat(0, 0, 0, 1);
      if (signs & 1) from.pose.orientation.coeffs() *= -1;
      if (signs & 2) to.pose.orientation.coeffs() *= -1;
      const RigidMotion motion = motion::straightSlerp(from, to);
      const double rate = motion.omega.z();
      EXPECT_NEAR(std::abs(rate) * kFrameSeconds, kPi, 2e-12);
      EXPECT_EQ(rate > 0, angle <= kPi) << "the shorter arc, and +z between equals";
      const TurningBar pair(motion, at);
      ASSERT_EQ(pair.story(), kInAndOut) << pair.list();
      const Real truth =
          ((rate > 0 ? static_cast<Real>(at) : kExactPi - at) - kLead) / std::abs(static_cast<Real>(rate));
      EXPECT_TRUE(holds(pair.events[0], 0, truth, 1e-13L)) << angle << '\n' << pair.list();
      if (first.empty()) first = pair.events;
      for (int i = 0; i < 2; ++i) {
        EXPECT_EQ(pair.events[i].toi_lower, first[i].toi_lower) << "q and -q are the same pose";
        EXPECT_EQ(pair.events[i].toi_upper, first[i].toi_upper);
      }
    }
  }
}

TEST(Nasty, C28_AnArcThatTouchesAPlaneFromInsideIsPossibleAndNarrow) {
  // The rod's tip circle has radius 1 exactly, and the wall stands at 1.
  const double rate = 2.0 / kFrameSeconds;
  Watched pair({box(1, 2, 2, {1.5, 0, 0})}, {sphere(0.0625, {0.9375, 0, 0})});
  const Quat back(Eigen::AngleAxisd(-1.0, Vec3::UnitZ()));
  fly(pair, Vec3::Zero(), Vec3::Zero(), {0, 0, rate}, back);
  pair.finish();
  ASSERT_GE(pair.events.size(), 1u);
  ASSERT_LE(pair.events.size(), 2u) << pair.list();
  EXPECT_EQ(pair.events[0].kind, Kind::kImpact);
  EXPECT_LE(moving::lowerOf(pair.events[0], 0), 1.0L / rate) << pair.list();
  EXPECT_GE(moving::upperOf(pair.events.back(), 0), 1.0L / rate) << pair.list();
  // 2 sqrt(2 eps / a_n) with a budget eps of 1.1e-13 m and a_n = 0.9375 rate^2 is 1e-6 / rate; steps grow
  // by 1.5.
  EXPECT_LE(moving::upperOf(pair.events.back(), 0) - moving::lowerOf(pair.events[0], 0), 1.6e-6L / rate)
      << pair.list();
}

TEST(Nasty, C34_APathThatLoopsThroughTheTargetIsHitAlthoughItsChordMisses) {
  // The chord passes 3 m above; z = 4 - 16 u + 16 u^2, u = t / h, is lowest at u = 1/2 with z = 0.
  Watched pair({box(2, 2, 2)}, {sphere(0.05)});
  motion::StampedPose from, to;
  to.stamp_ns = kFrame;
  from.has_twist = to.has_twist = true;
  from.pose.position = {-20, 0.3, 4};
  to.pose.position = {20, 0.3, 4};
  from.linear = Vec3(40, 0, -16) / kFrameSeconds;
  to.linear = Vec3(40, 0, 16) / kFrameSeconds;
  pair.advance(0, kFrame, resting(), motion::hermite(from, to));
  // It meets the side x = -1.05 at u = 0.47375, where z = 0.011.
  ASSERT_EQ(pair.story(), kInAndOut) << pair.list();
  EXPECT_TRUE(holds(pair.events[0], 0, (18.95L / 40) * static_cast<Real>(kFrame) * 1e-9L, 1e-14L))
      << pair.list();
  EXPECT_TRUE(coneHolds(pair.events[0], {-1, 0, 0})) << pair.list();
  Watched chord({box(2, 2, 2)}, {sphere(0.05)});
  chord.advance(0, kFrame, resting(), motion::straightSlerp(from, to));
  EXPECT_EQ(chord.story(), "");
}

TEST(Nasty, C35_TwoTumblingBodiesHitAndPartTwiceInOneSegmentInOrder) {
  // A bar of 2 m turns once about z; the ball tumbles about its own centre, which changes nothing but the
  // work.
  const double rate = 2 * kPi / kFrameSeconds, at = 100.0 / 180.0 * kPi;
  Watched pair({box(2, 0.04, 0.04)}, {sphere(0.05)});
  pair.advance(
      0, kFrame, flight(0, kFrame, Vec3::Zero(), Vec3::Zero(), {0, 0, rate}),
      flight(0, kFrame, {0.8 * std::cos(at), 0.8 * std::sin(at), 0}, Vec3::Zero(), {300, -200, 100}));
  ASSERT_EQ(pair.story(), std::string(kInAndOut) + ", " + kInAndOut) << pair.list();
  for (int i = 0; i < 4; ++i) {
    const Real angle = at + (i < 2 ? 0.0L : kExactPi) + (i % 2 == 0 ? -kLead : kLead);
    EXPECT_TRUE(holds(pair.events[i], 0, angle / rate, 1e-13L)) << i << '\n' << pair.list();
    EXPECT_LE(widthOf(pair.events[i]), 1e-9) << pair.list();
  }

  // Two bars at random, both tumbling: the march knows until when they are apart.
  constexpr std::uint64_t kSeed = 35;
  const moving::Shapes bar = {box(2, 0.1, 0.1)};
  int twice = 0;
  for (int i = 0; i < 40; ++i) {
    moving::Random random(kSeed, i);
    SCOPED_TRACE("seed " + std::to_string(kSeed) + " index " + std::to_string(i));
    const RigidMotion a =
        flight(0, kFrame, Vec3::Zero(), Vec3::Zero(), 300 * random.direction(), random.orientation());
    const RigidMotion b = flight(0, kFrame, 0.9 * random.direction(), 5 * random.direction(),
                                 300 * random.direction(), random.orientation());
    const oracle::Pair truth = oracle::makePair(bar, bar, a, b, 0, kFrame);
    Watched bars(bar, bar);
    bars.advance(0, kFrame, a, b);
    twice += bars.events.size() >= 4 && bars.events[0].kind == Kind::kImpact;
    Real apart_since = 0;
    bool touching = false;
    for (const PairEvent& e : bars.events) {
      ASSERT_EQ(e.certificate, Certificate::kConfirmed) << bars.list();
      ASSERT_EQ(e.kind == Kind::kSeparation, touching) << "in order\n" << bars.list();
      touching = !touching;
      if (e.kind == Kind::kImpact) {
        const oracle::FirstTouch touch = truth.firstTouch(apart_since, truth.duration());
        ASSERT_TRUE(touch.verified) << bars.list();
        ASSERT_LE(e.toi_lower, touch.hi) << bars.list();
        ASSERT_GE(e.toi_upper, touch.lo) << bars.list();
      } else if (e.kind == Kind::kSeparation) {
        ASSERT_TRUE(truth.touching(e.toi_lower)) << bars.list();
        ASSERT_FALSE(truth.touching(e.toi_upper)) << bars.list();
        apart_since = e.toi_upper;
      }
    }
  }
  EXPECT_GE(twice, 5);
}

}  // namespace
}  // namespace nasty

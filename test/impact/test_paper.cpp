// The paper's methods: right where the paper is right, and wrong by exactly what its assumptions cost.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "collision_node/geometry/body.h"
#include "collision_node/impact/paper_methods.h"

namespace collision_node::impact {
namespace {

using geometry::Body;
using geometry::Quat;
using motion::RigidMotion;

constexpr Nanoseconds kStart = 1700000000123456789;
constexpr Nanoseconds kFrame = 33333333;  // 30 Hz
constexpr double kDuration = 33333333e-9;
const InsideTest kThree = InsideTest::kThreeSigns;

std::unique_ptr<Body> bodyOf(geometry::Shape shape, const Pose& origin = {}) {
  return std::make_unique<Body>(std::vector<geometry::PlacedShape>{{std::move(shape), origin, "test"}});
}

std::unique_ptr<Body> meshOf(std::vector<Vec3> vertices, std::vector<std::array<std::int32_t, 3>> triangles) {
  auto mesh = std::make_shared<const geometry::TriangleMesh>(geometry::makeTriangleMesh(
      std::move(vertices), std::move(triangles), geometry::SolidChoice::kAuto, "test"));
  return bodyOf(geometry::Mesh{std::move(mesh)});
}

/// A square of half width 2 in the plane x = 0.
std::unique_ptr<Body> plate() {
  return meshOf({{0, -2, -2}, {0, 2, -2}, {0, 2, 2}, {0, -2, 2}}, {{0, 1, 2}, {0, 2, 3}});
}

/// Straight, or with `acceleration` curved, over one frame from kStart.
RigidMotion moving(const Vec3& from, const Vec3& velocity, const Vec3& acceleration = Vec3::Zero()) {
  RigidMotion m;
  m.start_ns = kStart;
  m.end_ns = kStart + kFrame;
  m.c[0] = from;
  m.c[1] = velocity;
  m.c[2] = 0.5 * acceleration;
  return m;
}

RigidMotion standing(const Vec3& at = Vec3::Zero()) { return motion::fixedAt({at, Quat::Identity()}); }

Piece frame(const RigidMotion& a, const RigidMotion& b) { return {kStart, kStart + kFrame, a, b}; }

struct Result {
  PieceOutcome outcome;
  PairState state;
  std::vector<PairEvent> events;
};

Result run(PaperVariant variant, const Body& a, const Body& b, const Piece& piece,
           InsideTest inside = kThree) {
  Result r;
  r.outcome = makePaper(variant, inside, a, b)->advance(piece, r.state, r.events);
  return r;
}

void expectPaperEvent(const PairEvent& e) {
  EXPECT_EQ(e.kind, Kind::kImpact);
  EXPECT_EQ(e.certificate, Certificate::kUncertified);
  EXPECT_EQ(e.reason, Reason::kMethod);
  EXPECT_EQ(e.interval_start_ns, kStart);
  EXPECT_EQ(e.interval_end_ns, kStart + kFrame);
  EXPECT_EQ(e.toi_lower, e.toi_upper);
  EXPECT_TRUE(std::isnan(e.position_error)) << "no claim about the position";
  EXPECT_NEAR(e.normal.norm(), 1.0, 1e-12);
}

TEST(PaperA, StraightShotAtAMovingMeshHasTheRightTimeAndPlace) {
  const auto target = plate();
  const auto point = bodyOf(geometry::Point{});
  // Plate drives at 15 m/s in +x and -y; the shot crosses x = 15 t at t = 40 / (2000 - 15).
  const Piece piece = frame(moving({0, 0, 0}, {15, -15, 0}), moving({-40, 0.5, 0.25}, {2000, 0, 0}));
  const Result r = run(PaperVariant::kA, *target, *point, piece);
  EXPECT_EQ(r.outcome.answer, Answer::kImpact);
  EXPECT_EQ(r.outcome.node_tests, 2u);
  ASSERT_EQ(r.events.size(), 1u);
  const PairEvent& e = r.events[0];
  expectPaperEvent(e);
  const double truth = 40.0 / 1985.0;
  EXPECT_NEAR(e.toi_lower, truth, 1e-15);
  EXPECT_LT((e.position - Vec3(15 * truth, 0.5, 0.25)).norm(), 1e-12);
  EXPECT_LT((e.normal - Vec3(-1, 0, 0)).norm(), 1e-15);
  EXPECT_LT((e.relative_velocity - Vec3(1985, 15, 0)).norm(), 1e-9);
  EXPECT_NEAR(e.closing_speed, 1985.0, 1e-9);
  EXPECT_EQ(e.a.feature, Feature::kFace);
  EXPECT_EQ(e.a.shape, 0);
  EXPECT_GE(e.a.triangle, 0);
  EXPECT_LT((e.a.point - Vec3(0, 0.5 + 15 * truth, 0.25)).norm(), 1e-12);
  EXPECT_EQ(e.b.feature, Feature::kVertex);
  EXPECT_EQ(e.b.triangle, -1);
  EXPECT_LT((e.b.pose.position - e.position).norm(), 1e-12);
  EXPECT_EQ(e.a.sample_before_ns, kStart);
  EXPECT_EQ(e.b.sample_after_ns, kStart + kFrame);
}

TEST(PaperA, SwappedArgumentsSwapTheSides) {
  const auto target = plate();
  const auto point = bodyOf(geometry::Point{});
  const RigidMotion t = standing(), p = moving({-40, 0.5, 0.25}, {2000, 0, 0});
  for (const PaperVariant variant : {PaperVariant::kA, PaperVariant::kB}) {
    const PairEvent e = run(variant, *target, *point, frame(t, p)).events.at(0);
    const PairEvent s = run(variant, *point, *target, frame(p, t)).events.at(0);
    EXPECT_EQ(e.toi_lower, s.toi_lower);
    EXPECT_EQ(e.position, s.position);
    EXPECT_EQ(e.normal, -s.normal);
    EXPECT_EQ(e.relative_velocity, -s.relative_velocity);
    EXPECT_EQ(e.closing_speed, s.closing_speed);
    EXPECT_EQ(e.a.triangle, s.b.triangle);
    EXPECT_EQ(e.a.sample_before_ns, 0) << "the target is fixed";
    EXPECT_EQ(s.a.sample_before_ns, kStart);
  }
}

TEST(PaperA, NearestOfTwoWallsIsReported) {
  const auto walls = meshOf({{1, -2, -2}, {1, 2, -2}, {1, 0, 2}, {-1, -2, -2}, {-1, 2, -2}, {-1, 0, 2}},
                            {{0, 1, 2}, {3, 4, 5}});
  const auto point = bodyOf(geometry::Point{});
  const PairEvent e =
      run(PaperVariant::kA, *walls, *point, frame(standing(), moving({-40, 0, 0}, {2000, 0, 0})))
          .events.at(0);
  EXPECT_NEAR(e.toi_lower, 39.0 / 2000.0, 1e-15);
  EXPECT_EQ(e.a.triangle, 1);
}

TEST(PaperA, MissesAreMisses) {
  const auto target = plate();
  const auto point = bodyOf(geometry::Point{});
  const auto answer = [&](const Vec3& from, const Vec3& velocity) {
    const Result r = run(PaperVariant::kA, *target, *point, frame(standing(), moving(from, velocity)));
    EXPECT_TRUE(r.events.empty());
    return r.outcome.answer;
  };
  EXPECT_EQ(answer({-40, 2.1, 0.0}, {2000, 0, 0}), Answer::kClear) << "inside the sphere, beside the plate";
  EXPECT_EQ(answer({-40, 50.0, 0.0}, {2000, 0, 0}), Answer::kCulled) << "beside the sphere";
  EXPECT_EQ(answer({-90, 0.0, 0.0}, {2000, 0, 0}), Answer::kCulled)
      << "the line meets the sphere, the path does not";
  EXPECT_EQ(answer({40, 0.0, 0.0}, {2000, 0, 0}), Answer::kCulled) << "it flies away";
  EXPECT_EQ(answer({0.5, 0.5, 0.0}, {2000, 0, 0}), Answer::kClear) << "the plate lies behind it";
  EXPECT_EQ(answer({0, -40, 0}, {0, 2000, 0}), Answer::kClear)
      << "in the plate's plane: parallel, no hit by eq. 5";
}

TEST(PaperA, AHitOnTheCutBelongsToThePieceThatEndsThere) {
  const auto target = plate();
  const auto point = bodyOf(geometry::Point{});
  const auto method = makePaper(PaperVariant::kA, kThree, *target, *point);
  const RigidMotion shot = moving({-1, 0.5, 0}, {64, 0, 0});  // meets x = 0 at 1/64 s = 15625000 ns, exactly
  PairState state;
  std::vector<PairEvent> events;
  const Nanoseconds cut = kStart + 15625000;
  method->advance({kStart, cut, standing(), shot}, state, events);
  ASSERT_EQ(events.size(), 1u);
  method->advance({cut, kStart + kFrame, standing(), shot}, state, events);
  EXPECT_EQ(events.size(), 1u) << "the next piece must not repeat it";

  PairState fresh;
  events.clear();
  method->advance({cut, kStart + kFrame, standing(), shot}, fresh, events);
  EXPECT_EQ(events.size(), 1u) << "a pair's first piece owns its start";

  method->interrupt(state, Reason::kGap, events);
  EXPECT_EQ(events.size(), 1u) << "no contact is ever open";
  EXPECT_EQ(state.phase, PairState::Phase::kNew);
}

TEST(PaperA, LimitRotationDuringThePieceIsIgnored) {
  const auto target = plate();
  const auto point = bodyOf(geometry::Point{});
  const double rate = 3.0, height = 1.5, speed = 2000.0, distance = 40.0;
  RigidMotion spinning = moving({0, 0, 0}, {0, 0, 0});
  spinning.omega = {0, 0, rate};
  const RigidMotion shot = moving({-distance, height, 0}, {speed, 0, 0});
  const PairEvent e = run(PaperVariant::kA, *target, *point, frame(spinning, shot)).events.at(0);
  const double reported = e.toi_lower;
  EXPECT_NEAR(reported, distance / speed, 1e-15) << "the plate as it stood at the piece's start";
  EXPECT_LT((e.position - Vec3(0, height, 0)).norm(), 1e-12) << "eq. 7 moves back without the rotation too";

  // In truth the plate's line is x = -y tan(rate t): -distance + speed t = -height tan(rate t).
  double truth = 0.0;
  for (int i = 0; i < 60; ++i) truth = (distance - height * std::tan(rate * truth)) / speed;
  EXPECT_NEAR(reported - truth, height * std::tan(rate * truth) / speed, 1e-15);
  EXPECT_GT(reported - truth, 40e-6) << "late by 9 cm of flight, far above any rounding";

  // A second stamp just before the hit gives the method a fresh orientation, and most of the error goes.
  const Nanoseconds cut = kStart + 19900000;
  const double from_cut =
      run(PaperVariant::kA, *target, *point, {cut, kStart + kFrame, spinning, shot}).events.at(0).toi_lower;
  EXPECT_LT(std::abs(19900000e-9 + from_cut - truth), 0.01 * (reported - truth));
}

TEST(PaperA, LimitASphereIsAParticleAndArrivesLate) {
  const auto target = bodyOf(geometry::Box{{2, 2, 2}});
  const double r = 0.05, speed = 2000.0;
  const auto shell = bodyOf(geometry::Sphere{r});
  const PairEvent e =
      run(PaperVariant::kA, *target, *shell, frame(standing(), moving({-41, 0.2, 0.1}, {speed, 0, 0})))
          .events.at(0);
  const double truth = (40.0 - r) / speed;
  EXPECT_NEAR(e.toi_lower - truth, r / speed, 1e-14);
  EXPECT_EQ(e.b.feature, Feature::kUnknown) << "the body was neglected: which part touches is not known";

  // Passing at 4 cm beside the box: the sphere touches, the particle does not.
  EXPECT_TRUE(run(PaperVariant::kA, *target, *shell, frame(standing(), moving({-41, 1.04, 0}, {speed, 0, 0})))
                  .events.empty());
}

TEST(PaperA, LimitACurvedPathIsItsChord) {
  const auto target = plate();
  const auto point = bodyOf(geometry::Point{});
  // From y = 0 over a hump of 6 m and back: the true path passes above the plate, the chord goes through it.
  const double hump = 6.0, a = -8.0 * hump / (kDuration * kDuration);
  const RigidMotion curve = moving({-33, 0, 0}, {66.0 / kDuration, -0.5 * a * kDuration, 0}, {0, a, 0});
  const Result r = run(PaperVariant::kA, *target, *point, frame(standing(), curve));
  ASSERT_EQ(r.events.size(), 1u);
  EXPECT_NEAR(r.events[0].toi_lower, 0.5 * kDuration, 1e-12);
  EXPECT_TRUE(run(PaperVariant::kB, *target, *point, frame(standing(), curve)).events.empty());
}

TEST(PaperB, LimitItsTimeIsTheEntryIntoTheBoundingSphere) {
  const auto target = plate();
  const auto point = bodyOf(geometry::Point{});
  const double speed = 2000.0, y = 0.5, z = 0.25;
  const Piece piece = frame(standing(), moving({-40, y, z}, {speed, 0, 0}));
  const Result r = run(PaperVariant::kB, *target, *point, piece);
  ASSERT_EQ(r.events.size(), 1u);
  expectPaperEvent(r.events[0]);
  const Vec3 c = target->centre();
  const double half_chord =
      std::sqrt(target->radius() * target->radius() - (y - c.y()) * (y - c.y()) - (z - c.z()) * (z - c.z()));
  ASSERT_GT(half_chord, 2.0);
  EXPECT_NEAR(r.events[0].toi_lower, (40.0 + c.x() - half_chord) / speed, 1e-14);
  EXPECT_LT(r.events[0].toi_lower, 40.0 / speed - 1e-3) << "early by more than 2 m of flight";
  EXPECT_LT((r.events[0].position - Vec3(0, y, z)).norm(), 1e-12) << "the place is the ray's";
}

TEST(PaperB, CurvedPathEntersWhereItTrulyDoes) {
  const auto target = bodyOf(geometry::Box{{2, 2, 2}});
  const auto point = bodyOf(geometry::Point{});
  const Vec3 from(-40, -2, 0), velocity(2000, 100, 0), acceleration(-3000, 4000, 20);
  const RigidMotion curve = moving(from, velocity, acceleration);
  const Result r = run(PaperVariant::kB, *target, *point, frame(standing(), curve));
  ASSERT_EQ(r.events.size(), 1u);
  const auto excess = [&](double t) {
    const Vec3 x = from + t * velocity + 0.5 * t * t * acceleration;
    return (x - target->centre()).norm() - target->radius();
  };
  const double t = r.events[0].toi_lower;
  EXPECT_NEAR(excess(t), 0.0, 1e-10);
  for (int i = 0; i < 1000; ++i) ASSERT_GT(excess(t * i / 1000.0), 0.0) << "an earlier entry at sample " << i;
  const Vec3 v = velocity + t * acceleration;
  EXPECT_LT((r.events[0].relative_velocity - v).norm(), 1e-8);
}

TEST(PaperB, LimitTheStaticTestFollowsTheTangent) {
  const auto target = plate();
  const auto point = bodyOf(geometry::Point{});
  const auto heightAtPlate = [](double y, double acceleration) {
    return y + 0.5 * acceleration * 0.02 * 0.02;
  };
  const auto events = [&](double y, double acceleration) {
    const RigidMotion curve = moving({-3, y, 0}, {150, 0, 0}, {0, acceleration, 0});  // at x = 0 after 20 ms
    return run(PaperVariant::kB, *target, *point, frame(standing(), curve)).events.size();
  };
  ASSERT_GT(heightAtPlate(1.5, 4000), 2.2) << "in truth it passes beside the plate";
  EXPECT_EQ(events(1.5, 4000), 1u) << "a false hit: the tangent at the entry leads to the plate";
  ASSERT_LT(heightAtPlate(2.3, -2000), 1.95) << "in truth it bends onto the plate";
  EXPECT_EQ(events(2.3, -2000), 0u) << "a miss: the tangent at the entry leads past it";
}

TEST(PaperB, TheRayEndsWithThePiece) {
  const auto target = plate();
  const auto point = bodyOf(geometry::Point{});
  const auto events = [&](double speed) {
    const Piece piece = frame(standing(), moving({-3.5, 0.5, 0}, {speed, 0, 0}));
    return run(PaperVariant::kB, *target, *point, piece).events.size();
  };
  EXPECT_EQ(events(3.6 / kDuration), 1u);
  EXPECT_EQ(events(3.4 / kDuration), 0u) << "it enters the sphere but stops 10 cm short of the plate";
}

TEST(PaperB, InsideTheSphereTheTimeIsThePieceStart) {
  const auto target = plate();
  const auto point = bodyOf(geometry::Point{});
  const auto method = makePaper(PaperVariant::kB, kThree, *target, *point);
  const RigidMotion slow = moving({-1, 0.5, 0}, {60, 0, 0});  // hits after 1/60 s
  PairState state;
  std::vector<PairEvent> events;
  const Nanoseconds cut = kStart + 10000000;
  EXPECT_EQ(method->advance({kStart, cut, standing(), slow}, state, events).answer, Answer::kClear)
      << "the ray ends with the piece";
  EXPECT_EQ(method->advance({cut, kStart + kFrame, standing(), slow}, state, events).answer, Answer::kImpact);
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(events[0].interval_start_ns, cut);
  EXPECT_EQ(events[0].toi_lower, 0.0);
}

TEST(InsideTriangle, TwoSignsAcceptPointsBeyondEdgeCa) {
  const std::array<Vec3, 3> abc{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
  const Vec3 beyond_ab(0.3, -0.1, 0), beyond_bc(0.6, 0.6, 0), beyond_ca(-0.1, 0.3, 0), within(0.2, 0.3, 0);
  for (const InsideTest test : {InsideTest::kThreeSigns, InsideTest::kTwoSigns}) {
    EXPECT_TRUE(insideTriangle(within, abc, test));
    EXPECT_TRUE(insideTriangle(abc[1], abc, test)) << "the boundary counts";
    EXPECT_FALSE(insideTriangle(beyond_ab, abc, test));
    EXPECT_FALSE(insideTriangle(beyond_bc, abc, test));
  }
  EXPECT_FALSE(insideTriangle(beyond_ca, abc, InsideTest::kThreeSigns));
  EXPECT_TRUE(insideTriangle(beyond_ca, abc, InsideTest::kTwoSigns));
  EXPECT_FALSE(insideTriangle(within, {abc[0], abc[1], abc[1]}, InsideTest::kThreeSigns)) << "no area";
}

TEST(InsideTriangle, AShotBeyondEdgeCaIsAFalseHitOnlyAsPrinted) {
  const auto triangle = meshOf({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}});
  const auto point = bodyOf(geometry::Point{});
  const Piece piece = frame(standing(), moving({-0.1, 0.3, 10}, {0, 0, -2000}));
  EXPECT_TRUE(run(PaperVariant::kA, *triangle, *point, piece, InsideTest::kThreeSigns).events.empty());
  EXPECT_EQ(run(PaperVariant::kA, *triangle, *point, piece, InsideTest::kTwoSigns).events.size(), 1u);
  PairState state;
  std::vector<PairEvent> events;
  makePaperA(*triangle, *point, {})->advance(piece, state, events);
  EXPECT_TRUE(events.empty()) << "the default is the charitable reading";
}

TEST(PaperTessellation, CoversEachPrimitive) {
  struct Case {
    geometry::Shape shape;
    double area;       // of the true surface [m^2]
    double tolerance;  // relative
    double depth;      // least distance of the surface from the centre [m]
  };
  const double pi = 3.14159265358979323846;
  const std::vector<Case> cases = {{geometry::Box{{1, 2, 3}}, 22.0, 1e-14, 0.5},
                                   {geometry::Sphere{2}, 16 * pi, 0.005, 2.0},
                                   {geometry::Cylinder{1, 4}, 10 * pi, 0.005, 1.0},
                                   {geometry::Capsule{1, 4}, 12 * pi, 0.005, 1.0}};
  const Pose origin{{10, 0, 0}, Quat(Eigen::AngleAxisd(0.5, Vec3(1, 2, 3).normalized()))};
  for (const Case& c : cases) {
    const auto body = bodyOf(c.shape, origin);
    const auto triangles = tessellatePrimitives(*body);
    double area = 0.0;
    for (const PaperTriangle& t : triangles) {
      const Vec3 normal = (t.corners[1] - t.corners[0]).cross(t.corners[2] - t.corners[0]);
      area += 0.5 * normal.norm();
      EXPECT_GT(normal.norm(), 0.0) << "no triangle without area";
      const double distance = std::abs(normal.normalized().dot(t.corners[0] - origin.position));
      EXPECT_GE(distance, 0.995 * c.depth) << "inscribed, within 0.5 % of the radius";
      EXPECT_LE((t.corners[0] - body->centre()).norm(), body->radius() * (1 + 1e-12));
    }
    EXPECT_NEAR(area, c.area, c.tolerance * c.area);
  }
  EXPECT_TRUE(tessellatePrimitives(*bodyOf(geometry::Point{})).empty());
  EXPECT_TRUE(tessellatePrimitives(*plate()).empty()) << "meshes are read from the body";
}

TEST(PaperRoles, TheSmallerBodyIsTheParticleAtItsCentre) {
  const auto target = plate();
  // A crate of 20 cm, off its object's origin by 1 m: the particle is the crate's centre.
  const auto crate = bodyOf(geometry::Box{{0.2, 0.2, 0.2}}, {{0, 1, 0}, Quat::Identity()});
  const PairEvent e =
      run(PaperVariant::kA, *crate, *target, frame(moving({-40, 0, 0}, {2000, 0, 0}), standing()))
          .events.at(0);
  EXPECT_NEAR(e.toi_lower, 40.0 / 2000.0, 1e-15);
  EXPECT_LT((e.position - Vec3(0, 1, 0)).norm(), 1e-12);
  EXPECT_EQ(e.a.point, Vec3(0, 1, 0));
  EXPECT_LT((e.normal - Vec3(1, 0, 0)).norm(), 1e-15) << "from a, the crate, to b, the plate";

  const auto point = bodyOf(geometry::Point{});
  EXPECT_TRUE(
      run(PaperVariant::kA, *point, *point, frame(moving({-1, 0, 0}, {60, 0, 0}), standing())).events.empty())
      << "two particles: there is no triangle to hit";
}

TEST(Names, MethodsAndConstants) {
  EXPECT_EQ(parseMethod("certified"), MethodName::kCertified);
  EXPECT_EQ(parseMethod("paper_a"), MethodName::kPaperA);
  EXPECT_EQ(parseMethod("paper_b"), MethodName::kPaperB);
  try {
    parseMethod("paperA");
    FAIL() << "unknown methods are refused";
  } catch (const std::invalid_argument& e) {
    const std::string what = e.what();
    for (const char* part : {"paperA", "certified", "paper_a", "paper_b"})
      EXPECT_NE(what.find(part), std::string::npos);
  }
  EXPECT_STREQ(toString(Kind::kInitialOverlap), "INITIAL_OVERLAP");
  EXPECT_STREQ(toString(Certificate::kPossible), "POSSIBLE");
  EXPECT_STREQ(toString(Reason::kStampGuessed), "STAMP_GUESSED");
  EXPECT_STREQ(toString(Feature::kSmooth), "SMOOTH");
}

TEST(Names, MakeMethodMakesTheNamedOne) {
  const auto target = plate();
  const auto point = bodyOf(geometry::Point{});
  const Piece piece = frame(standing(), moving({-40, 0.5, 0.25}, {2000, 0, 0}));
  const auto toi = [&](MethodName name) {
    PairState state;
    std::vector<PairEvent> events;
    makeMethod(name, *target, *point, {})->advance(piece, state, events);
    return events.at(0).toi_lower;
  };
  EXPECT_EQ(toi(MethodName::kPaperA), run(PaperVariant::kA, *target, *point, piece).events.at(0).toi_lower);
  EXPECT_EQ(toi(MethodName::kPaperB), run(PaperVariant::kB, *target, *point, piece).events.at(0).toi_lower);
}

}  // namespace
}  // namespace collision_node::impact

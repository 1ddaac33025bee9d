/// The certified solver where rounding, or a tube, is as large as what it looks at.
#include "test/impact/certified.h"

namespace collision_node::impact {
namespace {

TEST(Certified, WhoStartsWithinTheRoundingOfAMeshHasAnyNormal) {
  for (const double above : {-3e-15, -0x1p-53, 0.0, 0x1p-52, 3e-15}) {
    Watched pair({moving::boxMesh({1, 1, 1})}, {point()});
    pair.advance(0, kFrame, resting(), flight(0, kFrame, {0.3, 0.2, 1 + above}, {0.1, 0, -1}));
    ASSERT_EQ(pair.story(), "IMPACT CONFIRMED") << pair.list();
    const PairEvent& e = pair.events[0];
    EXPECT_EQ(e.normal_error, M_PI) << pair.list();
    EXPECT_GT(e.closing_speed, 0.0) << pair.list();
  }
}

TEST(Certified, AGapWiderThanABadlyToldTurnHidesIsNoContact) {
  // "8 of a tube, or of what a turn told badly adds to them": a slider leaves a block, passes another one so
  // closely that nobody can tell whether it touches, then a hole, and meets a third. With 256 the hole would
  // be too shallow.
  constexpr double kTold = 1e-2, kTop = 0.1, kBelow = 1e-3,
                   kHole = 0.3;  // [rad], [m]: a budget is some 3e-3 m
  const auto block = [](double from, double to, double top) {
    return moving::placed(geometry::Box{{to - from, 1, 1}}, {0.5 * (from + to), 0, top - 0.5});
  };
  for (double close = 5.0; close < 12.0; close += 0.5) {
    const double hole = 1.0 + close, third = hole + 0.1 * close;
    Watched pair({block(-1, 1, kTop), block(1, hole, -kBelow), block(hole, third, -kHole),
                  block(third, third + 1, kTop)},
                 {moving::placed(geometry::Box{{0.1, 0.1, 0.2}}, {0, 0, 0.1})});
    const auto end = static_cast<Nanoseconds>(1e9 * (third + 0.5));
    RigidMotion slides = flight(0, end, Vec3::Zero(), {1, 0, 0});
    slides.turn_error = kTold;
    pair.advance(0, end, resting(), slides);
    pair.finish();
    EXPECT_EQ(pair.count(Kind::kSeparation), 1) << close << '\n' << pair.list();
    EXPECT_EQ(pair.events.size(), 3) << close << '\n' << pair.list();
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
  // Without one, the rest may be shorter than a bracket: "an open question is published once, and not again
  // for each piece until it ends".
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

/// "Brackets no wider than W": 8 budgets at the speed at which the two part, which is 2.0e5 m/s (from the
/// gap in 64 bits, which grows evenly). Between support points of the cylinder that are hundreds of
/// kilometres apart, the search for closest points loses what is small.
TEST(Certified, WhatIsTinyBesideALargeCylinderPartsWithinW) {
  const moving::Shapes box = {moving::placed(
                           geometry::Box{{2.3612244313397235, 3.764622998899616, 2.5404258479118451}})},
                       cylinder = {
                           moving::placed(geometry::Cylinder{274291.23271870264, 1343790.0953274295})};
  PairOptions options;
  options.contact_distance = 0.00056850872136931824;
  options.time_precision = 4.02818e-18;
  const Piece piece{
      0, 402818,
      flight(-514703, 737554, {506314.42545848474, -5426365.9958128585, 4021727.4642905518},
             {-15409.274296228854, -1517.3644774861709, -2844.0843428303451},
             {37004.712999352887, 125744.12417284446, -178129.6076535804},
             {0.083760957389403118, 0.20582901913764667, 0.19124665991800147, 0.9560560820204288}),
      flight(-301004, 402818, {182511.94297607144, -5331758.0267427051, 3916828.0656715329},
             {-15408.93110247906, -1517.1830832186183, -2843.7302644341044}, Vec3::Zero(),
             {-0.40603297037270553, -0.3921532122304851, 0.27276561970848473, 0.77907124309184717})};
  Watched pair(box, cylinder, options);
  pair.advance(piece);
  const auto part = std::find_if(pair.events.begin(), pair.events.end(), [](const PairEvent& e) {
    return e.kind == Kind::kSeparation && std::abs(e.toi_upper - 8.25233531e-5) < 1e-11;
  });
  ASSERT_NE(part, pair.events.end()) << pair.list();
  EXPECT_EQ(part->certificate, Certificate::kConfirmed);
  EXPECT_LE(part->toi_upper - part->toi_lower, 8.204e-13);
}

/// By how much of its cone and of its ball an event is off the true normal and point.
struct Share {
  double cone = 0.0, ball = 0.0;

  void add(const PairEvent& e, const oracle::V3& normal, const oracle::V3& point) {
    const oracle::V3 lean = oracle::exact(e.normal) - normal, off = oracle::exact(e.position) - point;
    cone = std::max(cone, static_cast<double>(oracle::norm(lean)) / e.normal_error);
    ball = std::max(ball, static_cast<double>(oracle::norm(off)) / e.position_error);
  }
};

/// A cube of so many sides as a box, a hull and a mesh.
std::vector<geometry::PlacedShape> cubes(double half, const Vec3& centre) {
  std::vector<Vec3> vertices;
  std::vector<moving::Corners> triangles;
  moving::addBox(vertices, triangles, centre, Vec3::Constant(half));
  const geometry::PlacedShape made = moving::mesh(vertices, triangles);
  return {moving::placed(geometry::Box{Vec3::Constant(2 * half)}, centre),
          moving::placed(geometry::Convex{std::get<geometry::Mesh>(made.shape).mesh}), made};
}

TEST(Certified, TheConeHoldsTheNormalOfAnEdgeMuchShorterThanTheSphereThatMeetsIt) {
  // An edge of 2 mm is turned by what rounding moves its ends by, and a sphere of a kilometre swings with it.
  constexpr double kHalf = 1e-3, kRadius = 1e3, kSpeed = 10.0;
  constexpr Nanoseconds kSecond = 1'000'000'000;
  const Vec3 centre(10, 7, 3), low = centre + Vec3(kHalf, kHalf, -kHalf),
                               high = centre + Vec3::Constant(kHalf);
  moving::Random random(20261127, 2);
  Share share;
  for (int i = 0; i < 200; ++i) {
    const geometry::Quat q(Eigen::AngleAxisd(random.in(0, 3), random.direction()));
    const Vec3 way = q * Vec3(1, random.in(0.5, 1.5), 0).normalized(), middle = q * (0.5 * (low + high));
    const RigidMotion path = flight(0, kSecond, middle + (kRadius + 0.5 * kSpeed) * way, -kSpeed * way);
    for (const geometry::PlacedShape& cube : cubes(kHalf, centre)) {
      Watched pair({cube}, {sphere(kRadius)});
      pair.advance(0, kSecond, resting(Vec3::Zero(), q), path);
      ASSERT_EQ(pair.events.at(0).certificate, Certificate::kConfirmed) << pair.list();
      const PairEvent& e = pair.events[0];
      const oracle::M3 turn = oracle::rotationOf(q);
      const oracle::V3 from = turn * oracle::exact(low), edge = turn * oracle::exact(high) - from;
      const oracle::V3 at = oracle::exact(path.c[0]) + e.toi_lower * oracle::exact(path.c[1]) - from;
      const oracle::V3 foot = (oracle::dot(at, edge) / oracle::dot(edge, edge)) * edge;
      share.add(e, (1 / oracle::norm(at - foot)) * (at - foot), from + foot);
    }
  }
  EXPECT_LE(share.cone, 1.0);
  EXPECT_LE(share.ball, 1.0);
}

TEST(Certified, TheConeHoldsTheNormalOfABodyWhoseTurnIsBadlyTold) {
  // The cube may be turned by `turn_error` about any axis: onto its face, its edge and its corner.
  constexpr double kRadius = 1e5, kError = 1e-9;
  constexpr Nanoseconds kSecond = 1'000'000'000;
  moving::Random random(20261127, 3);
  Share share;
  for (int i = 0; i < 300; ++i) {
    const int sides = 1 + i % 3;
    const Vec3 way = sides == 1 ? Vec3(1, 0, 0) : sides == 2 ? Vec3(1, 0.9, 0) : Vec3(1, 0.9, 0.8);
    const Vec3 n = way.normalized(), met(1, sides == 1 ? 0.3 : 1, sides == 3 ? 1 : 0.2);
    RigidMotion told = resting();
    told.turn_error = kError;
    const RigidMotion path = flight(0, kSecond, met + (kRadius + 0.5) * n, -n);
    const oracle::M3 turn = oracle::rotationBy(kError * oracle::exact(random.direction()));
    for (const geometry::PlacedShape& cube : cubes(1.0, Vec3::Zero())) {
      Watched pair({cube}, {sphere(kRadius)});
      pair.advance(0, kSecond, told, path);
      ASSERT_EQ(pair.events.at(0).certificate, Certificate::kConfirmed) << pair.list();
      const PairEvent& e = pair.events[0];
      // In the cube's axes the sphere's centre is nearest to a face's, an edge's or the corner's point.
      const oracle::V3 at = oracle::exact(path.c[0]) + e.toi_lower * oracle::exact(path.c[1]);
      const oracle::V3 seen = {oracle::dot(turn.column[0], at), oracle::dot(turn.column[1], at),
                               oracle::dot(turn.column[2], at)};
      const oracle::V3 near = {oracle::clampTo1(seen.x), oracle::clampTo1(seen.y), oracle::clampTo1(seen.z)};
      const oracle::V3 off = seen - near;
      share.add(e, turn * ((1 / oracle::norm(off)) * off), turn * near);
    }
  }
  EXPECT_LE(share.cone, 1.0);
  EXPECT_LE(share.ball, 1.0);
}

TEST(Certified, ABodyThatMayHaveTurnedAnyWayCertifiesNothing) {
  // `motion: spin` about an axis so badly told that the number of turns is open: turn_error 2, and omega 0.
  RigidMotion told = resting();
  told.turn_error = 2.0;
  for (const auto& shape : cubes(1.0, Vec3::Zero())) {
    for (const double beside : {0.0, 1.2, 1.9}) {  // through it, past it, and beyond its reach
      for (const double radius : {0.0, 0.01}) {
        Watched pair({shape}, {radius > 0.0 ? sphere(radius) : point()});
        const PieceOutcome outcome =
            pair.advance(0, kFrame, told, flight(0, kFrame, {0.1, beside, 10}, {0, 0, -2000}));
        const bool is_out_of_reach = beside > 1.8;
        EXPECT_EQ(outcome.answer == Answer::kUndecided, !is_out_of_reach) << beside << pair.list();
        for (const PairEvent& e : pair.events)
          EXPECT_EQ(e.certificate, Certificate::kPossible) << pair.list();
      }
    }
  }
}

TEST(Certified, WhatIsTooFarAwayForSquaresOfItsSizeIsNoFault) {
  for (const double far : {1e76, 5e153, 1e160, 1e300}) {
    for (const auto& shape : {sphere(1.0), box(1.0)}) {
      Watched pair({shape}, {sphere(1.0)});
      const auto outcome =
          pair.advance(0, kFrame, resting(), flight(0, kFrame, {-far, 0, 0}, {60 * far, 0, 0}));
      EXPECT_NE(outcome.answer, Answer::kClear) << far;
    }
  }
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

}  // namespace
}  // namespace collision_node::impact

/// Nasty cases of shape: flat on flat, edge on edge, tips, triangles without area, doubled triangles, great
/// and small sizes, a million triangles.
#include "test/impact/nasty.h"

namespace nasty {
namespace {

TEST(Nasty, C07_ABoxThatSlidesFlatOnABoxIsOneTouchAndNoImpact) {
  // A nanometre deep, so that there is something to prove; and exactly flush, where there is not.
  for (const double depth : {1e-9, 0.0}) {
    Watched pair({box(2, 2, 2)}, {box(1, 1, 1)});
    for (int i = 0; i < 20; ++i) {
      const Nanoseconds from = i * kFrame, to = from + kFrame;
      const double x = -0.4 + 1.25 * kFrameSeconds * i;
      pair.advance(from, to, resting(), flight(from, to, {x, 0.2, 1.5 - depth}, {1.25, 0, 0}));
    }
    pair.finish();
    EXPECT_EQ(pair.story(), depth > 0 ? "INITIAL_OVERLAP CONFIRMED" : "INITIAL_OVERLAP POSSIBLE")
        << pair.list();
  }
}

/// A small box slides over slabs for a second, 1.5 m/s, its lower face at z = 0.
void slideOverGap(Watched& pair) {
  constexpr Nanoseconds kEnd = 1'000'000'000;
  pair.advance(0, kEnd, resting(), flight(0, kEnd, {-0.5, 0, 0.015625}, {1.5, 0, 0}));
  pair.finish();
}
PlacedShape slab(double from, double to, double top) {
  return box(to - from, 2, 1, Vec3(0.5 * (from + to), 0, top - 0.5));
}
const PlacedShape kSlider = box(0.03125, 0.03125, 0.03125);

TEST(Nasty, C07_AGapBehindAFlushStretchIsToldThoughItIsTheShorter) {
  // "proved contact but for gaps no longer than a bracket": flush for 0.2 s, over a gap for 0.05 s.
  Watched pair({slab(-1, 0, 1e-9), slab(0, 0.25, 0), slab(0.375, 1.375, 1e-9)}, {kSlider});
  slideOverGap(pair);
  ASSERT_EQ(pair.story(), "INITIAL_OVERLAP CONFIRMED, SEPARATION CONFIRMED, IMPACT CONFIRMED") << pair.list();
  EXPECT_TRUE(holds(pair.events[1], 0, 0.765625L / 1.5L)) << pair.list();
  EXPECT_TRUE(holds(pair.events[2], 0, 0.859375L / 1.5L)) << pair.list();
}

TEST(Nasty, C07_AShortGapWithinAFlushStretchIsTold) {
  // "no longer than a bracket or no wider than 256 rounding budgets": 5 ms of 0.3 s flush.
  Watched pair({slab(-1, 0, 1e-9), slab(0, 0.25, 0), slab(0.2890625, 0.5, 0), slab(0.5, 1.5, 1e-9)},
               {kSlider});
  slideOverGap(pair);
  ASSERT_EQ(pair.story(), "INITIAL_OVERLAP CONFIRMED, SEPARATION CONFIRMED, IMPACT CONFIRMED") << pair.list();
  EXPECT_TRUE(holds(pair.events[1], 0, 0.765625L / 1.5L)) << pair.list();
  EXPECT_TRUE(holds(pair.events[2], 0, 0.7734375L / 1.5L)) << pair.list();
}

TEST(Nasty, C07_limit_AGapOfAFewRoundingsWithinAFlushStretchIsContact) {
  Watched pair({slab(-1, 0, 1e-9), slab(0, 0.25, -1e-14), slab(0.25, 1.5, 1e-9)}, {kSlider});
  slideOverGap(pair);
  EXPECT_EQ(pair.story(), "INITIAL_OVERLAP CONFIRMED") << pair.list();
}

TEST(Nasty, C08_ABoxThatDropsFlatOnABoxTouchesWithItsWholeFace) {
  Watched pair({box(2, 2, 2)}, {box(1, 0.5, 1)});
  fly(pair, {0.25, 0.125, 10}, {0, 0, -2000});
  ASSERT_EQ(pair.story(), kInAndOut) << pair.list();
  const PairEvent& e = pair.events[0];
  EXPECT_TRUE(holds(e, 0, 8.5L / 2000)) << pair.list();
  // The whole patch: every corner of it is in the ball, which is no larger than it must be.
  for (const double x : {-0.5, 0.5}) {
    for (const double y : {-0.25, 0.25}) EXPECT_TRUE(ballHolds(e, {0.25 + x, 0.125 + y, 1})) << pair.list();
  }
  EXPECT_LE(e.position_error, 1.001 * std::hypot(0.5, 0.25)) << pair.list();
  EXPECT_TRUE(e.a.feature == Feature::kFace && e.b.feature == Feature::kFace) << pair.list();
  EXPECT_FALSE(e.multiple) << pair.list();
  EXPECT_LE((e.normal - Vec3(0, 0, 1)).norm(), 1e-9) << pair.list();
  EXPECT_TRUE(coneHolds(e, {0, 0, 1})) << pair.list();
  EXPECT_LE(e.normal_error, 1e-3) << pair.list();
}

TEST(Nasty, C08_limit_OfTwoMeshesOneTrianglePairIsReportedAndTheRestIsMultiple) {
  Watched pair({moving::boxMesh({1, 1, 1})}, {moving::boxMesh({0.5, 0.25, 0.5})});
  fly(pair, {0.25, 0.125, 10}, {0, 0, -2000});
  ASSERT_EQ(pair.story(), kInAndOut) << pair.list();
  const PairEvent& e = pair.events[0];
  EXPECT_TRUE(holds(e, 0, 8.5L / 2000)) << pair.list();
  EXPECT_TRUE(coneHolds(e, {0, 0, 1})) << pair.list();
  EXPECT_LE(e.normal_error, 1e-3) << pair.list();
  EXPECT_TRUE(e.multiple) << "the ball is that of one triangle pair\n" << pair.list();
  EXPECT_NEAR(e.position.z(), 1.0, 1e-6);
}

TEST(Nasty, C09_ParallelEdgesThatMeetAlongAnOverlapKeepItAllInTheBall) {
  // Ridges along x: [-1, 1] and, hanging over it, [0.4, 1.4]: they share [0.4, 1].
  const auto hull = [](const PlacedShape& mesh) {
    return moving::placed(
        collision_node::geometry::Convex{std::get<collision_node::geometry::Mesh>(mesh.shape).mesh});
  };
  Watched pair({hull(ridge(1))}, {hull(ridge(0.5, true))});
  fly(pair, {0.9, 0, 10}, {0, 0, -2000});
  ASSERT_EQ(pair.story(), kInAndOut) << pair.list();
  const PairEvent& e = pair.events[0];
  EXPECT_TRUE(holds(e, 0, 0.005L)) << pair.list();
  EXPECT_FALSE(e.multiple) << pair.list();
  EXPECT_TRUE(ballHolds(e, {0.4, 0, 0})) << pair.list();
  EXPECT_TRUE(ballHolds(e, {1, 0, 0})) << pair.list();
  EXPECT_LE(e.position_error, 0.301) << pair.list();
  EXPECT_TRUE(e.a.feature == Feature::kEdge && e.b.feature == Feature::kEdge) << pair.list();
  EXPECT_TRUE(coneHolds(e, {0, 0, 1})) << pair.list();
  // As meshes: one triangle pair, and word that there are more.
  Watched meshes({ridge(1)}, {ridge(0.5, true)});
  fly(meshes, {0.9, 0, 10}, {0, 0, -2000});
  ASSERT_EQ(meshes.story(), kInAndOut) << meshes.list();
  EXPECT_TRUE(holds(meshes.events[0], 0, 0.005L)) << meshes.list();
  EXPECT_TRUE(meshes.events[0].multiple) << meshes.list();
}

TEST(Nasty, C21_TrianglesWithoutAreaAreHit) {
  const std::vector<Vec3> line = {{-1, 0, 0}, {1, 0, 0}, {0.25, 0, 0}};
  Watched needle({moving::mesh(line, {{0, 1, 2}})}, {sphere(0.01)});
  fly(needle, {0.3, 0.002, 10}, {0, 0, -2000});
  ASSERT_EQ(needle.story(), kInAndOut) << needle.list();
  EXPECT_TRUE(holds(needle.events[0], 0, (10 - std::sqrt(1e-4L - 4e-6L)) / 2000, 1e-14L)) << needle.list();
  EXPECT_TRUE(needle.events[0].normal.allFinite());
  Watched past({moving::mesh(line, {{0, 1, 2}})}, {sphere(0.01)});
  fly(past, {0.3, 0.0101, 10}, {0, 0, -2000});
  EXPECT_EQ(past.story(), "") << past.list();

  Watched dot({moving::mesh({{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}, {{0, 1, 2}})}, {sphere(0.01)});
  fly(dot, {0.002, 0, 10}, {0, 0, -2000});
  ASSERT_EQ(dot.story(), kInAndOut) << dot.list();
  EXPECT_TRUE(dot.events[0].normal.allFinite());

  // A sliver of 1e-9 rad and a needle in an otherwise closed box.
  const double top = 1 + 1e-9;
  Watched sliver({moving::mesh({{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, {1, top, 0}},
                               {{0, 1, 2}, {0, 2, 3}, {3, 2, 4}, {0, 3, 0}})},
                 {moving::boxMesh({0.05, 0.05, 0.05})});
  fly(sliver, {0.3, 1.0, 10}, {0, 0, -2000}, {3, 2, 1});
  ASSERT_EQ(sliver.story(), kInAndOut) << sliver.list();
  EXPECT_FALSE(std::isnan(sliver.events[0].position_error));
}

TEST(Nasty, C22_DuplicatesWoundBothWaysAndHolesChangeNothing) {
  const std::vector<Vec3> corners = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, {0, 0, -1}};
  const std::vector<Corners> once = {{0, 1, 2}, {0, 2, 3}};
  const std::vector<Corners> thrice = {{0, 1, 2}, {0, 2, 3}, {0, 2, 1}, {0, 3, 2}, {0, 1, 2}};
  const std::vector<Corners> fin = {{0, 1, 2}, {0, 2, 3}, {0, 2, 4}};  // three at the edge 0-2
  for (const bool from_below : {false, true}) {
    const double up = from_below ? -1.0 : 1.0;
    for (const auto& triangles : {once, thrice, fin}) {
      Watched pair({moving::mesh(corners, triangles)}, {sphere(0.05)});
      fly(pair, {0.3, 0.1, 10 * up}, {0, 0, -2000 * up});
      if (from_below && triangles.size() == 3) continue;  // it meets the fin first
      ASSERT_EQ(pair.story(), kInAndOut) << pair.list();
      EXPECT_TRUE(holds(pair.events[0], 0, 9.95L / 2000)) << pair.list();
      EXPECT_TRUE(coneHolds(pair.events[0], {0, 0, up})) << "from a to b, back faces too";
      EXPECT_LT(pair.events[0].normal_error, 1.0);
      EXPECT_LE(widthOf(pair.events[0]), 1e-9);
    }
  }
  Watched through({moving::mesh({{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 1}})}, {point()});
  fly(through, {0.05, 0.1, 10}, {0, 0, -2000});
  EXPECT_EQ(through.story(), kInAndOut) << "two triangles in one place are one impact\n" << through.list();
  Watched hole({moving::mesh(corners, {{0, 1, 2}})}, {point()});
  fly(hole, {-0.5, 0.5, 10}, {0, 0, -2000});
  EXPECT_EQ(hole.story(), "") << "the triangle that is not there\n" << hole.list();
}

TEST(Nasty, C23_AMicrometreMeshAndAThousandKilometreMeshMeetOnTime) {
  // A cube of 2^-20 m falls on one of 2^20 m, and the same with equals: times do not change with the unit of
  // length.
  for (const double unit : {0x1p-20, 1.0, 0x1p20}) {
    Watched pair({moving::boxMesh(Vec3::Constant(unit))}, {moving::boxMesh(Vec3::Constant(0.25 * unit))});
    fly(pair, unit * Vec3(0.25, 0.125, 10), unit * Vec3(0, 0, -1000));
    ASSERT_EQ(pair.story(), kInAndOut) << unit << '\n' << pair.list();
    EXPECT_TRUE(holds(pair.events[0], 0, 0.00875L)) << unit << '\n' << pair.list();
    EXPECT_TRUE(holds(pair.events[1], 0, 0.01125L)) << unit << '\n' << pair.list();
    EXPECT_LE(widthOf(pair.events[0]), 1e-9) << pair.list();
  }
  // Beside a body of 1e6 m a rounding is 1e-10 m: the wide bracket is honest, the small cube is not lost.
  Watched mixed({moving::boxMesh(Vec3::Constant(0x1p20))}, {moving::boxMesh(Vec3::Constant(0x1p-20))});
  fly(mixed, {0.25, 0.125, 0x1p20 + 10}, {0, 0, -2000});
  ASSERT_EQ(mixed.story(), "IMPACT CONFIRMED") << mixed.list();
  EXPECT_TRUE(holds(mixed.events[0], 0, (10 - 0x1p-20L) / 2000)) << mixed.list();
  EXPECT_LE(widthOf(mixed.events[0]), 1e-9) << mixed.list();
}

TEST(Nasty, C24_AShortMoveOntoAMillimetreEdgeIsHit) {
  // 0.1 mm of path towards a triangle with 1 mm edges, edge first; the cylinder's flank comes flat on.
  const auto small = moving::mesh({{0, 0, 0}, {1e-3, 0, 0}, {0.5e-3, 0, -1e-3}}, {{0, 1, 2}});
  Watched pair({small}, {moving::placed(Cylinder{0.5, 2})});
  const Quat lying(Eigen::AngleAxisd(kPi / 2, Vec3::UnitY()));
  pair.advance(0, kSecond, resting(),
               flight(0, kSecond, {0, 0, 0.50005}, {0, 0, -1e-4}, Vec3::Zero(), lying));
  ASSERT_EQ(pair.story(), "IMPACT CONFIRMED") << pair.list();
  // 0.50005 is a double 1e-17 m off; the cylinder's turn and the small speed make a wider bracket honest.
  EXPECT_TRUE(holds(pair.events[0], 0, (static_cast<Real>(0.50005) - 0.5L) / static_cast<Real>(1e-4), 1e-12L))
      << pair.list();
  EXPECT_TRUE(coneHolds(pair.events[0], {0, 0, 1})) << pair.list();
  Watched balls({small}, {sphere(1e-3)});
  balls.advance(0, kSecond, resting(), flight(0, kSecond, {0.3e-3, 0, 1.05e-3}, {0, 0, -1e-4}));
  ASSERT_EQ(balls.story(), "IMPACT CONFIRMED") << balls.list();
}

/// A wavy sheet of 2 * cells * cells triangles over |x|, |y| <= 1.
moving::Shapes wavySheet(int cells) {
  std::vector<Vec3> vertices;
  std::vector<Corners> triangles;
  for (int i = 0; i <= cells; ++i)
    for (int j = 0; j <= cells; ++j) {
      const double x = -1 + 2.0 * i / cells, y = -1 + 2.0 * j / cells;
      vertices.push_back({x, y, 0.1 * std::sin(5 * x + 1) * std::cos(7 * y)});
    }
  for (int i = 0; i < cells; ++i)
    for (int j = 0; j < cells; ++j) {
      const int at = i * (cells + 1) + j;
      triangles.push_back({at, at + cells + 1, at + cells + 2});
      triangles.push_back({at, at + cells + 2, at + 1});
    }
  return {moving::mesh(vertices, triangles)};
}

/// Height of the sheet at (x, y), by looking at every triangle.
Real heightAt(const moving::Shapes& sheet, Real x, Real y) {
  const auto& mesh = *std::get<collision_node::geometry::Mesh>(sheet[0].shape).mesh;
  Real height = -1;
  for (const auto& t : mesh.triangles) {
    const oracle::V3 a = oracle::exact(mesh.vertices[t[0]]), b = oracle::exact(mesh.vertices[t[1]]),
                     c = oracle::exact(mesh.vertices[t[2]]);
    const Real area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    const Real u = ((x - a.x) * (c.y - a.y) - (y - a.y) * (c.x - a.x)) / area;
    const Real v = ((b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x)) / area;
    if (u >= 0 && v >= 0 && u + v <= 1) height = std::max(height, a.z + u * (b.z - a.z) + v * (c.z - a.z));
  }
  return height;
}

TEST(Nasty, C25_C36_AMillionTrianglesGiveTheBruteForceTimeAndABudgetHidesNothing) {
  const moving::Shapes target = wavySheet(708);  // 1 002 528 triangles of about 3 mm
  const Body body(target), dart({point()});
  const double x = 0.31415, y = -0.27182;
  const RigidMotion falling = flight(0, kFrame, {x, y, 10}, {0, 0, -2000});
  const Real truth = (10 - heightAt(target, x, y)) / 2000;
  PairState state;
  std::vector<PairEvent> events;
  const PieceOutcome outcome = collision_node::impact::makeCertified(body, dart, {})
                                   ->advance({0, kFrame, resting(), falling}, state, events);
  ASSERT_EQ(events.size(), 2u);
  EXPECT_EQ(events[0].certificate, Certificate::kConfirmed);
  EXPECT_TRUE(holds(events[0], 0, truth, 1e-17L));
  EXPECT_LE(widthOf(events[0]), 1e-9);
  EXPECT_LT(outcome.node_tests, 2000u) << "the hierarchy leads to the leaf";

  double last_width = 1;
  for (std::uint64_t budget = 1; budget <= 4096; budget *= 4) {
    PairOptions options;
    options.node_budget = budget;
    const auto method = collision_node::impact::makeCertified(body, dart, options);
    PairState hurried;
    std::vector<PairEvent> said;
    const PieceOutcome work = method->advance({0, kFrame, resting(), falling}, hurried, said);
    method->finish(hurried, said);
    ASSERT_FALSE(said.empty()) << "budget " << budget;
    EXPECT_EQ(said[0].kind, Kind::kImpact);
    EXPECT_TRUE(holds(said[0], 0, truth, 1e-17L)) << "budget " << budget;
    EXPECT_LE(widthOf(said[0]), last_width) << "a larger budget only shrinks the bracket, " << budget;
    last_width = widthOf(said[0]);
    if (!work.budget_met) continue;
    EXPECT_NE(work.answer, Answer::kClear);
    if (said[0].certificate == Certificate::kPossible) {
      EXPECT_EQ(said[0].reason, Reason::kBudget);
    }
  }
  EXPECT_LE(last_width, 1e-9);
}

TEST(Nasty, C26_AVertexHeadOnAgainstAVertexOrAnEdgeIsAnImpactWithItsConeOfNormals) {
  Watched tips({octahedron(0.125)}, {octahedron(0.125)});
  fly(tips, {0, 0, 10}, {0, 0, -2000});
  ASSERT_EQ(tips.story(), kInAndOut) << tips.list();
  EXPECT_TRUE(holds(tips.events[0], 0, 9.75L / 2000)) << tips.list();
  EXPECT_TRUE(ballHolds(tips.events[0], {0, 0, 0.125})) << tips.list();
  EXPECT_LE(tips.events[0].position_error, 1e-5) << tips.list();
  // Every normal between the two tips' cones is one: the octahedron's edges lean by 45 degrees.
  EXPECT_GE(tips.events[0].normal_error, 0.6) << tips.list();

  Watched edge({ridge(1)}, {octahedron(0.125)});
  fly(edge, {0.3, 0, 10}, {0, 0, -2000});
  ASSERT_EQ(edge.story(), kInAndOut) << edge.list();
  EXPECT_TRUE(holds(edge.events[0], 0, 9.875L / 2000)) << edge.list();
  EXPECT_TRUE(ballHolds(edge.events[0], {0.3, 0, 0})) << edge.list();
  EXPECT_LE(edge.events[0].position_error, 1e-5) << edge.list();
  EXPECT_TRUE(coneHolds(edge.events[0], {0, 0, 1})) << edge.list();
}

TEST(Nasty, C27_EdgesThatCrossUnderATenBillionthOfARadianAreTimedWellAndPlacedWithinTheirOverlap) {
  for (const double lean : {1e-10, 1e-6, 1e-3}) {
    // The lower edge runs from (-1, 0) to (1, 0); the upper one crosses it at x = 0.3.
    const std::vector<Vec3> upper = {{-1, -lean * 1.3, 0}, {1, lean * 0.7, 0}, {-1, -1, 1},
                                     {1, -1, 1},           {-1, 1, 1},         {1, 1, 1}};
    const std::vector<Corners> faces = {{0, 3, 1}, {0, 2, 3}, {1, 4, 0}, {1, 5, 4},
                                        {2, 5, 3}, {2, 4, 5}, {0, 4, 2}, {1, 3, 5}};
    Watched pair({ridge(1)}, {moving::mesh(upper, faces)});
    fly(pair, {0, 0, 10}, {0, 0, -2000});
    ASSERT_EQ(pair.story(), kInAndOut) << lean << '\n' << pair.list();
    const PairEvent& e = pair.events[0];
    EXPECT_TRUE(holds(e, 0, 0.005L)) << lean << '\n' << pair.list();
    EXPECT_LE(widthOf(e), 1e-9) << pair.list();
    if (!e.multiple) {
      EXPECT_TRUE(ballHolds(e, {0.3, 0, 0})) << lean << '\n' << pair.list();
    }
    EXPECT_LE(e.position_error, lean < 1e-5 ? 1.42 : 0.01) << "capped by the edges\n" << pair.list();
  }
}

TEST(Nasty, C30_AMeshDeepInsideAMeshOverlapsWhenItIsASolidAndNotWhenItIsASurface) {
  const auto small = moving::boxMesh({0.1, 0.1, 0.1});
  const auto drift = flight(0, kFrame, {0.2, 0.1, 0}, {0, 0, 1});
  Watched solid({moving::boxMesh({1, 1, 1})}, {small});
  solid.advance(0, kFrame, resting(), drift);
  EXPECT_EQ(solid.story(), "INITIAL_OVERLAP CONFIRMED") << solid.list();
  Watched surface({moving::boxMesh({1, 1, 1}, Vec3::Zero(), SolidChoice::kNo)}, {small});
  surface.advance(0, kFrame, resting(), drift);
  EXPECT_EQ(surface.story(), "") << surface.list();
  surface.advance(kFrame, 2 * kFrame, resting(), flight(kFrame, 2 * kFrame, {0.2, 0.1, 0}, {0, 0, 100}));
  ASSERT_EQ(surface.story(), kInAndOut) << "from inside: " << surface.list();
  EXPECT_TRUE(holds(surface.events[0], kFrame, 0.009L)) << surface.list();
  EXPECT_TRUE(holds(surface.events[1], kFrame, 0.011L)) << surface.list();
}

}  // namespace
}  // namespace nasty

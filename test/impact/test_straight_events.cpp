// What the solver reports of points and spheres on straight paths: events in order, and facts that hold the
// truth.
#include <gtest/gtest.h>

#include "test/impact/watched_pair.h"

namespace moving {
namespace {

using collision_node::geometry::Point;
using collision_node::geometry::Sphere;
using collision_node::impact::Feature;

/// A flight of one frame past a resting body, and what comes of it. `swap`: the flying object is a.
struct Flown {
  Flown(const Shapes& standing, const Shapes& flying, const Vec3& from, const Vec3& to, bool swap = false,
        const PairOptions& options = {})
      : watched(swap ? flying : standing, swap ? standing : flying, options) {
    const RigidMotion moves = flight(0, kFrame, from, (to - from) / (static_cast<double>(kFrame) * 1e-9));
    watched.advance(0, kFrame, swap ? moves : resting(), swap ? resting() : moves);
  }
  const PairEvent& event(std::size_t i) const { return watched.events.at(i); }
  Watched watched;
};

Real shareOfFrame(Real share) { return share * kFrame * 1e-9L; }

TEST(StraightEvents, APointThroughASurfaceComesAndGoesInOneBracket) {
  for (const bool swap : {false, true}) {
    const Flown flown({sheet(1.0)}, {placed(Point{})}, {0.3, -0.2, 3}, {0.3, -0.2, -1}, swap);
    ASSERT_EQ(flown.watched.story(), kInAndOut) << flown.watched.list();
    const PairEvent &in = flown.event(0), &out = flown.event(1);
    EXPECT_TRUE(holds(in, 0, shareOfFrame(0.75L)));
    EXPECT_EQ(in.toi_lower, out.toi_lower);
    EXPECT_EQ(in.toi_upper, out.toi_upper);
    EXPECT_LE((in.position - Vec3(0.3, -0.2, 0)).norm(), in.position_error);
    EXPECT_LT(in.position_error, 1e-6);
    EXPECT_LE((in.normal - Vec3(0, 0, swap ? -1 : 1)).norm(), in.normal_error + 1e-15);
    EXPECT_LT(in.normal_error, 1e-12);
    EXPECT_GT(in.closing_speed, 0.0);
    EXPECT_EQ((swap ? in.b : in.a).feature, Feature::kFace);
    EXPECT_EQ((swap ? in.b : in.a).triangle, 0);
    EXPECT_EQ((swap ? in.a : in.b).feature, Feature::kVertex);
    EXPECT_FALSE(in.multiple);
  }
}

TEST(StraightEvents, TheConeHoldsTheNormalOfAMeshThatIsPlacedFarFromItsBodysOrigin) {
  Random random(20261127, 0);
  using Long = Eigen::Matrix<Real, 3, 1>;
  for (int i = 0; i < 200; ++i) {
    const Quat turn = random.orientation();
    PlacedShape box = boxMesh({1, 1, 1});
    box.origin = {random.decade(-1, 7) * random.direction(), turn};
    const Real x = turn.x(), y = turn.y(), z = turn.z(), w = turn.w(), n2 = x * x + y * y + z * z + w * w;
    const Long up(2 * (x * z + w * y) / n2, 2 * (y * z - w * x) / n2, 1 - 2 * (x * x + y * y) / n2);
    const Vec3 out = up.cast<double>(), hit = box.origin.position + turn * Vec3(0.3, 0.2, 1);
    const Flown flown({box}, {placed(Point{})}, hit + 0.5 * out, hit - 0.5 * out);
    ASSERT_EQ(flown.watched.story(), "IMPACT CONFIRMED") << flown.watched.list();
    const PairEvent& in = flown.event(0);
    EXPECT_LE(up.cross(in.normal.cast<Real>()).norm(), in.normal_error) << flown.watched.list();
    EXPECT_LE(in.normal_error, 1e-13 + 1e-14 * box.origin.position.norm());
  }
}

TEST(StraightEvents, APointThroughASolidHasAnEntryAndAnExit) {
  const Flown flown({boxMesh({1, 1, 1})}, {placed(Point{})}, {3, 0.2, 0.1}, {-3, 0.2, 0.1});
  ASSERT_EQ(flown.watched.story(), kInAndOut) << flown.watched.list();
  EXPECT_TRUE(holds(flown.event(0), 0, shareOfFrame(1.0L / 3)));
  EXPECT_TRUE(holds(flown.event(1), 0, shareOfFrame(2.0L / 3)));
  EXPECT_LT(widthOf(flown.event(0)), 1e-9);
  EXPECT_LT(widthOf(flown.event(1)), 1e-8);
}

TEST(StraightEvents, EverySheetThatAPointCrossesHasItsEvents) {
  Shapes sheets;
  for (int i = 0; i < 7; ++i) sheets.push_back(sheet(1.0, Vec3(0, 0, 0.001 * i)));
  const Flown flown(sheets, {placed(Point{})}, {0.3, -0.2, 2}, {0.3, -0.2, -2});
  ASSERT_EQ(flown.watched.events.size(), 14u) << flown.watched.list();
  for (int i = 0; i < 7; ++i) {
    const PairEvent& in = flown.event(static_cast<std::size_t>(2 * i));
    EXPECT_EQ(in.certificate, Certificate::kConfirmed);
    EXPECT_TRUE(holds(in, 0, shareOfFrame((2.0L - 0.001L * (6 - i)) / 4), 1e-12L)) << i;
    EXPECT_EQ(in.a.shape, 6 - i);
  }
}

TEST(StraightEvents, ThroughAnEdgeOrAVertexTheFeatureIsSaidAndTheConeHoldsAllFaces) {
  const Flown edge({sheet(1.0)}, {placed(Point{})}, {0.25, 0.25, 3}, {0.25, 0.25, -1});
  ASSERT_EQ(edge.watched.story(), kInAndOut) << edge.watched.list();
  EXPECT_EQ(edge.event(0).a.feature, Feature::kEdge);
  const double slope = 0.5;
  const Shapes roof = {mesh({{0, 0, 0}, {1, 0, -slope}, {0, 1, -slope}, {-1, 0, -slope}, {0, -1, -slope}},
                            {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 1}})};
  const Flown vertex(roof, {placed(Point{})}, {0, 0, 3}, {0, 0, -1});
  ASSERT_EQ(vertex.watched.story(), kInAndOut) << vertex.watched.list();
  EXPECT_EQ(vertex.event(0).a.feature, Feature::kVertex);
  for (const double x : {-1.0, 1.0}) {
    for (const double y : {-1.0, 1.0}) {
      const Vec3 face = Vec3(x * slope, y * slope, 1).normalized();
      EXPECT_LE(2.0 * std::asin(0.5 * (vertex.event(0).normal - face).norm()),
                vertex.event(0).normal_error + 1e-12);
    }
  }
}

TEST(StraightEvents, ASphereTouchesAFaceAnEdgeAndACornerWhereItShould) {
  const double r = 0.05;
  for (const bool swap : {false, true}) {
    const Flown face({boxMesh({1, 1, 1})}, {placed(Sphere{r})}, {0.2, 0.3, 4}, {0.2, 0.3, 0}, swap);
    const PairEvent& on_face = face.event(0);
    EXPECT_EQ(on_face.certificate, Certificate::kConfirmed);
    EXPECT_TRUE(holds(on_face, 0, shareOfFrame((3.0L - r) / 4)));
    EXPECT_LE((on_face.position - Vec3(0.2, 0.3, 1)).norm(), on_face.position_error);
    EXPECT_LT(on_face.position_error, 1e-6);
    EXPECT_LE((on_face.normal - Vec3(0, 0, swap ? -1 : 1)).norm(), on_face.normal_error + 1e-15);
    EXPECT_EQ((swap ? on_face.a : on_face.b).feature, Feature::kSmooth);
    EXPECT_EQ((swap ? on_face.b : on_face.a).feature, Feature::kFace);
    EXPECT_FALSE(on_face.multiple);

    // Off by 3 cm in x: 4 cm of height are left of the sphere's 5.
    const Flown edge({boxMesh({1, 1, 1})}, {placed(Sphere{r})}, {1.03, 0.3, 4}, {1.03, 0.3, 0}, swap);
    const PairEvent& on_edge = edge.event(0);
    EXPECT_TRUE(holds(on_edge, 0, shareOfFrame((3.0L - 0.04L) / 4), 1e-15L));
    EXPECT_LE((on_edge.position - Vec3(1, 0.3, 1)).norm(), on_edge.position_error);
    EXPECT_EQ((swap ? on_edge.b : on_edge.a).feature, Feature::kEdge);
    EXPECT_FALSE(on_edge.multiple);
    const Vec3 lean = (swap ? -1.0 : 1.0) * Vec3(0.6, 0, 0.8);
    EXPECT_LE((on_edge.normal - lean).norm(), on_edge.normal_error + 1e-15);
  }
}

TEST(StraightEvents, ASphereThatLandsInAGrooveTouchesInTwoPlaces) {
  const Shapes groove = {mesh({{0, -2, 0}, {0, 2, 0}, {1, -2, 1}, {1, 2, 1}, {-1, -2, 1}, {-1, 2, 1}},
                              {{0, 2, 1}, {1, 2, 3}, {0, 1, 4}, {1, 5, 4}})};
  const Flown flown(groove, {placed(Sphere{0.25})}, {0, 0.3, 2}, {0, 0.3, 0}, false,
                    {1e-9, 1e-6, 0.0, 4000000, collision_node::impact::Scope::kFirstContact});
  ASSERT_EQ(flown.watched.events.size(), 1u);
  EXPECT_TRUE(flown.event(0).multiple);
}

TEST(StraightEvents, AContactDistanceMakesAPointASphere) {
  PairOptions options;
  options.contact_distance = 0.125;
  const Flown flown({sheet(1.0)}, {placed(Point{})}, {0.3, -0.2, 2}, {0.3, -0.2, -2}, false, options);
  ASSERT_EQ(flown.watched.story(), kInAndOut) << flown.watched.list();
  EXPECT_TRUE(holds(flown.event(0), 0, shareOfFrame((2.0L - 0.125L) / 4)));
  EXPECT_TRUE(holds(flown.event(1), 0, shareOfFrame((2.0L + 0.125L) / 4)));
}

}  // namespace
}  // namespace moving

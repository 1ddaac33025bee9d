#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "collision_node/messages/body_triangles.h"
#include "collision_node/messages/markers.h"
#include "test/messages/sample_event.h"

namespace collision_node::messages {
namespace {

using visualization_msgs::Marker;
using visualization_msgs::MarkerArray;

scene::Object boxObject(const std::string& name, scene::PoseSource::Type type) {
  scene::Object object;
  object.name = name;
  object.source.type = type;
  object.source.fixed.position = {7, 0, 0};
  scene::Link link;
  link.name = name + "_link";
  link.T_o_l.position = {0, 0, 1};
  link.shapes.push_back({geometry::Box{geometry::Vec3(1, 2, 3)}, geometry::Pose{}, "box"});
  object.links.push_back(link);
  link.name = name + "_other";
  link.T_o_l.position = {0, 0, 5};
  object.links.push_back(link);
  return object;
}

std::shared_ptr<const scene::Scene> twoBoxes() {
  auto out = std::make_shared<scene::Scene>();
  out->objects = {boxObject("a", scene::PoseSource::Type::kTopic),
                  boxObject("b", scene::PoseSource::Type::kFixed)};
  return out;
}

scene::Event impactEvent() {
  scene::Event e = test::sampleEvent();
  e.epoch = 0;
  e.event_id = 0x1'8000'0005;
  e.kind = impact::Kind::kImpact;
  e.certificate = impact::Certificate::kConfirmed;
  e.position_error = 1e-9;
  e.a.pose = {{0, 0, 1}, geometry::Quat::Identity()};
  return e;
}

const Marker* find(const MarkerArray& array, const std::string& ns) {
  const auto found =
      std::find_if(array.markers.begin(), array.markers.end(), [&](const Marker& m) { return m.ns == ns; });
  return found == array.markers.end() ? nullptr : &*found;
}

TEST(Markers, startClearsAndDrawsFixedObjects) {
  Markers markers(twoBoxes());
  const MarkerArray array = markers.start(ros::Time(5));
  ASSERT_EQ(array.markers.size(), 3u);
  EXPECT_EQ(array.markers[0].action, Marker::DELETEALL);
  EXPECT_EQ(array.markers[0].ns, "");
  EXPECT_EQ(array.markers[0].header.frame_id, "world");
  EXPECT_EQ(array.markers[1].ns, "body");
  EXPECT_EQ(array.markers[1].pose.position.x, 7.0);
  EXPECT_EQ(array.markers[1].points.size(), 36u);
}

TEST(Markers, whatIsInNoPairIsNotDrawn) {
  auto scene = std::make_shared<scene::Scene>(*twoBoxes());
  scene->objects.push_back(boxObject("c", scene::PoseSource::Type::kFixed));
  scene->pairs = {{0, 0, 1, 0, 0.0}};
  const MarkerArray array = Markers(scene).start(ros::Time(5));
  EXPECT_EQ(array.markers.size(), 3u) << "all is cleared, and the two links of b";
}

TEST(Markers, anEventShowsPointNormalBoundLabelAndBodies) {
  Markers markers(twoBoxes());
  const scene::Event e = impactEvent();
  const MarkerArray array = markers.event(e);
  for (const Marker& m : array.markers) {
    EXPECT_EQ(m.header.frame_id, "world");
    EXPECT_EQ(m.pose.orientation.w, 1.0) << m.ns;
    EXPECT_FALSE(m.frame_locked);
  }
  const Marker* point = find(array, "impact/point");
  ASSERT_NE(point, nullptr);
  EXPECT_EQ(point->id, 5) << "low 31 bits of event_id";
  EXPECT_EQ(point->color.r, 1.0F);
  EXPECT_EQ(point->color.g, 0.0F);
  EXPECT_EQ(point->color.b, 0.0F);
  EXPECT_EQ(point->header.stamp.toNSec(), static_cast<std::uint64_t>(e.stamp_ns));
  ASSERT_NE(find(array, "impact/normal"), nullptr);
  ASSERT_NE(find(array, "impact/bound"), nullptr);
  EXPECT_EQ(find(array, "impact/bound")->scale.x, MarkerOptions().min_size);
  EXPECT_NE(find(array, "impact/label")->text.find("drawn larger"), std::string::npos);
  // Both links of the moving object, placed from the one that was hit: that one lies at (0, 0, 1).
  const auto bodies =
      std::count_if(array.markers.begin(), array.markers.end(), [](auto& m) { return m.ns == "body"; });
  EXPECT_EQ(bodies, 2);
  EXPECT_EQ(find(array, "body")->header.frame_id, "world");
}

TEST(Markers, theOtherLinksStandWhereTheObjectStands) {
  auto scene = std::make_shared<scene::Scene>(*twoBoxes());
  Markers markers(scene);
  scene::Event e = impactEvent();
  e.a.link = "a_other";
  e.a.pose = {{0, 0, 5}, geometry::Quat::Identity()};
  const MarkerArray array = markers.event(e);
  EXPECT_EQ(find(array, "body")->pose.position.z, 1.0);
}

TEST(Markers, onlyAConfirmedImpactIsRed) {
  Markers markers(twoBoxes());
  scene::Event e = impactEvent();
  e.certificate = impact::Certificate::kPossible;
  EXPECT_GT(find(markers.event(e), "impact/point")->color.g, 0.0F);
  e = impactEvent();
  e.kind = impact::Kind::kSeparation;
  EXPECT_LT(find(markers.event(e), "impact/point")->color.r, 0.5F);
  e.kind = impact::Kind::kInitialOverlap;
  e.normal = geometry::Vec3::Constant(std::nan(""));
  EXPECT_EQ(find(markers.event(e), "impact/normal"), nullptr);
}

TEST(Markers, aLargeBallIsDrawnTrue) {
  Markers markers(twoBoxes());
  scene::Event e = impactEvent();
  e.position_error = 4.0;
  const MarkerArray array = markers.event(e);
  EXPECT_EQ(find(array, "impact/bound")->scale.x, 8.0);
  EXPECT_EQ(find(array, "impact/label")->text.find("drawn larger"), std::string::npos);
}

TEST(Markers, aNewEpochClearsFirst) {
  Markers markers(twoBoxes());
  scene::Event e = impactEvent();
  EXPECT_NE(markers.event(e).markers.front().action, Marker::DELETEALL);
  e.epoch = 1;
  EXPECT_EQ(markers.event(e).markers.front().action, Marker::DELETEALL);
  EXPECT_NE(markers.event(e).markers.front().action, Marker::DELETEALL);
}

TEST(Markers, theOldestEventMakesRoom) {
  MarkerOptions options;
  options.max_events = 2;
  Markers markers(twoBoxes(), options);
  scene::Event e = impactEvent();
  for (std::uint64_t id = 0; id < 3; ++id) {
    e.event_id = id;
    const MarkerArray array = markers.event(e);
    const auto deleted = std::count_if(array.markers.begin(), array.markers.end(),
                                       [](auto& m) { return m.action == Marker::DELETE; });
    EXPECT_EQ(deleted, id == 2 ? 4 : 0);
    if (id == 2) {
      EXPECT_EQ(array.markers.front().id, 0);
    }
  }
}

/// Volume by the divergence theorem: wrong winding or a hole changes it.
double volume(const geometry::Shape& shape) {
  const auto points =
      drawnTriangles({shape, geometry::Pose{{1, 2, 3}, geometry::Quat(0.5, 0.5, 0.5, 0.5)}, ""});
  double six = 0;
  for (std::size_t i = 0; i + 2 < points.size(); i += 3)
    six += points[i].dot(points[i + 1].cross(points[i + 2]));
  return six / 6;
}

TEST(BodyTriangles, areClosedAndFaceOutward) {
  const double pi = std::acos(-1.0);
  EXPECT_NEAR(volume(geometry::Box{geometry::Vec3(1, 2, 3)}), 6.0, 1e-12);
  EXPECT_NEAR(volume(geometry::Sphere{2.0}), 4.0 / 3.0 * pi * 8, 2.0);
  EXPECT_NEAR(volume(geometry::Cylinder{1.0, 3.0}), 3 * pi, 0.15);
  EXPECT_NEAR(volume(geometry::Capsule{1.0, 3.0}), 3 * pi + 4.0 / 3.0 * pi, 0.35);
  EXPECT_NEAR(volume(geometry::Point{}), 4.0 / 3.0 * 0.02 * 0.02 * 0.02, 1e-12);
}

}  // namespace
}  // namespace collision_node::messages

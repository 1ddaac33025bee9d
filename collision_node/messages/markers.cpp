#include "collision_node/messages/markers.h"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "collision_node/messages/body_triangles.h"
#include "collision_node/messages/convert.h"
#include "collision_node/messages/event_text.h"
#include "collision_node/scene/needs.h"

namespace collision_node::messages {

namespace {

using visualization_msgs::Marker;

std_msgs::ColorRGBA colour(float r, float g, float b, float a) {
  std_msgs::ColorRGBA out;
  out.r = r;
  out.g = g;
  out.b = b;
  out.a = a;
  return out;
}

std_msgs::ColorRGBA colourOf(const scene::Event& event) {
  if (event.certificate == impact::Certificate::kPossible) return colour(1.0F, 0.6F, 0.0F, 1.0F);
  if (event.certificate == impact::Certificate::kUncertified) return colour(1.0F, 0.0F, 1.0F, 1.0F);
  switch (event.kind) {
    case impact::Kind::kImpact:
      return colour(1.0F, 0.0F, 0.0F, 1.0F);
    case impact::Kind::kSeparation:
      return colour(0.1F, 0.3F, 1.0F, 1.0F);
    case impact::Kind::kInitialOverlap:
      return colour(1.0F, 1.0F, 0.0F, 1.0F);
  }
  return colour(1.0F, 1.0F, 1.0F, 1.0F);
}

/// Muted, so that no body can be taken for an impact.
std_msgs::ColorRGBA bodyColour(std::size_t object) {
  static const float palette[][3] = {{0.55F, 0.47F, 0.58F}, {0.45F, 0.52F, 0.60F}, {0.66F, 0.60F, 0.45F},
                                     {0.35F, 0.55F, 0.52F}, {0.48F, 0.55F, 0.34F}, {0.62F, 0.62F, 0.62F}};
  const auto& c = palette[object % (sizeof palette / sizeof palette[0])];
  return colour(c[0], c[1], c[2], 0.65F);
}

Marker marker(const char* name_space, std::int32_t id, std::int32_t type, const std::string& frame) {
  Marker out;
  out.header.frame_id = frame;
  out.ns = name_space;
  out.id = id;
  out.type = type;
  out.action = Marker::ADD;
  out.pose.orientation.w = 1.0;
  return out;
}

void setScale(Marker& marker, double x, double y, double z) {
  marker.scale.x = x;
  marker.scale.y = y;
  marker.scale.z = z;
}

std::string nameOf(const scene::EventSide& side) {
  std::string out = side.object;
  if (side.link != side.object && !side.link.empty()) out += "/" + side.link;
  if (!side.zone.empty()) out += " [" + side.zone + (side.zone_certain ? "]" : "?]");
  return out;
}

std::string label(const scene::Event& event, bool enlarged) {
  char bounds[120];
  std::snprintf(bounds, sizeof bounds, "\n%.2g s wide, ball %.2g m%s", event.toi_upper - event.toi_lower,
                event.position_error, enlarged ? " (drawn larger)" : "");
  return std::string(impact::toString(event.kind)) + " " + nameOf(event.a) + " - " + nameOf(event.b) + "\n" +
         secondsText(event.stamp_ns) + " s" + bounds;
}

const char* const kEventSpaces[] = {"impact/point", "impact/normal", "impact/bound", "impact/label"};

}  // namespace

Markers::Markers(std::shared_ptr<const scene::Scene> scene, MarkerOptions options)
    : scene_(std::move(scene)), options_(options) {}

void Markers::makeBodies() {
  if (!body_of_link_.empty()) return;
  const std::vector<scene::Need> needs = scene::needsOf(*scene_);
  for (std::size_t o = 0; o < scene_->objects.size(); ++o) {
    std::vector<int> of_link;
    for (const auto& link : scene_->objects[o].links) {
      of_link.push_back(-1);
      if (needs[o] != scene::Need::kWatched) continue;
      Marker body = marker("body", static_cast<std::int32_t>(bodies_.size()), Marker::TRIANGLE_LIST,
                           scene_->world_frame);
      for (const auto& shape : link.shapes)
        for (const Vec3& v : drawnTriangles(shape)) body.points.push_back(toPoint(v));
      if (body.points.empty()) continue;
      of_link.back() = static_cast<int>(bodies_.size());
      body.color = bodyColour(o);
      body.lifetime = ros::Duration(options_.lifetime);
      setScale(body, 1.0, 1.0, 1.0);
      bodies_.push_back(std::move(body));
    }
    body_of_link_.push_back(std::move(of_link));
  }
}

void Markers::addBody(std::size_t object, const Pose& pose, const ros::Time& stamp, Array& out) const {
  const auto& links = scene_->objects[object].links;
  for (std::size_t l = 0; l < links.size(); ++l) {
    if (body_of_link_[object][l] < 0) continue;
    Marker body = bodies_[static_cast<std::size_t>(body_of_link_[object][l])];
    body.header.stamp = stamp;
    body.pose = toPose(pose * links[l].T_o_l);
    out.markers.push_back(std::move(body));
  }
}

void Markers::addSide(const scene::EventSide& side, const ros::Time& stamp, Array& out) const {
  for (std::size_t o = 0; o < scene_->objects.size(); ++o) {
    const scene::Object& object = scene_->objects[o];
    if (object.name != side.object || object.source.type == scene::PoseSource::Type::kFixed) continue;
    for (const auto& link : object.links)
      if (link.name == side.link) addBody(o, side.pose * link.T_o_l.inverse(), stamp, out);
  }
}

void Markers::addStart(const ros::Time& stamp, Array& out) {
  Marker clear = marker("", 0, Marker::SPHERE, scene_->world_frame);
  clear.header.stamp = stamp;
  clear.action = Marker::DELETEALL;
  out.markers.push_back(clear);
  shown_.clear();
  for (std::size_t o = 0; o < scene_->objects.size(); ++o)
    if (scene_->objects[o].source.type == scene::PoseSource::Type::kFixed)
      addBody(o, scene_->objects[o].source.fixed, stamp, out);
}

Markers::Array Markers::start(const ros::Time& stamp) {
  makeBodies();
  Array out;
  addStart(stamp, out);
  return out;
}

Markers::Array Markers::event(const scene::Event& event) {
  makeBodies();
  Array out;
  const ros::Time stamp = toTime(event.stamp_ns);
  if (event.epoch != epoch_) {
    epoch_ = event.epoch;
    addStart(stamp, out);
  }
  const auto id = static_cast<std::int32_t>(event.event_id & 0x7fffffffU);
  if (shown_.size() == std::max<std::size_t>(options_.max_events, 1)) {
    for (const char* space : kEventSpaces) {
      Marker old = marker(space, shown_.front(), Marker::SPHERE, scene_->world_frame);
      old.header.stamp = stamp;
      old.action = Marker::DELETE;
      out.markers.push_back(old);
    }
    shown_.pop_front();
  }
  shown_.push_back(id);

  addSide(event.a, stamp, out);
  addSide(event.b, stamp, out);

  const auto add = [&](Marker m) {
    m.header.stamp = stamp;
    m.lifetime = ros::Duration(options_.lifetime);
    out.markers.push_back(std::move(m));
  };
  const std::string& frame = scene_->world_frame;
  const std_msgs::ColorRGBA paint = colourOf(event);
  const bool enlarged = !(2.0 * event.position_error >= options_.min_size);
  const double size = enlarged ? options_.min_size : 2.0 * event.position_error;

  Marker point = marker(kEventSpaces[0], id, Marker::SPHERE, frame);
  point.pose.position = toPoint(event.position);
  setScale(point, options_.min_size, options_.min_size, options_.min_size);
  point.color = paint;
  add(point);

  if (event.normal.allFinite() && event.normal.squaredNorm() > 0.0) {
    Marker normal = marker(kEventSpaces[1], id, Marker::ARROW, frame);
    normal.points = {toPoint(event.position),
                     toPoint(event.position + 4.0 * options_.min_size * event.normal)};
    setScale(normal, 0.2 * options_.min_size, 0.5 * options_.min_size, 0.6 * options_.min_size);
    normal.color = paint;
    add(normal);
  }

  Marker bound = marker(kEventSpaces[2], id, Marker::CUBE, frame);
  bound.pose.position = toPoint(event.position);
  setScale(bound, size, size, size);
  bound.color = paint;
  bound.color.a = 0.2F;
  add(bound);

  if (event.kind == impact::Kind::kSeparation) return out;  // its label would cover that of the impact
  Marker text = marker(kEventSpaces[3], id, Marker::TEXT_VIEW_FACING, frame);
  text.pose.position = toPoint(event.position + Vec3(0.0, 0.0, size + options_.min_size));
  text.scale.z = 0.8 * options_.min_size;
  text.color = paint;
  text.text = label(event, enlarged);
  add(text);
  return out;
}

}  // namespace collision_node::messages

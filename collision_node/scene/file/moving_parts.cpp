#include "collision_node/scene/file/moving_parts.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace collision_node::scene {

namespace {

using Kind = geometry::UrdfJoint::Kind;

bool beginsPart(const Link& link) { return link.parent.empty() || link.joint.kind != Kind::kFixed; }

const Link& findLink(const Object& object, const std::string& name) {
  return *std::find_if(object.links.begin(), object.links.end(),
                       [&](const Link& link) { return link.name == name; });
}

/// The first link of the part that holds `link`; `place` becomes that one <- link.
const Link& firstOfPart(const Object& whole, const Link& link, Pose& place) {
  const Link* at = &link;
  place = Pose();
  for (; !beginsPart(*at); at = &findLink(whole, at->parent)) place = at->T_parent_l * place;
  return *at;
}

}  // namespace

std::vector<Object> cutIntoParts(const Object& whole) {
  std::map<std::string, bool> has_shape;  // by first link
  std::map<std::string, std::string> part_of;
  Pose place;
  for (const Link& link : whole.links) {
    const std::string& first = firstOfPart(whole, link, place).name;
    part_of[link.name] = first;
    has_shape[first] = has_shape[first] || !link.shapes.empty();
  }
  std::vector<Object> parts;
  for (const Link& first : whole.links) {
    if (!beginsPart(first)) continue;
    const bool is_root = first.parent.empty();
    if (!is_root && !has_shape[first.name]) continue;
    Object part = whole;
    part.part = first.name;
    part.links.clear();
    part.zones.clear();
    part.movable_joints.clear();
    for (Link link : whole.links) {
      const std::string& own = part_of[link.name];
      const bool comes_along = is_root && !has_shape[own];
      if (own != first.name && !comes_along) continue;
      if (own == first.name) firstOfPart(whole, link, link.T_o_l);
      part.links.push_back(link);
      for (const Zone& zone : whole.zones)
        if (zone.link == link.name) part.zones.push_back(zone);
    }
    parts.push_back(std::move(part));
  }
  return parts;
}

std::vector<PartJoint> jointsTo(const Object& whole, const std::string& part) {
  std::vector<PartJoint> joints;
  for (const Link* at = &findLink(whole, part); !at->parent.empty();) {
    const Link& before = findLink(whole, at->parent);
    Pose place;
    const Link& first = firstOfPart(whole, before, place);
    joints.push_back({at->joint, place * at->T_parent_l});
    at = &first;
  }
  std::reverse(joints.begin(), joints.end());
  return joints;
}

motion::StampedPose jointPose(const PartJoint& part, Nanoseconds stamp_ns, double position,
                              std::optional<double> rate) {
  const geometry::UrdfJoint& joint = part.joint;
  const double q = joint.multiplier * position + joint.offset;
  motion::StampedPose out;
  out.stamp_ns = stamp_ns;
  Pose moved;
  if (joint.kind == Kind::kPrismatic) {
    moved.position = q * joint.axis;
  } else {
    moved.orientation.w() = std::cos(0.5 * q);
    moved.orientation.vec() = std::sin(0.5 * q) * joint.axis;
    out.turned = q;
  }
  out.pose = part.T_part_joint * moved;
  if (rate && joint.kind == Kind::kContinuous) {
    out.has_twist = true;
    out.angular = part.T_part_joint.orientation * (joint.multiplier * *rate * joint.axis);
  }
  return out;
}

}  // namespace collision_node::scene

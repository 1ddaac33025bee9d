#include "collision_node/scene/zones.h"

namespace collision_node::scene {

namespace {

bool holds(const Zone& zone, const Vec3& point) {
  if (!zone.has_box) return true;
  const Vec3 local = zone.pose.inverse() * point;
  return (local.cwiseAbs().array() <= 0.5 * zone.size.array()).all();
}

// Both comparisons fail for a radius that is not a number: then nothing is certain.

bool holdsBall(const Zone& zone, const Vec3& centre, double radius) {
  if (!zone.has_box) return true;
  const Vec3 local = zone.pose.inverse() * centre;
  return (local.cwiseAbs().array() + radius <= 0.5 * zone.size.array()).all();
}

bool isClearOfBall(const Zone& zone, const Vec3& centre, double radius) {
  if (!zone.has_box) return false;
  const Vec3 local = zone.pose.inverse() * centre;
  const Vec3 outside = (local.cwiseAbs() - 0.5 * zone.size).cwiseMax(0.0);
  return outside.norm() > radius;
}

bool meetsBall(const Zone& zone, const Vec3& centre, double radius) {
  return radius >= 0.0 && !isClearOfBall(zone, centre, radius);
}

}  // namespace

ZoneAnswer findZone(const Object& object, const std::string& link, const Vec3& point, const Vec3& centre,
                    double radius) {
  ZoneAnswer answer;
  answer.certain = true;
  const Zone* touched = nullptr;  // the first that the ball meets: the witness is known no better than that
  for (const Zone& zone : object.zones) {
    if (zone.link != link) continue;
    if (holds(zone, point)) {
      answer.name = zone.name;
      answer.certain = answer.certain && holdsBall(zone, centre, radius);
      return answer;
    }
    // A part of the ball in an earlier zone would have another answer.
    answer.certain = answer.certain && isClearOfBall(zone, centre, radius);
    if (touched == nullptr && meetsBall(zone, centre, radius)) touched = &zone;
  }
  if (touched != nullptr) answer.name = touched->name;
  return answer;
}

}  // namespace collision_node::scene

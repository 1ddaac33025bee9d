#include "collision_node/scene/traveller.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace collision_node::scene {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kUp = 1.0 + 0x1p-46;
/// 8192 units of rounding of everything that enters a pair's budget, where the solver's own needs less than a
/// thousand.
constexpr double kBudget = 0x1p-40;

double added(double sum, double more) { return std::nextafter(sum + more, kInfinity); }

/// Holds the bodies of all links in the world.
Bounds boxOf(const Object& object, const Pose& pose) {
  Bounds box{Vec3::Constant(kInfinity), Vec3::Constant(-kInfinity)};
  const geometry::Quat turn = pose.orientation.normalized();
  for (const Link& link : object.links) {
    if (!link.body) continue;
    for (std::int32_t id = 0; id < link.body->elementCount(); ++id) {
      Vec3 buffer[3];
      const geometry::Element element = link.body->element(id, buffer);
      const auto take = [&](const Vec3& point, double radius) {
        const Vec3 at = turn * point + pose.position;
        box.lower = box.lower.cwiseMin(at - Vec3::Constant(radius * kUp));
        box.upper = box.upper.cwiseMax(at + Vec3::Constant(radius * kUp));
      };
      if (element.vertices == nullptr) {
        const Vec3 half = element.axis * element.half_length;
        for (const double side : {-1.0, 1.0})
          take(element.centre + side * half, element.rim_radius + element.radius);
      }
      for (int i = 0; element.vertices != nullptr && i < element.count; ++i)
        take(element.vertices[i], element.radius);
    }
  }
  return box.lower.x() <= box.upper.x() ? box : Bounds{pose.position, pose.position};
}

}  // namespace

Traveller::Traveller(const Object& object, double half_distance, double max_gap)
    : object_(object), max_gap_(max_gap), half_distance_(half_distance) {
  for (const Link& link : object.links)
    if (link.body) reach_ = std::max(reach_, link.body->reach() + link.body->placingError());
  radius_ = (reach_ + half_distance_) * kUp;
  if (object.source.type == PoseSource::Type::kFixed) standAt(object.source.fixed);
}

void Traveller::standAt(const Pose& pose) {
  is_fixed_ = true;
  core_ = boxOf(object_, pose);
  radius_ = (half_distance_ + kBudget * (pose.position.lpNorm<1>() + reach_ + half_distance_)) * kUp;
}

void Traveller::take(const Sample& sample) {
  const double way = sample.travelled - travelled_;
  travelled_ = sample.travelled;
  const Vec3& position = sample.pose.pose.position;
  core_ = {position, position};
  double budget = kBudget * (position.lpNorm<1>() + reach_ + half_distance_);
  double tube = 0.0;
  if (sample.join == Join::kJoined) {
    const motion::RigidMotion& motion = sample.segment.motion;
    const double h = motion::secondsBetween(motion.start_ns, motion.end_ns);
    const double longest = std::max(h, max_gap_);  // the other side's segment may be so long
    speed_ = way / h;
    const double most_way =
        (motion.c[1].norm() + (motion.c[2].norm() + motion.c[3].norm() * longest) * longest) * longest;
    budget += kBudget * (most_way + reach_ * motion.omega.norm() * h) + 8.0 * reach_ * motion.turn_error;
    const motion::ModelError& error = sample.segment.error;
    const double most = error.position + (error.angle == 0.0 ? 0.0 : error.angle * reach_);
    if (error.asked && std::isfinite(most)) tube = most;  // else nobody solves with it
  }
  grow((reach_ + half_distance_ + budget + tube) * kUp);
}

void Traveller::grow(double radius) {
  if (radius <= radius_) return;
  growth_ = added(growth_, (radius - radius_) * kUp);
  radius_ = radius;
}

double Traveller::spentAt(double travelled) const { return added(travelled, growth_); }

Bounds Traveller::coreAt(const Track& track, std::size_t index) const {
  if (is_fixed_) return core_;
  const Vec3& position = track.sample(index).pose.pose.position;
  return {position, position};
}

Sweep Traveller::sweepTo(const Sample& sample) const {
  const Vec3& position = sample.pose.pose.position;
  Vec3 hull[4] = {position, position, position, position};
  if (sample.join == Join::kJoined) motion::pathHull(sample.segment.motion, hull);
  double bulge = 0.0;  // of the hull from the chord
  for (int i = 0; i < 4; ++i) {
    const Vec3 chord = hull[3] - hull[0], ahead = hull[i] - hull[0];
    const double length2 = chord.squaredNorm();
    const double share = length2 > 0.0 ? std::clamp(ahead.dot(chord) / length2, 0.0, 1.0) : 0.0;
    bulge = std::max(bulge, (ahead - share * chord).norm());
  }
  return {hull[0], hull[3], (radius_ + bulge) * kUp};
}

}  // namespace collision_node::scene

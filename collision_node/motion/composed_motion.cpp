#include "collision_node/motion/composed_motion.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "collision_node/geometry/rounding.h"

namespace collision_node::motion {

namespace {

using geometry::kUnit;

constexpr double kPi = 3.141592653589793;
/// Roundings in one part: interpolating it, a product of quaternions, a normalisation, a rotated point and a
/// sum.
constexpr double kRoundingsOfAPart = 128.0;
constexpr double kInflate = 1.0 + 1e-9;  // the bounds' own roundings, some hundred of 1e-16

double larger(const Vec3& a, const Vec3& b) { return std::max(a.norm(), b.norm()); }

/// A point carried by the parts after some part, over the interval: its two ends and a bound of its
/// acceleration.
struct CarriedPoint {
  Vec3 from = Vec3::Zero(), to = Vec3::Zero();
  double acceleration = 0.0;

  double farthest(double h) const { return larger(from, to) + acceleration * h * h / 8.0; }
  double fastest(double h) const { return (to - from).norm() / h + acceleration * h / 2.0; }
};

/// The last frame's origin, part by part from the inside out. A straight line stays one under translation; a
/// turn at rate w adds w^2 r + 2 w v.
double positionDeviation(const std::vector<ChainPart>& parts, double h) {
  CarriedPoint point;
  for (auto part = parts.rbegin(); part != parts.rend(); ++part) {
    const double rate = part->motion.omega.norm();
    if (part->inverse) {  // first the offset is taken away, then the rest is turned back
      point.from -= part->from.position;
      point.to -= part->to.position;
    }
    if (rate > 0.0) point.acceleration += rate * rate * point.farthest(h) + 2.0 * rate * point.fastest(h);
    const Quat from = part->inverse ? part->from.orientation.conjugate() : part->from.orientation;
    const Quat to = part->inverse ? part->to.orientation.conjugate() : part->to.orientation;
    point.from = from * point.from;
    point.to = to * point.to;
    if (!part->inverse) {
      point.from += part->from.position;
      point.to += part->to.position;
    }
  }
  return point.acceleration * h * h / 8.0;
}

/// A bound of how fast the chain's angular velocity changes [rad/s^2], and of its size [rad/s].
struct Turning {
  double change = 0.0, rate = 0.0;
};

Turning turningOf(const std::vector<ChainPart>& parts, double h) {
  Turning all;
  Vec3 velocity = Vec3::Zero();  // of the prefix, at the first stamp, outermost axes
  Quat prefix = Quat::Identity();
  for (const ChainPart& part : parts) {
    const double rate = part.motion.omega.norm();
    // omega stands in the parent's axes. Walked backwards the child is outside: there it is -R^T omega.
    const Quat turn = part.inverse ? part.from.orientation.conjugate() : part.from.orientation;
    const Vec3 own = part.inverse ? Vec3(turn * -part.motion.omega) : part.motion.omega;
    const Vec3 axis = prefix * own;
    if (rate > 0.0 && all.rate > 0.0) {
      const double crossed =
          velocity.cross(axis).norm() + kRoundingsOfAPart * kUnit * parts.size() * all.rate * rate;
      const double grown = (crossed + h * all.change * rate) * std::exp(all.rate * h);
      all.change += std::min(all.rate * rate, grown);
    }
    velocity += axis;
    all.rate += rate;
    prefix = prefix * turn;
  }
  // Turns against each other add up to less than the sum of their sizes.
  const double rounding = kRoundingsOfAPart * kUnit * parts.size() * all.rate;
  all.rate = std::min(all.rate, velocity.norm() + rounding + h * all.change);
  return all;
}

double angleDeviation(const std::vector<ChainPart>& parts, double h) {
  const Turning turning = turningOf(parts, h);
  if (turning.change == 0.0) return turning.rate * h < kPi ? 0.0 : kPi;
  const double off = turning.change * h * h / 4.0;
  const double angle = turning.rate * h + off;
  if (!(angle < kPi)) return kPi;  // the short way round may not be the way it went
  const double stretch = (angle / 2.0) / std::sin(angle / 2.0);
  return turning.change * h * h / 8.0 * (1.0 + stretch);
}

}  // namespace

Deviation slerpDeviation(const std::vector<ChainPart>& parts, double seconds) {
  // Nothing to compose: the path is the part's own motion, and its end poses are not even rounded.
  if (parts.size() == 1 && !parts.front().inverse) return {};
  double reach = 0.0, turned = 0.0;
  for (const ChainPart& part : parts) {
    reach += larger(part.from.position, part.to.position);
    turned += kRoundingsOfAPart * kUnit;
  }
  Deviation out;
  out.position = positionDeviation(parts, seconds) * kInflate + turned * reach;
  out.angle = std::min(kPi, angleDeviation(parts, seconds) * kInflate + turned);
  return out;
}

}  // namespace collision_node::motion

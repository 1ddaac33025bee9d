#include "collision_node/motion/model_error.h"

#include <algorithm>
#include <cmath>

namespace collision_node::motion {

namespace {

constexpr double kPi = 3.141592653589793;
constexpr double kNoBound = std::numeric_limits<double>::quiet_NaN();
constexpr double kAmply = 1.0 + 1e-12;      ///< more than the rounding of any formula here
constexpr double kMeasurable = 1.0 + 1e-6;  ///< a bound that is kept exactly shows up rounded
constexpr double kSmallestAngle = 1e-3;     ///< [rad] below, the series' first term is right to 1e-7

}  // namespace

double straightError(double acceleration, double h) { return acceleration * h * h / 8.0 * kAmply; }

double cubicError(double acceleration, const StampedPose& from, const StampedPose& to) {
  const double h = secondsBetween(from.stamp_ns, to.stamp_ns);
  const Vec3 step = to.pose.position - from.pose.position;
  const double change = acceleration * h * kMeasurable, way = 0.5 * acceleration * h * h * kMeasurable;
  const double rounding = 1e-15 * (from.pose.position.norm() + to.pose.position.norm() +
                                   h * (from.linear.norm() + to.linear.norm()));
  const bool possible = (to.linear - from.linear).norm() * h <= change * h + rounding &&
                        (step - h * from.linear).norm() <= way + rounding &&
                        (step - h * to.linear).norm() <= way + rounding;
  return possible ? acceleration * h * h / 16.0 * kAmply : kNoBound;
}

bool mayAlias(double max_spin, double h) { return !(max_spin * h * kAmply < kPi); }

double slerpError(double angular_acceleration, double max_spin, double h) {
  if (mayAlias(max_spin, h)) return kNoBound;
  // On the unit quaternions: half the angles, half the rates.
  const double rate = 0.5 * max_spin, bend = 0.5 * angular_acceleration;
  double distance = rate * h * kAmply;  // each way is no longer than this
  for (int i = 0; i < 6; ++i) {
    const double half = 0.5 * distance;
    const double stretch = half < kSmallestAngle ? 1.0 + half * half : std::tan(half) / half;
    const double w = rate * std::sqrt(stretch) * kAmply, swept = 0.5 * w * h;
    // (sec x - 1) / w^2 = h^2/8 (sin(x/2) / (x/2))^2 / cos x, which does not cancel.
    const double sinc = swept < kSmallestAngle ? 1.0 : std::sin(0.5 * swept) / (0.5 * swept);
    distance = std::min(distance, bend * h * h / 8.0 * sinc * sinc / std::cos(swept) * kAmply);
  }
  return 2.0 * distance * kAmply;
}

}  // namespace collision_node::motion

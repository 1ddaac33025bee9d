#include "collision_node/motion/stamped_pose.h"

#include <cmath>

namespace collision_node::motion {

namespace {

constexpr double kNormTolerance = 1e-2;  // on |q|^2 - 1; the contract's limit, not a numerical tolerance
constexpr double kLargest = geometry::kLargestLength;  // [m], but also [m/s] and [rad/s]

}  // namespace

PoseFault checkAndNormalise(StampedPose& pose) {
  // Written so that NaN fails.
  const auto usable = [](const Vec3& v) { return (v.array().abs() <= kLargest).all(); };
  const bool finite = usable(pose.pose.position) && pose.pose.orientation.coeffs().allFinite() &&
                      (!pose.has_twist || (usable(pose.linear) && usable(pose.angular)));
  if (!finite) return PoseFault::kNotFinite;
  const double norm2 = pose.pose.orientation.squaredNorm();
  if (!(std::abs(norm2 - 1.0) < kNormTolerance)) return PoseFault::kQuaternion;
  pose.pose.orientation.coeffs() /= std::sqrt(norm2);
  return PoseFault::kNone;
}

}  // namespace collision_node::motion

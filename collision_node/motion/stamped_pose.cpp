#include "collision_node/motion/stamped_pose.h"

#include <cmath>

namespace collision_node::motion {

namespace {

constexpr double kNormTolerance = 1e-2;  // on |q|^2 - 1; the contract's limit, not a numerical tolerance

}  // namespace

PoseFault checkAndNormalise(StampedPose& pose) {
  const bool finite = pose.pose.position.allFinite() && pose.pose.orientation.coeffs().allFinite() &&
                      (!pose.has_twist || (pose.linear.allFinite() && pose.angular.allFinite()));
  if (!finite) return PoseFault::kNotFinite;
  const double norm2 = pose.pose.orientation.squaredNorm();
  if (!(std::abs(norm2 - 1.0) < kNormTolerance)) return PoseFault::kQuaternion;
  pose.pose.orientation.coeffs() /= std::sqrt(norm2);
  return PoseFault::kNone;
}

}  // namespace collision_node::motion

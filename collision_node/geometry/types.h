/// Vectors, rotations and poses shared by every room. SI units, right-handed axes.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace collision_node::geometry {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
using Quat = Eigen::Quaterniond;

/// [m] What is farther from its origin is refused: squares and sums of more leave the doubles' grid, and more
/// by far the floats of a BVH.
constexpr double kLargestLength = 1e15;

/// A rigid transform: p_parent = orientation * p_child + position. The quaternion is unit.
struct Pose {
  Vec3 position = Vec3::Zero();
  Quat orientation = Quat::Identity();

  Vec3 operator*(const Vec3& p) const { return orientation * p + position; }
  Pose operator*(const Pose& child) const {
    return {*this * child.position, (orientation * child.orientation).normalized()};
  }
  Pose inverse() const {
    const Quat back = orientation.conjugate();
    return {-(back * position), back};
  }
};

}  // namespace collision_node::geometry

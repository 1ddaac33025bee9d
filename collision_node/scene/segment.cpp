#include "collision_node/scene/segment.h"

#include <algorithm>

namespace collision_node::scene {

namespace {

constexpr double kHalfTurn = 3.141592653589793;
constexpr double kQuarterTurn = 0.5 * kHalfTurn;

/// Slerp takes the short way round; a body that turns faster than that went the other way, or round several
/// times.
bool turnsTooFarForSlerp(const motion::StampedPose& from, const motion::StampedPose& to, double h) {
  const double from_rate = from.has_twist ? from.angular.norm() : 0.0;
  const double to_rate = to.has_twist ? to.angular.norm() : 0.0;
  return std::max(from_rate, to_rate) * h > kHalfTurn;
}

bool spinIsDoubtful(const motion::StampedPose& from, const motion::StampedPose& to, double h,
                    const motion::RigidMotion& motion) {
  const Vec3 mean_rate = 0.5 * (from.angular + to.angular);
  return (from.angular - to.angular).norm() * h > kQuarterTurn ||
         (motion.omega - mean_rate).norm() * h > kQuarterTurn;
}

}  // namespace

Segment makeSegment(MotionModel model, const motion::StampedPose& from, const motion::StampedPose& to) {
  const double h = motion::secondsBetween(from.stamp_ns, to.stamp_ns);
  const bool has_twists = from.has_twist && to.has_twist;
  Segment segment;
  bool doubtful;
  if (model == MotionModel::kSpin && has_twists) {
    segment.motion = motion::spin(from, to);
    doubtful = spinIsDoubtful(from, to, h, segment.motion);
  } else {
    const bool curved = model == MotionModel::kHermite && has_twists;
    segment.motion = curved ? motion::hermite(from, to) : motion::straightSlerp(from, to);
    doubtful = turnsTooFarForSlerp(from, to, h) || (model != MotionModel::kSlerp && !has_twists);
  }
  if (doubtful) segment.doubt = impact::Reason::kAlias;
  return segment;
}

impact::Reason worseDoubt(impact::Reason a, impact::Reason b) {
  if (a == impact::Reason::kNone) return b;
  if (b == impact::Reason::kNone) return a;
  return std::min(a, b);  // the numbers of Impact.msg run in this order
}

}  // namespace collision_node::scene

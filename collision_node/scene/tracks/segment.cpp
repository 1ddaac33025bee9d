#include "collision_node/scene/tracks/segment.h"

#include <algorithm>
#include <cmath>

namespace collision_node::scene {

namespace {

constexpr double kHalfTurn = 3.141592653589793;
constexpr double kQuarterTurn = 0.5 * kHalfTurn;
constexpr double kRoundedTurn = 1e-9;  // what slerp may make of half a turn, relative: far more than rounding

/// Slerp takes the short way round; a body that turns faster than that went the other way, or round several
/// times.
bool turnsTooFarForSlerp(const motion::StampedPose& from, const motion::StampedPose& to, double h) {
  const double from_rate = from.has_twist ? from.angular.norm() : 0.0;
  const double to_rate = to.has_twist ? to.angular.norm() : 0.0;
  return std::max(from_rate, to_rate) * h > kHalfTurn;
}

/// A joint whose position changed by half a turn or more did not go the short way round. Only the rates of a
/// joint that may count from 0 again after a whole turn can say that it did.
bool jointTurnsTooFar(const motion::StampedPose& from, const motion::StampedPose& to) {
  const double turn = std::abs(to.turned - from.turned);
  return turn > kHalfTurn * (1.0 - kRoundedTurn) && !(from.has_twist && to.has_twist);
}

bool spinIsDoubtful(const motion::StampedPose& from, const motion::StampedPose& to, double h,
                    const motion::RigidMotion& motion) {
  const Vec3 mean_rate = 0.5 * (from.angular + to.angular);
  return (from.angular - to.angular).norm() * h > kQuarterTurn ||
         (motion.omega - mean_rate).norm() * h > kQuarterTurn;
}

/// The tube that the bounds imply, and what a source says of poses that it composed.
motion::ModelError errorOf(const motion::StampedPose& from, const motion::StampedPose& to, double h,
                           bool cubic, const motion::MotionBounds& bounds) {
  motion::ModelError error;
  const bool straight_asked = !std::isnan(bounds.acceleration);
  const bool turning_asked = !std::isnan(bounds.angular_acceleration);
  const bool composed = to.model_position > 0.0 || to.model_angle > 0.0;
  error.asked = straight_asked || turning_asked || composed;
  if (straight_asked)
    error.position = cubic ? motion::cubicError(bounds.acceleration, from, to)
                           : motion::straightError(bounds.acceleration, h);
  if (turning_asked) error.angle = motion::slerpError(bounds.angular_acceleration, bounds.max_spin, h);
  if (composed) {
    // A composed pose need not be where the body was: bounds between true poses do not speak of it.
    if (bounds.areAsked() || !std::isfinite(to.model_position) || !std::isfinite(to.model_angle))
      return motion::unknownError();
    error.position = to.model_position;
    error.angle = to.model_angle;
  }
  return error;
}

}  // namespace

Segment makeSegment(MotionModel model, const motion::StampedPose& from, const motion::StampedPose& to,
                    const motion::MotionBounds& bounds) {
  const double h = motion::secondsBetween(from.stamp_ns, to.stamp_ns);
  const bool has_twists = from.has_twist && to.has_twist;
  Segment segment;
  bool doubtful, cubic = false;
  if (model == MotionModel::kSpin && has_twists) {
    segment.motion = motion::spin(from, to);
    doubtful = spinIsDoubtful(from, to, h, segment.motion);
  } else {
    cubic = model == MotionModel::kHermite && has_twists;
    segment.motion = cubic ? motion::hermite(from, to) : motion::straightSlerp(from, to);
    doubtful = turnsTooFarForSlerp(from, to, h) || jointTurnsTooFar(from, to) ||
               (model != MotionModel::kSlerp && !has_twists);
  }
  const bool needs_limit = !std::isnan(bounds.angular_acceleration);
  const bool limit_says_much = std::isfinite(bounds.max_spin) && !has_twists;
  if ((needs_limit || limit_says_much) && motion::mayAlias(bounds.max_spin, h)) doubtful = true;
  if (doubtful) segment.doubt = impact::Reason::kAlias;
  segment.error = errorOf(from, to, h, cubic, bounds);
  return segment;
}

impact::Reason worseDoubt(impact::Reason a, impact::Reason b) {
  if (a == impact::Reason::kNone) return b;
  if (b == impact::Reason::kNone) return a;
  return std::min(a, b);  // the numbers of Impact.msg run in this order
}

}  // namespace collision_node::scene

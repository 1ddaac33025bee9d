/// The motion between two stamped poses as DESIGN and README state it, made from the poses themselves: shares
/// nothing with the motion room but the poses' plain struct.
///
/// `line`: a straight line and the shortest arc between the orientations at constant rate. `cubic`: Hermite's
/// cubic through the positions with the twists' velocities, and the same arc. `turns`: the line, and about
/// the arc's axis k whole turns more, k = round((h axis . mean rate - arc) / 2 pi).
#pragma once

#include <cstdint>

#include "collision_node/motion/stamped_pose.h"
#include "test/oracle/interval.h"

namespace oracle {

/// The unit quaternion in the direction of four doubles.
struct UnitQuaternion {
  I3 v;
  Interval w;

  template <class EigenQuaternion>
  explicit UnitQuaternion(const EigenQuaternion& q) {
    const I3 raw = {Interval(q.x()), Interval(q.y()), Interval(q.z())};
    const Interval length = sqrt(dotOf(raw, raw) + Interval(q.w()) * q.w());
    v = times(Interval(1) / length, raw);
    w = Interval(q.w()) / length;
  }
  I3 rotated(const I3& x) const {
    const I3 once = crossOf(v, x);
    return plus(x, times(2, plus(times(w, once), crossOf(v, once))));
  }
};

class StampedMotion {
 public:
  enum class Model { kLine, kCubic, kTurns };
  using StampedPose = collision_node::motion::StampedPose;

  /// At rest.
  explicit StampedMotion(const collision_node::geometry::Pose& pose) : q_(pose.orientation), fixed_(true) {
    c_[0] = interval3(pose.position);
  }

  /// The arc must be well below half a turn: the shortest way is then beyond doubt.
  StampedMotion(const StampedPose& from, const StampedPose& to, Model model)
      : start_ns_(from.stamp_ns), q_(from.pose.orientation) {
    const Interval h = exactSeconds(from.stamp_ns, to.stamp_ns);
    const I3 way = minus(interval3(to.pose.position), interval3(from.pose.position));
    c_[0] = interval3(from.pose.position);
    c_[1] = times(Interval(1) / h, way);
    if (model == Model::kCubic) {
      const I3 mean = c_[1], first = interval3(from.linear), last = interval3(to.linear);
      c_[1] = first;
      c_[2] = times(Interval(1) / h, minus(times(3, mean), plus(times(2, first), last)));
      c_[3] = times(Interval(1) / (h * h), minus(plus(first, last), times(2, mean)));
    }
    turn(UnitQuaternion(to.pose.orientation));
    if (model == Model::kTurns) {
      const I3 mean = times(0.5, plus(interval3(from.angular), interval3(to.angular)));
      if (!turns_ && (from.angular + to.angular).squaredNorm() > 0) {
        axis_ = times(Interval(1) / lengthOf(mean), mean);
        turns_ = true;
      }
      if (turns_) {
        const Interval more = (h * dotOf(axis_, mean) - angle_) / wholeTurn();
        angle_ = angle_ + wholeTurn() * std::round(0.5 * (more.lo.toDouble() + more.hi.toDouble()));
      }
    }
    rate_ = angle_ / h;
  }

  /// Coefficients of the position's cubic in the seconds since `start_ns`.
  std::array<I3, 4> positionFrom(std::int64_t start_ns) const {
    const Interval s = seconds(start_ns);
    return {plus(c_[0], times(s, plus(c_[1], times(s, plus(c_[2], times(s, c_[3])))))),
            plus(c_[1], times(s, plus(times(2, c_[2]), times(3 * s, c_[3])))),
            plus(c_[2], times(3 * s, c_[3])), c_[3]};
  }
  /// The turn about `axis` since the first stamp, at `start_ns`. [rad]
  Interval angleAt(std::int64_t start_ns) const { return rate_ * seconds(start_ns); }
  const Interval& rate() const { return rate_; }  ///< [rad/s], never negative but for turns against the arc
  const I3& axis() const { return axis_; }        ///< unit, world axes; zero when nothing turns
  bool turns() const { return turns_; }
  I3 orientedFirst(const I3& x) const { return q_.rotated(x); }  ///< as the first pose has it

  /// A vector of the object `t` seconds after start_ns.
  I3 rotated(std::int64_t start_ns, const Interval& t, const I3& x) const {
    const I3 first = orientedFirst(x);
    if (!turns_) return first;
    Interval sine, cosine;
    sineAndCosine(angleAt(start_ns) + rate_ * t, sine, cosine);
    const I3 around = crossOf(axis_, first);
    return plus(first, plus(times(sine, around), times(Interval(1) - cosine, crossOf(axis_, around))));
  }

 private:
  Interval seconds(std::int64_t start_ns) const {
    return fixed_ ? Interval(0) : exactSeconds(start_ns_, start_ns);
  }

  /// Axis and angle of to * conjugate(from), the shorter way round.
  void turn(const UnitQuaternion& to) {
    Interval w = to.w * q_.w + dotOf(to.v, q_.v);
    I3 step = minus(minus(times(q_.w, to.v), times(to.w, q_.v)), crossOf(to.v, q_.v));
    if (w.negative()) {
      w = -w;
      step = times(-1, step);
    }
    const Interval square = dotOf(step, step);
    if (!square.positive()) return;  // the same four numbers
    const Interval sine = sqrt(square);
    turns_ = true;
    axis_ = times(Interval(1) / sine, step);
    angle_ = Interval(2) * arctan(sine / w);
  }

  std::int64_t start_ns_ = 0;
  I3 c_[4], axis_;
  UnitQuaternion q_;
  Interval angle_, rate_;
  bool turns_ = false, fixed_ = false;
};

}  // namespace oracle

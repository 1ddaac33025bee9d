/// One object's motion in interval arithmetic, from the very doubles and integers that the solver reads.
#pragma once

#include "collision_node/motion/rigid_motion.h"
#include "test/oracle/interval.h"

namespace oracle {

class IntervalPath {
 public:
  IntervalPath(const collision_node::motion::RigidMotion& motion, std::int64_t piece_start_ns) {
    using collision_node::motion::Vec3;
    const bool fixed = motion.fixed;
    for (int k = 0; k < 4; ++k) c_[k] = interval3(fixed && k > 0 ? Vec3(Vec3::Zero()) : motion.c[k]);
    if (!fixed) offset_ = exactSeconds(motion.start_ns, piece_start_ns);
    w_ = interval3(fixed ? Vec3(Vec3::Zero()) : motion.omega);
    turns_ = !fixed && !motion.omega.isZero(0.0);
    if (turns_) {
      spin_ = lengthOf(w_);
      axis_ = times(Interval(1) / spin_, w_);
    }
    const auto& q = motion.q0;
    const Interval length = sqrt(Interval(q.w()) * q.w() + Interval(q.x()) * q.x() + Interval(q.y()) * q.y() +
                                 Interval(q.z()) * q.z());
    q_ = {q.x() / length, q.y() / length, q.z() / length};
    qw_ = q.w() / length;
  }

  I3 position(const Interval& t) const {
    const Interval s = offset_ + t;
    return plus(c_[0], times(s, plus(c_[1], times(s, plus(c_[2], times(s, c_[3]))))));
  }
  I3 velocity(const Interval& t) const {
    const Interval s = offset_ + t;
    return plus(c_[1], times(s, plus(times(2, c_[2]), times(s, times(3, c_[3])))));
  }
  I3 acceleration(const Interval& t) const {
    return plus(times(2, c_[2]), times(offset_ + t, times(6, c_[3])));
  }
  const I3& omega() const { return w_; }

  /// Rotations of several vectors at one time share its sine and cosine.
  struct Turn {
    Interval sine, one_minus_cosine;
  };
  Turn turn(const Interval& t) const {
    Turn turn;
    if (!turns_) return turn;
    Interval cosine;
    sineAndCosine(spin_ * (offset_ + t), turn.sine, cosine);
    turn.one_minus_cosine = Interval(1) - cosine;
    return turn;
  }
  I3 rotated(const Turn& turn, const I3& x) const {
    // v + 2 w (q x v) + 2 q x (q x v), then Rodrigues' formula
    const I3 once = crossOf(q_, x);
    const I3 first = plus(x, times(2, plus(times(qw_, once), crossOf(q_, once))));
    if (!turns_) return first;
    const I3 around = crossOf(axis_, first);
    return plus(first, plus(times(turn.sine, around), times(turn.one_minus_cosine, crossOf(axis_, around))));
  }

 private:
  I3 c_[4], w_, axis_, q_;
  Interval offset_, spin_, qw_;
  bool turns_ = false;
};

}  // namespace oracle

/// Trials on straight paths without a turn: what most directions of the walk scale.
#pragma once

#include "collision_node/report/random.h"
#include "collision_node/report/stability/group.h"

namespace collision_node::report {

struct Setting {
  double offset = 0.0;  ///< [m] of everything from the world's origin
  double speed = 10.0;  ///< [m/s] of B past A
  motion::Nanoseconds start_ns = 0;
  motion::Nanoseconds step_ns = 100'000'000;
  bool both_move = false;  ///< A flies too, and the offset's rounding reaches both
};

/// Of each three trials: one meets, one ends 10 % of its path before the contact, one flies past the
/// outline at `margin` [m]. Truth: firstTouch() of the poses as rounded.
void addStraightTrials(Group& group, const Setting& setting, double margin, int count, Random& random);

/// Poses of one body at both ends of a piece, with what is exactly between them.
struct Flight {
  motion::StampedPose from, to;

  motion::RigidMotion motion() const;
  Vec<Exact> start() const { return lift<Exact>(from.pose.position); }
  Vec<Exact> velocity() const;  ///< mean over the piece
};
Flight flight(const Setting& setting, const geometry::Vec3& from, const geometry::Vec3& to,
              const geometry::Quat& q);
impact::Piece pieceOf(const Flight& a, const Flight& b);
Exact secondsOf(const Flight& flight);

}  // namespace collision_node::report

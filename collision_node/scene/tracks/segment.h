/// Two consecutive poses of a track and the motion between them, as the object's motion model says; and where
/// there is none.
#pragma once

#include <cstdint>

#include "collision_node/impact/pair_method.h"
#include "collision_node/motion/model_error.h"
#include "collision_node/motion/rigid_motion.h"
#include "collision_node/scene/scene.h"

namespace collision_node::scene {

/// A motion, and why events on it may not be certified (kNone: they may).
struct Segment {
  motion::RigidMotion motion;
  impact::Reason doubt = impact::Reason::kNone;
  motion::ModelError error;  ///< how far the object may be from the motion; no bound while there is a doubt
};

/// Nothing is known of an object from `after_ns` on: a gap or a teleport (GAP), or it went silent (TIMEOUT).
struct Hole {
  std::uint32_t epoch = 0;
  Nanoseconds after_ns = 0;  ///< the last pose before it
  impact::Reason reason = impact::Reason::kNone;
};
inline bool operator<(const Hole& l, const Hole& r) {
  return l.epoch != r.epoch ? l.epoch < r.epoch : l.after_ns < r.after_ns;
}

/// Requires from.stamp_ns < to.stamp_ns. The doubt is ALIAS when the twists contradict the model: more than
/// half a turn between two poses (slerp, hermite), or a joint's position does; more than a quarter turn of
/// disagreement (spin), no twist where the model needs one (hermite, spin: slerp is taken instead); and when
/// nobody can tell which way round the body went: it may turn by half a turn (max_spin h >= pi), and there is
/// no twist to say more or a bound of the model's error is asked.
Segment makeSegment(MotionModel model, const motion::StampedPose& from, const motion::StampedPose& to,
                    const motion::MotionBounds& bounds = {});

/// The doubt that wins when several hold: guessed stamps, then alias, then timeout.
impact::Reason worseDoubt(impact::Reason a, impact::Reason b);

}  // namespace collision_node::scene

#include "collision_node/impact/pair_piece.h"

#include <algorithm>

namespace collision_node::impact {

PairPiece::PairPiece(const Body& body_a, const Body& body_b, const Piece& piece, double distance)
    : a(body_a),
      b(body_b),
      motion(piece.a, piece.b, piece.start_ns, piece.end_ns),
      contact_distance(distance),
      tube(piece.tube) {
  const double reach = a.reach() + b.reach();
  const double size = motion.maxDistance() + reach + contact_distance;
  speed = motion.maxSpeed() + motion.spinA() * a.reach() + motion.spinB() * b.reach();
  any_speed = std::max({speed, motion.ownSpeedA() + motion.spinA() * a.reach(),
                        motion.ownSpeedB() + motion.spinB() * b.reach()});
  const double pose_error = motion.translationError() + motion.rotationErrorA() * a.reach() +
                            motion.rotationErrorB() * b.reach() + a.placingError() + b.placingError();
  point_error = 2.0 * pose_error + 64.0 * kUnit * (size + speed * motion.duration());
  point_error += piece.tube * (1.0 + 4.0 * kUnit);  // a true point counts like a badly computed one
  // Seen from a frame that is off by an angle, everything at a distance is off by angle times distance, the
  // rate too.
  const double turned = (motion.rotationErrorA() + motion.rotationErrorB()) * size;
  frame_error = 2.0 * (point_error + turned);
  frame_error += motion.duration() * (motion.spinA() + motion.spinB()) * turned;
  rate_error = (motion.spinA() + motion.spinB()) * pose_error + 64.0 * kUnit * speed;
}

Instant PairPiece::at(double t) const {
  return {t, motion.rotationA(t), motion.rotationB(t), motion.displacement(t), motion.velocity(t)};
}

}  // namespace collision_node::impact

#include "collision_node/impact/pair_piece.h"

#include <algorithm>

namespace collision_node::impact {

bool outOfReach(const Body& a, const Body& b, const Piece& piece, double contact_distance) {
  const motion::RigidMotion &ma = piece.a, &mb = piece.b;
  const auto straight = [](const motion::RigidMotion& m) { return m.c[2].isZero(0.0) && m.c[3].isZero(0.0); };
  if (!straight(ma) || !straight(mb)) return false;
  const motion::LinearPart line(ma, mb, piece.start_ns, piece.end_ns);
  const double size = line.magnitude(ma, mb) + (ma.c[1].norm() + mb.c[1].norm()) * line.reach;
  const double reach = (a.reach() + b.reach() + contact_distance + a.placingError() + b.placingError() +
                        piece.tube + 64.0 * kUnit * size) *
                       (1.0 + 64.0 * kUnit);
  const Vec3 way = line.rate * line.duration;
  const double length2 = way.squaredNorm();
  const double share = length2 > 0.0 ? std::clamp(-line.d.dot(way) / length2, 0.0, 1.0) : 0.0;
  return (line.d + share * way).norm() > reach;
}

PairPiece::PairPiece(const Body& body_a, const Body& body_b, const Piece& piece, double distance)
    : PairPiece(body_a, body_b, RelativeMotion(piece.a, piece.b, piece.start_ns, piece.end_ns), distance,
                piece.tube) {}

PairPiece::PairPiece(const Body& body_a, const Body& body_b, const RelativeMotion& relative, double distance,
                     double true_within)
    : a(body_a), b(body_b), motion(relative), contact_distance(distance), tube(true_within) {
  const double reach = a.reach() + b.reach();
  const double size = motion.maxDistance() + reach + contact_distance;
  speed = motion.maxSpeed() + motion.spinA() * a.reach() + motion.spinB() * b.reach();
  any_speed = std::max({speed, motion.ownSpeedA() + motion.spinA() * a.reach(),
                        motion.ownSpeedB() + motion.spinB() * b.reach()});
  const double pose_error = motion.translationError() + motion.rotationErrorA() * a.reach() +
                            motion.rotationErrorB() * b.reach() + a.placingError() + b.placingError();
  point_error = 2.0 * pose_error + 64.0 * kUnit * (size + speed * motion.duration());
  point_error += tube * (1.0 + 4.0 * kUnit);  // a true point counts like a badly computed one
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

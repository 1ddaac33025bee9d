#include "collision_node/impact/pair_piece.h"

#include <algorithm>
#include <cmath>

namespace collision_node::impact {
namespace {

/// What every proof subtracts, and the speeds.
void setBudget(PairPiece& pair) {
  const Body &a = pair.a, &b = pair.b;
  const RelativeMotion& motion = pair.motion;
  const double reach = a.reach() + b.reach();
  const double size = motion.maxDistance() + reach + pair.contact_distance;
  pair.speed = motion.maxSpeed() + motion.spinA() * a.reach() + motion.spinB() * b.reach();
  pair.any_speed = std::max({pair.speed, motion.ownSpeedA() + motion.spinA() * a.reach(),
                             motion.ownSpeedB() + motion.spinB() * b.reach()});
  const double pose_error = motion.translationError() + motion.rotationErrorA() * a.reach() +
                            motion.rotationErrorB() * b.reach() + a.placingError() + b.placingError();
  pair.point_error = 2.0 * pose_error + 64.0 * kUnit * (size + pair.speed * motion.duration());
  pair.point_error += pair.tube * (1.0 + 4.0 * kUnit);  // a true point counts like a badly computed one
  pair.untold = pair.tube + 2.0 * (motion.turnErrorA() * a.reach() + motion.turnErrorB() * b.reach());
  // Seen from a frame that is off by an angle, everything at a distance is off by angle times distance, the
  // rate too.
  const double turned = (motion.rotationErrorA() + motion.rotationErrorB()) * size;
  pair.frame_error = 2.0 * (pair.point_error + turned);
  pair.frame_error += motion.duration() * (motion.spinA() + motion.spinB()) * turned;
  pair.rate_error = (motion.spinA() + motion.spinB()) * pose_error + 64.0 * kUnit * pair.speed;
}

}  // namespace

PairPiece::PairPiece(const Body& body_a, const Body& body_b, const Piece& piece, double distance)
    : a(body_a),
      b(body_b),
      motion(piece.a, piece.b, piece.start_ns, piece.end_ns),
      contact_distance(distance),
      tube(piece.tube) {
  setBudget(*this);
}

PairPiece::PairPiece(const Body& body_a, const Body& body_b, const RelativeMotion& relative, double distance,
                     double true_within)
    : a(body_a), b(body_b), motion(relative), contact_distance(distance), tube(true_within) {
  setBudget(*this);
}

Instant PairPiece::at(double t) const {
  const RelativeMotion::HalfTurns turn = motion.halfTurns(t);
  return {t,
          motion.rotationA(turn.a),
          motion.rotationB(turn.b),
          motion.displacement(t),
          motion.velocity(t),
          turn.a,
          turn.b};
}

/// A turn by an angle x is 1 + x K to x^2/2: what is left of it here is a sixteenth of a rounding.
bool PairPiece::isNear(double t, const Instant& computed) const {
  constexpr double kSmall = 0x1p-28;  // [rad]
  return std::abs(t - computed.t) * std::max(motion.spinA(), motion.spinB()) <= kSmall;
}

Instant PairPiece::at(double t, const Instant& computed) const {
  const double step = t - computed.t;
  const auto rotation = [step](const Mat3& before, const Vec3& omega) {
    const Vec3 by = step * omega;
    Mat3 now = before;
    for (int i = 0; i < 3; ++i) now.col(i) += by.cross(before.col(i));
    return now;
  };
  const auto half_turn = [step](const RelativeMotion::HalfTurn& before, double spin) {
    const double by = 0.5 * step * spin;
    return RelativeMotion::HalfTurn{before.sine + by * before.cosine, before.cosine - by * before.sine};
  };
  return {t,
          rotation(computed.ra, motion.omegaA()),
          rotation(computed.rb, motion.omegaB()),
          motion.displacement(t),
          motion.velocity(t),
          half_turn(computed.turn_a, motion.spinA()),
          half_turn(computed.turn_b, motion.spinB())};
}

}  // namespace collision_node::impact

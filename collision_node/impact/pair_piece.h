/// Two bodies on one piece of time, and the rounding budget that every proof about them subtracts.
#pragma once

#include <algorithm>
#include <limits>
#include <optional>

#include "collision_node/geometry/body.h"
#include "collision_node/geometry/rounding.h"
#include "collision_node/impact/pair_method.h"
#include "collision_node/motion/relative_motion.h"

namespace collision_node::impact {

using geometry::Body;
using geometry::Element;
using geometry::kUnit;
using geometry::kUp;
using geometry::Mat3;
using motion::RelativeMotion;

/// Of a length that is already larger than it must be by some roundings: what a computed square of a vector
/// may be compared with, however small it is.
inline double squareAbove(double length) { return length * length + std::numeric_limits<double>::min(); }

/// How wide a bracket may be: refinement goes on until neither its width nor what it adds to the ball
/// matters; rounding is the floor.
struct Widths {
  Widths(const PairOptions& options, double point_error, double speed, double duration)
      : floor(std::max(point_error / std::max(speed, 1e-300), 64.0 * kUnit * duration)),
        wanted(std::max(std::min(options.time_precision,
                                 kShareOfBall * options.distance_precision / std::max(speed, 1e-300)),
                        floor)) {}

  /// Of the ball, what moves in a bracket: edges that cross at a degree or two make fifty times as much of
  /// it.
  static constexpr double kShareOfBall = 0.02;
  double floor, wanted;  ///< [s]
};

/// An element of a body, looked at where the body keeps it if it is no triangle.
class ElementView {
 public:
  ElementView(const Body& body, std::int32_t id) {
    if (id >= body.triangleCount())
      element_ = &body.primitive(id);
    else
      element_ = &triangle_.emplace(body.element(id, corners_));
  }
  ElementView(const ElementView&) = delete;
  const Element& operator*() const { return *element_; }

 private:
  Vec3 corners_[3];
  std::optional<Element> triangle_;
  const Element* element_;
};

/// Both poses at one instant, in world axes relative to A's origin.
struct Instant {
  double t = 0.0;
  Mat3 ra, rb;
  Vec3 d, d_rate;  ///< B's origin and its velocity
  RelativeMotion::HalfTurn turn_a, turn_b;
};

/// Read-only while a piece is solved. The budget (docs/solver.md derives it):
///   any computed point difference b - a is within `point_error` of the exact one at the same t;
///   a computed separation value along an axis n(s) is within |n(s)| (point_error + s rate_error) of the
///   exact value.
/// With a tube (Piece::tube) "exact" is the true motion, and the tube is part of point_error.
struct PairPiece {
  PairPiece(const Body& a, const Body& b, const Piece& piece, double contact_distance);
  PairPiece(const Body& a, const Body& b, const RelativeMotion& motion, double contact_distance, double tube);

  Instant at(double t) const;
  /// Is a time so near to a computed instant that the turn since then needs no sines? Then the same from it.
  bool isNear(double t, const Instant& computed) const;
  Instant at(double t, const Instant& computed) const;

  const Body& a;
  const Body& b;
  RelativeMotion motion;
  double contact_distance;
  double tube;         ///< [m] Piece::tube
  double untold;       ///< [m] what of point_error is no rounding: the tube, and turns that are told badly
  double point_error;  ///< [m]
  double rate_error;   ///< [m/s]
  double frame_error;  ///< [m] the same for points seen in a rotating body's frame, however far away they are
  double any_speed;    ///< sup of |velocity| of any material point, relative or in the world [m/s]
  double speed;        ///< sup of |relative velocity| of any material point of A and any of B [m/s]
};

}  // namespace collision_node::impact

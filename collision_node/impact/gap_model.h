/// The one proof of clearance: two convex elements stay apart along a moving axis for a stated time.
///
/// Guarantee: apartFor() returns s >= 0 such that the elements are farther than `contact_distance` apart, in
/// exact arithmetic of the loaded geometry and the motion model, at every time in [t, t + s]; s == 0 proves
/// nothing. The axis may be any; a poor one costs time, never a miss. Derivation: docs/solver.md, "The gap
/// model".
#pragma once

#include <boost/container/static_vector.hpp>

#include "collision_node/impact/gjk.h"

namespace collision_node::impact {

/// n(s) = direction + s rate, world axes, s seconds after the instant. `direction` is about unit and points
/// from A to B.
struct Axis {
  Vec3 direction = Vec3::Zero();
  Vec3 rate = Vec3::Zero();
  bool valid = false;
};

/// An axis along which a pair was proved apart, as it is at `time`.
struct Parting {
  Axis axis;
  double time = 0.0;  ///< [s] from the piece's start

  Vec3 at(double t) const { return axis.direction + (t - time) * axis.rate; }
};

/// How far the cores' points are from their objects' origins, to rounding [m].
struct CoreReaches {
  double a, b;
};

/// max over a core of u(s) . x, u = u0 + s u1 in its object's frame; convex in s.
class MovingSupport {
 public:
  MovingSupport(const Element& e, const Vec3& u0, const Vec3& u1);

  struct Value {
    double value, rate;  ///< and its rate at the extreme point
  };
  Value at(double s) const;
  /// Half its second derivative at s = 0, as long as its features stay.
  double bend() const;

 private:
  const Element* hull_ = nullptr;  ///< a core without axes of its own; else:
  bool round_ = false;
  double constant_ = 0.0, linear_ = 0.0;  ///< of its centre
  Vec3 half_;
  Vec3 u0_ = Vec3::Zero(), u1_ = Vec3::Zero();  ///< in its own axes, or in the object's frame
};

/// Lower bound of the gap along n(s): concave in s, so positive at s (and at 0) means positive between.
class GapModel {
 public:
  GapModel(const PairPiece& piece, const Instant& now, const Element& a, const Element& b, const Axis& axis)
      : GapModel(piece, now, a, b, axis, {coreReach(a), coreReach(b)}) {}
  GapModel(const PairPiece& piece, const Instant& now, const Element& a, const Element& b, const Axis& axis,
           const CoreReaches& reaches);

  struct Value {
    double gap;    ///< [m], rounding budget already subtracted
    double slope;  ///< a supergradient [m/s]
  };
  Value at(double s) const;

  /// The gap is at most at(0).gap + s at(0).slope - s^2 leastBend() [m/s^2], to rounding.
  double leastBend() const { return square_ + curve_ * length_; }
  /// The same with what bends right now, to second order.
  double bendNow() const;

 private:
  Vec3 direction_, rate_;
  MovingSupport a_, b_;  ///< of B negated
  double length_, rate_length_;
  double constant_, linear_;
  double grown_;           ///< both radii and the contact distance
  double square_, curve_;  ///< subtracted: square s^2 + curve s^2 |n(s)|
  double point_error_, rate_error_;
};

/// The axis through the closest points, turning with the features that hold them; invalid when the cores
/// overlap.
Axis axisOf(const PairPiece& piece, const Instant& now, const Closest& closest, bool rounded);

/// A cylinder with a hull of eight vertices has the most: 37.
using Axes = boost::container::static_vector<Axis, 40>;

/// Normals of faces and of edge pairs for two triangles (separating axis theorem), axis, rim and side normals
/// where a cylinder takes part, all turning with their features; for the last few budgets before a contact,
/// where closest points no longer tell a direction. Empty for other elements.
Axes featureAxes(const PairPiece& piece, const Instant& now, const Element& a, const Element& b);

/// Normals of a cylinder's rim with the vertex and the edge of the other that the closest points name. Where
/// both are curved or sharp nothing but the exact place on the rim tells the normal of the last few budgets.
/// Empty for other pairs.
Axes rimAxes(const PairPiece& piece, const Instant& now, const Element& a, const Element& b,
             const Closest& closest);

/// See the guarantee above; at most `span`. `gap_now` receives the proved gap at s = 0 (<= 0: none).
double apartFor(const GapModel& model, double span, double* gap_now);

}  // namespace collision_node::impact

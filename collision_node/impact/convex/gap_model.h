/// The one proof of clearance: two convex elements stay apart along a moving axis for a stated time.
///
/// Guarantee: apartFor() returns a time s >= 0 such that the elements are farther than `contact_distance`
/// apart, in exact arithmetic of the loaded geometry and the motion model, at every time in [t, t + s]; s ==
/// 0 proves nothing. The axis may be any; a poor one costs time, never a miss. Derivation: docs/solver.md,
/// "The gap model".
#pragma once

#include <boost/container/static_vector.hpp>

#include "collision_node/impact/convex/core_pair.h"
#include "collision_node/impact/convex/gjk.h"

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

/// Lower bounds of the gap along n(s) over [0, end], for any end: at s = x end, 0 <= x <= 1, the gap is at
/// least (1 - x)^2 first + 2 x (1 - x) middle + x^2 last.
class GapModel {
 public:
  /// The cores must outlive the model.
  GapModel(const PairPiece& piece, const Instant& now, const CorePair& cores, const Axis& axis);

  /// The gap now [m], rounding budget already subtracted, like that of all others.
  double first() const { return first_; }

  struct Bounds {
    double first, middle, last;  ///< [m]
    /// Is the quadratic positive throughout?
    bool positive() const {
      return first > 0.0 && last > 0.0 &&
             (middle >= 0.0 || middle * middle < first * last * (1.0 - 16.0 * kUnit));
    }
  };
  Bounds until(double end) const;

  /// About how `last` changes with the end: first + s slope + s^2 bend - s^3 (cubic + s quartic).
  struct Trend {
    double first, slope, bend, cubic, quartic;
    /// Its first root in (0, span]; span where there is none.
    double root(double span) const;
    double at(double s) const { return first + s * (slope + s * (bend - s * (cubic + s * quartic))); }
    double slopeAt(double s) const {
      return slope + s * (2.0 * bend - s * (3.0 * cubic + s * 4.0 * quartic));
    }
  };
  /// With the features that hold it at about its root, where that is within `span`, or else then.
  Trend trend(double span = 0.0) const;

 private:
  void see(const PairPiece& piece, const Instant& now);

  const CorePair& cores_;
  Vec3 direction_, rate_;
  TwoVec3 seen_[3];  ///< the axis as both bodies see it, in the cores' own axes: powers of s
  double length_, rate_length_;
  double level_[3];         ///< of the origins' distance along n(s): powers of s
  double grown_;            ///< both radii and the contact distance
  double cubic_, quartic_;  ///< subtracted: s^3 cubic + s^4 quartic
  double point_error_, rate_error_;
  double first_;
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

/// A time proved as the guarantee above says, at most `span`; and what the model tells of its end.
struct Apart {
  double time = 0.0;     ///< [s]
  double gap = 0.0;      ///< along the axis [m]
  double closing = 0.0;  ///< about how fast that shrinks [m/s]
};
Apart apartFor(const GapModel& model, double span);

}  // namespace collision_node::impact

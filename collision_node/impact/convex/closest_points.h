/// Closest points of two cores without GJK's search for them, and the axis that slides along with them.
///
///     a point or a segment   against   a point, a segment, a cylinder or a box
///
/// The nearest point of each of these to a given one is in closed form (a clamp); along a segment the
/// distance from it is convex, so what is left is the root of one monotone function. A proposal, never a
/// proof, like all closest points.
#pragma once

#include "collision_node/impact/convex/gap_model.h"

namespace collision_node::impact {

/// A core whose nearest point is a clamp, in its own axes: a box (a segment and a point are boxes, too) or a
/// cylinder along z. Places are relative to its centre.
struct ClampingCore {
  explicit ClampingCore(const Element& e);

  const geometry::CoreFrame& frame;
  bool round;
  Vec3 half;            ///< half lengths; of a cylinder its radius, twice, and its half length
  double shrunk = 0.0;  ///< [m] what they were made smaller by

  void shrink(double by) {
    shrunk = std::min(by, half.minCoeff());
    half.array() -= shrunk;
  }

  struct Seen {
    Vec3 offset;  ///< from the nearest point
    double bend;  ///< how fast the offset grows along an edge, times the edge's squared length
  };
  Seen see(const Vec3& x, const Vec3& edge) const;
  /// The derivative of the offset at x: symmetric, between 0 and 1.
  struct Stretch {
    Vec3 own;               ///< along the axes
    double x, y, radially;  ///< and of a cylinder radially (x, y) (x, y)^T

    Vec3 operator*(const Vec3& v) const {
      const double along = radially * (x * v.x() + y * v.y());
      return {own.x() * v.x() + along * x, own.y() * v.y() + along * y, own.z() * v.z()};
    }
  };
  Stretch stretch(const Vec3& x) const;
  /// The share of the edge from `x` on up to the point of it that is nearest.
  double nearestShare(const Vec3& x, const Vec3& edge, double guess) const;
};

/// The closest points of a curve of one core, a segment or a rim, and of the whole other core.
class SlidingPoints {
 public:
  /// Are the two a pair of the table above?
  static bool fit(const Element& a, const Element& b);

  /// Of a pair that fits; the elements must outlive it.
  SlidingPoints(const Element& a, const Element& b);

  /// Finds the closest points; what follows is about those found last.
  void find(const Cores& cores);

  /// Of a segment or a cylinder's rim and another core, which has a frame and is made smaller by `shrunk` [m]
  /// all around, or by as much as there is.
  static SlidingPoints ofCurve(const Element& a, const Element& b, bool curve_is_a, double shrunk = 0.0) {
    SlidingPoints points(a, b, curve_is_a);
    if (shrunk > 0.0) points.solid_.shrink(shrunk);
    return points;
  }

  /// Of the rim on the side of `direction`, from A to B, those near to where it leaves the cylinder. False
  /// where there are none.
  bool findOnRim(const Cores& cores, const Vec3& direction);

  double distance() const { return distance_; }
  bool curveIsA() const { return curve_is_a_; }
  double shrunk() const { return solid_.shrunk; }
  bool insideEdge() const { return slides_; }  ///< no end of the segment
  /// From A to B through the points.
  Vec3 outward() const { return frame_ * (curve_is_a_ ? Vec3(-offset_) : offset_); }
  /// Is the other core's point one of its corners? On its rim?
  bool atCorner() const;
  bool onRim() const { return solid_.round && offset_.z() != 0.0 && !offset_.head<2>().isZero(0.0); }
  /// Is it inside a flat face of a box or a cylinder, and stays there whatever moves by `margin` [m]?
  bool onFace(double margin) const;
  Closest closest(const Cores& cores) const;
  /// From A to B along them, unit; they are apart.
  Vec3 direction() const { return (curve_is_a_ ? -1.0 : 1.0) * (frame_ * acrossCurve()); }
  /// The axis through them, with the rate at which they slide over both cores; invalid when the cores
  /// overlap.
  Axis axis(const RelativeMotion& motion, const Instant& now) const;

 private:
  SlidingPoints(const Element& a, const Element& b, bool curve_is_a);
  /// The offset's direction. What rounding left along a segment would cost its whole length.
  Vec3 acrossCurve() const {
    const Vec3 n = offset_ / distance_;
    return slides_ ? Vec3(n - edge_ * (edge_.dot(n) / edge_.squaredNorm())) : n;
  }

  const Element &a_, &b_;
  const bool curve_is_a_;
  ClampingCore solid_;
  Vec3 place_, edge_w_;         ///< the curve's closest point and the edge in world axes
  Mat3 frame_;                  ///< world <- the solid's own axes, in which the next three are
  Vec3 edge_ = Vec3::Zero();    ///< the whole segment, or the rim's tangent for a radian
  Vec3 x_ = Vec3::Zero();       ///< the curve's closest point, from the solid's centre
  Vec3 offset_ = Vec3::Zero();  ///< from the other core, the solid, to it
  double share_ = 0.0;          ///< of the segment up to it
  bool slides_ = false;         ///< it is no end of the segment
  double curving_ = 0.0;        ///< offset . the rim's second derivative
  Vec3 on_rim_ = Vec3::Zero();  ///< it, in its object's frame
  double distance_ = 0.0;
};

/// A cylinder and the vertices and edges of the other core that `hint` names: their closest points to
/// rounding, where GJK only creeps towards the rim. At most two points, both with one point of the cylinder;
/// none (count 0) for other pairs.
Closest closestOnEdges(const Cores& cores, const Closest& hint);

}  // namespace collision_node::impact

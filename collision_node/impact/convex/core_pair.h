/// The cores of a pair side by side, for what the gap model asks of both.
#pragma once

#include "collision_node/geometry/two_vectors.h"
#include "collision_node/impact/pair_piece.h"

namespace collision_node::impact {

using geometry::Two;
using geometry::TwoMat3;
using geometry::TwoVec3;

/// A direction is a vector u in A's object's frame and a vector v in B's; own() turns them into the axes that
/// a core has of its own, where it has some.
class CorePair {
 public:
  /// The elements must outlive it where they have no frame.
  CorePair(const Element& a, const Element& b);

  /// The largest distances of a core's points from its object's origin, to rounding [m].
  Two reach() const { return reach_; }
  double radius() const { return radius_; }  ///< of both [m]

  /// u . centre of A - v . centre of B; of a core without axes of its own the origin counts as its centre.
  double centresAlong(const TwoVec3& u) const {
    const Two along = dot(u, centre_);
    return along[0] - along[1];
  }
  TwoVec3 own(const TwoVec3& u) const { return turned_ ? axes_.backwards(u) : u; }

  /// max u . x - min v . y over A's and B's points as seen from their centres; own axes. It is convex and
  /// linear in the length of (u, v). A core with axes of its own is symmetric about its centre.
  double reachAlong(const TwoVec3& u) const {
    const Two flat = half_.x * geometry::magnitude(u.x) + half_.y * geometry::magnitude(u.y);
    const Two round = rim_ * geometry::squareRoot(u.x * u.x + u.y * u.y);
    const Two both = (flat + round) + half_.z * geometry::magnitude(u.z);
    const double framed = both[0] + both[1];
    return has_hull_ ? framed + hullsAlong(u) : framed;
  }

  /// value + s rate + s^2 bend along u[0] + s u[1] + s^2 u[2], to the second order, of the features that are
  /// farthest at s = `at`. What is along an edge has no sign until then.
  struct Trend {
    double value, rate, bend;
  };
  Trend trend(const TwoVec3 (&u)[3], double at) const;

 private:
  double hullsAlong(const TwoVec3& u) const;
  void addHulls(const TwoVec3 (&u)[3], const TwoVec3& there, Trend& trend) const;

  TwoVec3 centre_;  ///< object's frame
  TwoVec3 half_;    ///< half lengths of a box, a segment or, along its axis, a cylinder
  Two rim_;         ///< radius of a cylinder
  Two reach_;
  double radius_;
  bool has_hull_, turned_ = false;
  TwoMat3 axes_;            ///< used where `turned_`
  const Element* hull_[2];  ///< cores without axes of their own: all but their reach is 0
};

}  // namespace collision_node::impact

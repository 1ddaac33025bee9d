/// Closest points of two posed convex cores (Gilbert, Johnson, Keerthi 1988), where closest_points.h has no
/// closed form for them. A proposal, never a proof: whatever it returns is checked by gap_model.h or
/// contact_proof.h, so non-convergence costs speed, not correctness.
#pragma once

#include <limits>

#include "collision_node/impact/pair_piece.h"

namespace collision_node::impact {

/// A core point of A and one of B and their difference.
struct SupportPair {
  Vec3 w;                 ///< b - a, world axes
  Vec3 local_a, local_b;  ///< in each object's frame
};

/// An element's core at an instant.
struct PosedCore {
  const Element* element;
  const Mat3* rotation;
  Vec3 origin;  ///< of the object's frame

  /// The core's extreme point along `direction`, in the object's frame.
  Vec3 supportLocal(const Vec3& direction) const;
  Vec3 place(const Vec3& local) const { return *rotation * local + origin; }
};

struct Cores {
  PosedCore a, b;

  Cores(const Instant& now, const Element& ea, const Element& eb)
      : a{&ea, &now.ra, Vec3::Zero()}, b{&eb, &now.rb, now.d} {}

  /// The pair that reaches farthest along `direction` in B - A.
  SupportPair support(const Vec3& direction) const;

  /// How far B lies beyond A along n; |n| = 1 makes it a lower bound of the distance, to rounding [m].
  double gapAlong(const Vec3& n) const {
    return n.dot(b.place(b.supportLocal(-n))) - n.dot(a.place(a.supportLocal(n)));
  }
};

struct Closest {
  int count = 0;  ///< 1..4 points in use
  SupportPair point[4];
  double weight[4] = {};     ///< convex
  Vec3 v = Vec3::Zero();     ///< closest point of B - A to the origin: from A to B
  Vec3 last = Vec3::Zero();  ///< overlap: v before the origin was found inside
  bool overlap = false;      ///< the origin seems to lie inside
  double sure = 0.0;  ///< > 0, from a closed form: v is right to rounding, where that is less than this [m]
};

/// Which points will do instead of the closest ones.
struct GoodEnough {
  double distance = 0.0;  ///< [m] points as close as this
  double loss = 0.0;  ///< or as close as the least distance and this share of what that is beyond `distance`
  /// [m] any, once the cores are seen to be farther apart than this
  double far = std::numeric_limits<double>::infinity();
};

/// Closest points of the cores. `guess` is a first direction, e.g. the last answer's v.
Closest closestPoints(const Cores& cores, const Vec3& guess, const GoodEnough& enough = {});

/// The same, begun with the points that held an earlier answer for the same elements.
Closest closestPoints(const Cores& cores, const Closest& before, const GoodEnough& enough = {});

/// The largest distance of a point of the element's core from its object's origin, to rounding.
double coreReach(const Element& element);

/// The extreme point of an element's core in its object's frame, along a direction in that frame.
Vec3 supportOf(const Element& element, const Vec3& direction);

}  // namespace collision_node::impact

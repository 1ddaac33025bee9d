/// Keeps the triangles that a walk brings and that the body may meet before it has surely met one.
#pragma once

#include <algorithm>

#include "collision_node/impact/straight/path_contact.h"
#include "collision_node/impact/straight/path_walk.h"

namespace collision_node::impact {

class PathCollector : public PathVisitor {
 public:
  /// `limit` [s]: what begins after it is not kept. With `shrinks` it falls to the end of what is surely met.
  PathCollector(PathContact& contact, const PathWalk& walk, double limit, bool shrinks)
      : contact_(contact), walk_(walk), limit_(limit), shrinks_(shrinks) {
    contact.count = 0;
  }
  double limit() const { return limit_; }  ///< [s] what begins after it was not looked for
  bool overflowed() const { return overflowed_; }

 protected:
  using Met = PathContact::Met;

  ~PathCollector() = default;

  /// The triangle alone: nothing is known yet of when.
  static Met metOf(const WideLeaf& leaf, int lane) {
    Met met;
    met.element = leaf.element[lane];
    for (int k = 0; k < 3; ++k) met.vertex[k] = leaf.vertex[k][lane];
    return met;
  }

  /// The walk's new limit.
  float add(const Met& met, float limit) {
    if (met.lower > limit_) return limit;
    if (contact_.count == PathContact::kMost) contact_.keepUntil(limit_);
    if (contact_.count == PathContact::kMost) {
      overflowed_ = true;
      return -1.0f;
    }
    contact_.met[contact_.count++] = met;
    if (!shrinks_ || !met.sure || !(met.upper < limit_)) return limit;
    limit_ = met.upper;
    return std::min(limit, walk_.parameterUp(limit_));
  }

  PathContact& contact_;
  const PathWalk& walk_;
  double limit_;

 private:
  bool shrinks_, overflowed_ = false;
};

}  // namespace collision_node::impact

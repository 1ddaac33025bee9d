/// Is a point inside a closed mesh? By the signed crossings of a ray whose every orientation sign is certain.
#pragma once

#include <boost/container/static_vector.hpp>

#include "collision_node/impact/pair_piece.h"

namespace collision_node::impact {

enum class Where { kInside, kOutside, kUnknown };

/// `solid` is the number of a shape, one of body.solids(). `point` is in the body's frame and known to within
/// `error`. Non-zero winding number is inside. kInside and kOutside are proofs for every point of the ball;
/// kUnknown says nothing.
Where whereIn(const Body& body, int solid, const Vec3& point, double error);

/// Points of elements too narrow to be proved to touch another body's surface, which takes some rounding
/// budgets of width: those that may be deepest inside its solids.
class HiddenPoints {
 public:
  /// `towards` points from A to B.
  void clear(const Vec3& towards) {
    towards_ = towards;
    deepest_.clear();
  }
  void add(const PairPiece& piece, const Instant& now, const Element& a, const Element& b);
  /// Is one of them proved to be inside a solid of the other body? Holds at any instant, whatever touches.
  /// `held` receives it relative to A's origin.
  bool areHeld(const PairPiece& piece, const Instant& now, Vec3* held) const;

 private:
  struct Point {
    Vec3 x;  ///< in its body's frame
    bool of_a;
    double depth;  ///< along `towards`
  };
  void offer(const Point& point);

  Vec3 towards_ = Vec3::Zero();
  boost::container::static_vector<Point, 4> deepest_;
};

/// Does one body's solid hold a part of the other? Meant for an instant at which all surfaces are proved
/// apart. kInside: yes, proved; kOutside: no, proved, for all parts. `held` receives a common point relative
/// to A's origin.
Where containment(const PairPiece& piece, const Instant& now, Vec3* held);

}  // namespace collision_node::impact

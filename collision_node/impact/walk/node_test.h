/// When can two boxes, or two triangles, of a pair touch? The inner loop of the search.
///
/// Guarantee: time that clipChildren() cuts off, and a pair of which nodesApart() or trianglesApart() is
/// true, is proved farther apart than the contact distance. Derivation: docs/solver.md, "The node test".
#pragma once

#include "collision_node/impact/walk/time_slabs.h"

namespace collision_node::impact {

/// An interval of time on the piece's clock [s]; empty when low > high.
struct Span {
  double low, high;
  bool empty() const { return !(low <= high); }
};

class NodeTest {
 public:
  explicit NodeTest(const PairPiece& piece);

  /// The parts of `span`, which lies in the slab, in which the boxes of the children of one node of A
  /// (`of_a`) can be within the contact distance of a node of B, that of `lane` in the block `fixed`, or the
  /// other way round. Returns in which lanes time is left.
  unsigned clipChildren(const Slab& slab, const geometry::BvhBlock& children, bool of_a,
                        const geometry::BvhBlock& fixed, int lane, Span span,
                        Span clipped[geometry::BvhBlock::kWidth]) const;

  /// Are two nodes too far apart to meet in the span, which lies in the slab, however they move?
  bool nodesApart(const Slab& slab, const geometry::BvhBlock& block_a, int lane_a,
                  const geometry::BvhBlock& block_b, int lane_b, Span span) const;

  /// Is one of the faces' planes between the two triangles throughout the span?
  bool trianglesApart(const Slab& slab, const Element& a, const Element& b, Span span) const;

  double grown() const { return grown_; }

 private:
  const PairPiece& piece_;
  double grown_;  ///< contact distance and rounding [m]
  double pad_;    ///< rounding of a clipped time [s]
};

}  // namespace collision_node::impact

/// Linear models of a pair's relative motion on ever smaller slabs of time, made when first asked for.
///
/// Guarantee: for a point y of one body, seen in the other body's frame at s seconds after a slab's middle,
///   | x(s) - (p0 + q0 y + s (p1 + q1 y)) | <= s^2/2 (bend + bend_q |y|)        for |s| <= half,
/// in exact arithmetic; rounding is PairPiece::frame_error + |s| rate_error. Derivation: docs/solver.md, "The
/// node test".
#pragma once

#include <vector>

#include "collision_node/impact/pair_piece.h"

namespace collision_node::impact {

/// One body's points in the other's frame, relative to the middles of both bodies' hierarchies.
/// Rows of four, the last of them zero, so that one load takes a row.
struct SlabView {
  double p0[4], p1[4];        ///< [m], [m/s]
  double q0[3][4], q1[3][4];  ///< rows
  double extent[3][4];        ///< >= |Q(s)| entrywise on the slab
  double bend;                ///< [m/s^2]
};

struct Slab {
  double middle, half;               ///< [s]
  SlabView in_a, in_b;               ///< B's points in A's frame; A's points in B's frame
  double bend_q;                     ///< [1/s^2] times |y|, y from the body's own origin
  double turn;                       ///< [rad/s] |omega_b - omega_a|
  std::int32_t child[2] = {-1, -1};  ///< early and late half, once asked for
};

class TimeSlabs {
 public:
  /// Starts over with one slab over [low, high]. `memory` keeps its capacity.
  TimeSlabs(const PairPiece& piece, std::vector<Slab>& memory) : piece_(piece), slabs_(memory) {}
  void start(double low, double high);

  const Slab& operator[](std::int32_t slab) const { return slabs_[slab]; }
  std::int32_t childOf(std::int32_t slab, bool late);
  std::uint64_t subdivisions() const { return subdivisions_; }
  /// Have there been so many at once that memory is to be spared? Some 400 MB; 600 while the memory grew.
  bool areMany() const { return are_many_; }

 private:
  std::int32_t add(double low, double high);

  const PairPiece& piece_;
  std::vector<Slab>& slabs_;
  std::uint64_t subdivisions_ = 0;
  bool are_many_ = false;
};

}  // namespace collision_node::impact

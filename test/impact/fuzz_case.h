/// Random pairs of moving bodies for the fuzz test: every shape against every other, aimed so that about half
/// hit.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "collision_node/geometry/shape.h"
#include "collision_node/impact/pair_method.h"
#include "test/oracle/pair.h"

namespace fuzz {

struct Case {
  std::uint64_t seed = 0;
  int index = 0;
  std::string kind;  ///< for people: shapes and aim, "box-torus graze"
  std::vector<collision_node::geometry::PlacedShape> a, b;
  collision_node::impact::Piece piece;
  collision_node::impact::PairOptions options;

  oracle::Pair pair() const;
  double duration() const;
  double budget() const;  ///< the solver's stated rounding budget: PairPiece::point_error [m]
  /// Seed, index and every number needed to build the case by hand.
  std::string describe() const;
};

/// Everyday sizes and speeds. The same case for the same seed and index, on any machine with the same libm.
Case makeCase(std::uint64_t seed, int index);

/// The full ranges: sizes of 1e-6 to 1e6 m, mixed; paths of 1e-9 to 3e4 m; up to 3333 rad; offsets of up to
/// 1e8 m; contact distances; precisions down to rounding; aimed to within 1e-12 of touching.
Case makeWideCase(std::uint64_t seed, int index);

/// Degenerate bodies, extreme pieces and motions; see fuzz_edge.cpp.
Case makeEdgeCase(std::uint64_t seed, int index);

}  // namespace fuzz

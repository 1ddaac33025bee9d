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
  /// Seed, index and every number needed to build the case by hand.
  std::string describe() const;
};

/// The same case for the same seed and index, on any machine with the same libm.
Case makeCase(std::uint64_t seed, int index);

}  // namespace fuzz

/// Do two bodies touch at an instant? What every method that looks at single instants uses here, so that none
/// is blamed for a poor static test: exact, from a hierarchy, and free of the world's offset.
#pragma once

#include <limits>

#include "collision_node/impact/pair_piece.h"
#include "collision_node/impact/walk/search.h"
#include "collision_node/report/methods/peer_models.h"

namespace collision_node::report {

class StaticTest {
 public:
  explicit StaticTest(const QuerySet& set) : set_(set) {}

  /// The certified solver's proof for one instant, `seconds` after the piece's start. What it cannot decide
  /// (bodies nearer than its rounding) counts as touching.
  bool touching(const Query& query, double seconds) {
    impact::Piece still;
    still.end_ns = 1;
    still.a = motion::fixedAt(placeA(query.piece, seconds));
    still.b = motion::fixedAt(placeB(query.piece, seconds));
    const impact::PairPiece piece(*set_.bodies[query.a], *set_.bodies[query.b], still, 0.0);
    impact::Search search(piece, std::numeric_limits<std::uint64_t>::max(), workspace_);
    return search.classify(0.0, &witness_) != impact::Proved::kApart;
  }

 private:
  const QuerySet& set_;
  impact::Workspace workspace_;
  impact::ContactWitness witness_;
};

}  // namespace collision_node::report

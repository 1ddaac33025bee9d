/// Do two bodies touch at an instant? What every method that looks at single instants uses here, so that none
/// is blamed for a poor static test: exact, from a hierarchy, and free of the world's offset.
#pragma once

#include <limits>
#include <optional>

#include "collision_node/impact/pair_piece.h"
#include "collision_node/impact/search.h"
#include "collision_node/report/query_sets.h"

namespace collision_node::report {

class StaticTest {
 public:
  explicit StaticTest(const QuerySet& set) : set_(set) {}

  /// The instants asked for from now on are those of `query`.
  void begin(const Query& query) {
    search_.reset();
    piece_.emplace(*set_.bodies[query.a], *set_.bodies[query.b], query.piece, 0.0);
    search_.emplace(*piece_, std::numeric_limits<std::uint64_t>::max(), workspace_);
  }

  /// The certified solver's proof for one instant, `seconds` after the piece's start. What it cannot decide
  /// (bodies nearer than its rounding) counts as touching.
  bool touching(double seconds) { return search_->classify(seconds, &witness_) != impact::Proved::kApart; }

 private:
  const QuerySet& set_;
  impact::Workspace workspace_;
  impact::ContactWitness witness_;
  std::optional<impact::PairPiece> piece_;
  std::optional<impact::Search> search_;
};

}  // namespace collision_node::report

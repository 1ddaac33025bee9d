/// Whoever answers the queries of a set: ours or a peer. One interface, so that a row never knows whom it
/// runs.
#pragma once

#include <memory>
#include <string>

#include "collision_node/report/query_sets.h"

namespace collision_node::report {

enum class Verdict { kClear, kHit, kUndecided };

struct Answer {
  Verdict verdict = Verdict::kUndecided;
  double toi_lower = 0.0, toi_upper = 0.0;  ///< [s] from the piece's start; equal when only one time is known
  double closing_speed = 0.0;               ///< [m/s] at the contact; 0 when not known
};

/// Built for one set, which must outlive it: models are made once, everything that belongs to a query
/// (motions, requests) is made in answer(), for ours as for peers. One thread at a time.
class Contestant {
 public:
  virtual ~Contestant() = default;
  virtual std::string name() const = 0;
  virtual Answer answer(const Query& query) = 0;
  /// How far a time it reports may lie before the contact by its own word: what a gap takes to close [m],
  /// plus [s].
  virtual double stopsAtGap() const { return 0.0; }
  virtual double timeRounding() const { return 0.0; }
};

constexpr double kPrecision = 1e-9;  ///< [s] what ours is asked for, and what lateness forgives

using ContestantPtr = std::unique_ptr<Contestant>;

/// The certified solver: first contact, to kPrecision. A hit is a CONFIRMED contact; POSSIBLE is undecided.
ContestantPtr makeOurs(const QuerySet& set);

}  // namespace collision_node::report

/// Whoever answers the queries of a set: ours or a peer. One interface, so that a row never knows whom it
/// runs.
#pragma once

#include <limits>
#include <memory>
#include <string>

#include "collision_node/report/query_sets.h"

namespace collision_node::report {

enum class Verdict { kClear, kHit, kUndecided };

struct Answer {
  Verdict verdict = Verdict::kUndecided;
  double toi_lower = 0.0, toi_upper = 0.0;  ///< [s] from the piece's start; equal when only one time is known
  double closing_speed = 0.0;               ///< [m/s] at the contact; 0 when not known
  geometry::Vec3 point =                    ///< world [m]; NaN when the method names none
      geometry::Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
  double position_error = std::numeric_limits<double>::quiet_NaN();  ///< [m] claimed; NaN: no claim
  bool certified = false;  ///< the method claims that its times and its ball are bounds
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

/// The certified solver's first contact. A hit is a CONFIRMED contact; POSSIBLE is undecided, with its
/// bracket.
ContestantPtr makeOurs(const QuerySet& set, const impact::PairOptions& options);

/// To kPrecision.
ContestantPtr makeOurs(const QuerySet& set);

}  // namespace collision_node::report

/// A pair under the certified solver, piece by piece, with its events at hand.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "collision_node/impact/pair_method.h"
#include "test/impact/moving_pair.h"

namespace moving {

using collision_node::impact::Answer;
using collision_node::impact::Certificate;
using collision_node::impact::Kind;
using collision_node::impact::PairEvent;
using collision_node::impact::PairOptions;
using collision_node::impact::PairState;
using collision_node::impact::PieceOutcome;
using collision_node::impact::Reason;

constexpr Nanoseconds kFrame = 33'333'333;  ///< [ns] 30 Hz

/// Everything a failure needs to show.
inline std::string listOf(const std::vector<PairEvent>& events) {
  std::ostringstream out;
  out.precision(17);
  for (const PairEvent& e : events) {
    out << toString(e.kind) << ' ' << toString(e.certificate) << ' ' << toString(e.reason) << " start "
        << e.interval_start_ns << " ns toi [" << e.toi_lower << ", " << e.toi_upper << "] width "
        << e.toi_upper - e.toi_lower << " at " << e.position.transpose() << " +- " << e.position_error
        << " normal " << e.normal.transpose() << " +- " << e.normal_error << " features "
        << toString(e.a.feature) << '/' << toString(e.b.feature) << '\n';
  }
  return out.str();
}

class Watched {
 public:
  Watched(Shapes a, Shapes b, const PairOptions& options = {})
      : a_(std::move(a)), b_(std::move(b)), method_(collision_node::impact::makeCertified(a_, b_, options)) {}

  PieceOutcome advance(const Piece& piece) { return method_->advance(piece, state, events); }
  PieceOutcome advance(Nanoseconds start_ns, Nanoseconds end_ns, const RigidMotion& a, const RigidMotion& b) {
    return advance({start_ns, end_ns, a, b});
  }
  /// The same two motions, the time cut into `count` pieces.
  void advanceInParts(Nanoseconds start_ns, Nanoseconds end_ns, const RigidMotion& a, const RigidMotion& b,
                      int count) {
    for (int i = 0; i < count; ++i) {
      advance(start_ns + (end_ns - start_ns) * i / count, start_ns + (end_ns - start_ns) * (i + 1) / count, a,
              b);
    }
  }
  void finish() { method_->finish(state, events); }
  void interrupt(Reason reason) { method_->interrupt(state, reason, events); }

  /// Kinds and certificates in order: "IMPACT CONFIRMED, SEPARATION CONFIRMED".
  std::string story() const {
    std::string text;
    for (const PairEvent& e : events) {
      text += (text.empty() ? "" : ", ") + std::string(toString(e.kind)) + " " + toString(e.certificate);
    }
    return text;
  }
  std::string list() const { return listOf(events); }
  int count(Kind kind) const {
    return static_cast<int>(
        std::count_if(events.begin(), events.end(), [&](const PairEvent& e) { return e.kind == kind; }));
  }

  PairState state;
  std::vector<PairEvent> events;

 private:
  const Body a_, b_;
  std::unique_ptr<collision_node::impact::PairMethod> method_;
};

/// The bracket in seconds from `from_ns`.
inline Real lowerOf(const PairEvent& e, Nanoseconds from_ns) {
  return static_cast<Real>(e.interval_start_ns - from_ns) * 1e-9L + e.toi_lower;
}
inline Real upperOf(const PairEvent& e, Nanoseconds from_ns) {
  return static_cast<Real>(e.interval_start_ns - from_ns) * 1e-9L + e.toi_upper;
}
inline double widthOf(const PairEvent& e) { return e.toi_upper - e.toi_lower; }

/// Whether the bracket holds a time known to `error` [s].
inline bool holds(const PairEvent& e, Nanoseconds from_ns, Real time, Real error = 1e-15L) {
  return lowerOf(e, from_ns) <= time + error && upperOf(e, from_ns) >= time - error;
}

constexpr const char* kInAndOut = "IMPACT CONFIRMED, SEPARATION CONFIRMED";

}  // namespace moving

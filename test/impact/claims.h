/// What a list of events says of a piece's time, and whether two lists about the same motion can both be
/// right.
#pragma once

#include <string>

#include "test/impact/watched_pair.h"

namespace moving {

/// Neither apart nor touching: a bracket, nothing is said.
enum class Said { kApart, kTouching, kOpen };

struct Claim {
  Said said;
  double from, to;
};

/// The claims of a pair's events over [0, duration], in order and without holes.
inline std::vector<Claim> claimsOf(const std::vector<PairEvent>& events, double duration) {
  std::vector<Claim> claims;
  double since = 0.0;
  Said said = Said::kApart;
  const auto until = [&](double t) {
    if (t > since) claims.push_back({said, since, t});
    since = std::max(since, t);
  };
  for (const PairEvent& e : events) {
    if (e.kind != Kind::kInitialOverlap) until(e.toi_lower);
    said = Said::kOpen;
    until(e.toi_upper);
    if (e.certificate == Certificate::kConfirmed) {
      said = e.kind == Kind::kSeparation ? Said::kApart : Said::kTouching;
    } else {
      // POSSIBLE stands alone: apart behind it, but for one that is open to the end, or an overlap of which
      // only its end is known.
      said = Said::kApart;
    }
  }
  until(duration);
  return claims;
}

/// Empty when both can be right: nowhere is one apart and the other touching for longer than `merged`, and no
/// confirmed contact of one lies where the other says apart. Times may be off by `slack`.
inline std::string contradiction(const std::vector<PairEvent>& x, const std::vector<PairEvent>& y,
                                 double duration, double slack, double merged) {
  std::ostringstream out;
  out.precision(17);
  const auto against = [&](const std::vector<PairEvent>& one, const std::vector<PairEvent>& other) {
    for (const Claim& claim : claimsOf(other, duration)) {
      if (claim.said != Said::kApart) continue;
      for (const Claim& mine : claimsOf(one, duration)) {
        const double overlap = std::min(claim.to, mine.to) - std::max(claim.from, mine.from);
        if (mine.said == Said::kTouching && overlap > 2 * slack + merged)
          out << "touching on [" << mine.from << ", " << mine.to << "], apart on [" << claim.from << ", "
              << claim.to << "]\n";
      }
      for (const PairEvent& e : one) {
        if (e.certificate == Certificate::kConfirmed && e.kind == Kind::kImpact &&
            e.toi_lower - slack > claim.from && e.toi_upper + slack < claim.to)
          out << "contact in [" << e.toi_lower << ", " << e.toi_upper << "], apart on [" << claim.from << ", "
              << claim.to << "]\n";
      }
    }
  };
  against(x, y);
  against(y, x);
  return out.str();
}

}  // namespace moving

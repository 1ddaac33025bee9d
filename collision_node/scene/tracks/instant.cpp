#include "collision_node/scene/tracks/instant.h"

#include <cmath>
#include <limits>

namespace collision_node::scene {

Instant instantAt(Nanoseconds start_ns, double seconds) {
  // seconds * 1e9 = high + low exactly (fma), and high splits exactly into its floor and a fraction.
  const double high = seconds * 1e9;
  const double low = std::fma(seconds, 1e9, -high);
  const double whole = std::floor(high);
  double fraction = high - whole;
  Instant instant;
  instant.ns = start_ns + static_cast<Nanoseconds>(whole);
  if (fraction == 0.0 && low < 0.0) {
    instant.ns -= 1;
    fraction = 1.0;
  }
  // |low| <= ulp(high)/2 <= fraction unless fraction is zero: the sum's own rounding error is exact (Dekker).
  instant.part = fraction + low;
  const double kept = instant.part - fraction;
  instant.rest = fraction == 0.0 ? 0.0 : low - kept;
  return instant;
}

Nanoseconds toNanoseconds(double seconds) {
  constexpr double kFar = 4e18;  // [ns] 126 years; two such still add up in 63 bits
  const double ns = seconds * 1e9;
  if (!(ns < kFar)) return static_cast<Nanoseconds>(kFar);
  if (!(ns > -kFar)) return -static_cast<Nanoseconds>(kFar);
  return std::llround(ns);
}

}  // namespace collision_node::scene

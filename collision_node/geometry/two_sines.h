/// Sines and cosines of two angles side by side, in the time that the C library takes for a part of one.
///
/// Guarantee: each is within 2 u of the exact value, u = 2^-53, and the same on every machine. (Beyond |x| =
/// 2^20 those of the C library.)
///
/// Derivation. k = round(2 x / pi) and r = (x - k P) - k Q, where P is pi/2 cut off after 2^-32 and Q the
/// double nearest to what is left. Up to |x| = 2^20, k has 20 bits and P 33, so k P is exact, and so is x - k
/// P, a multiple of x's last bit that is below 1. Q is off by 2^-88 and k Q is rounded by 2^-67: together
/// below u/2^13. What is rounded is the last difference, by u/2 at most, since |r| < 1. Up to |r| = pi/4 and
/// the 2^-32 by which k may be rounded to the wrong side, the power series are cut off where u/50 is left. Of
/// r's sine, what is added to r is below 0.081 and off by less than 5 u of that, and the sum is rounded by
/// u/2: with r's own error below 1.5 u. Of r's cosine, 1 - r^2/2 is off by u/4 + u/2 and the rest, below
/// 0.016, by less than 8 u of that; the sum is rounded by u/2, and r's error counts by sin(r) <= 0.71:
/// below 1.8 u.
#pragma once

#include <cmath>

#include "collision_node/geometry/two_vectors.h"

namespace collision_node::geometry {

struct TwoSines {
  Two sine, cosine;
};

inline TwoSines sinesOf(Two x) {
  constexpr double kMost = 0x1p20;
  if (!(std::abs(x[0]) <= kMost && std::abs(x[1]) <= kMost))
    return {Two{std::sin(x[0]), std::sin(x[1])}, Two{std::cos(x[0]), std::cos(x[1])}};
  constexpr double kPerQuarter = 0x1.45f306dc9c883p-1, kP = 0x1.921fb544p+0, kQ = 0x1.0b4611a626331p-34;
  constexpr double kToInteger = 0x1.8p52;  // its sum with a number has that number's integer in the last bits
  const Two shifted = x * twice(kPerQuarter) + twice(kToInteger);
  const TwoBits quarters = (TwoBits)shifted;
  const Two k = shifted - twice(kToInteger);
  const Two r = (x - k * twice(kP)) - k * twice(kQ), r2 = r * r, r4 = r2 * r2, r8 = r4 * r4;
  const auto pair = [&r2](double low, double high) { return twice(low) + r2 * twice(high); };
  const Two s = r + r * (r2 * ((pair(-1.0 / 6, 1.0 / 120) + r4 * pair(-1.0 / 5040, 1.0 / 362880)) +
                               r8 * (pair(-1.0 / 39916800, 1.0 / 6227020800) +
                                     r4 * pair(-1.0 / 1307674368000, 1.0 / 355687428096000))));
  const Two c = (twice(1.0) - twice(0.5) * r2) +
                r4 * ((pair(1.0 / 24, -1.0 / 720) + r4 * pair(1.0 / 40320, -1.0 / 3628800)) +
                      r8 * (pair(1.0 / 479001600, -1.0 / 87178291200) + r4 * twice(1.0 / 20922789888000)));
  const TwoBits odd = -(quarters & 1);
  const auto either = [&odd](Two if_odd, Two if_even) {
    return ((TwoBits)if_odd & odd) | ((TwoBits)if_even & ~odd);
  };
  constexpr int kToSign = 62;  // from bit 1
  return {(Two)(either(c, s) ^ ((quarters & 2) << kToSign)),
          (Two)(either(s, c) ^ (((quarters + 1) & 2) << kToSign))};
}

}  // namespace collision_node::geometry

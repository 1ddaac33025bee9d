/// Numbers of about 106 bits as unevaluated sums of two doubles, and the exact sums and products under them.
///
/// Guarantee: twoSum and twoProduct are exact; +, - and * of DoubleDouble have a relative error of at most
/// 2^-103. All of it holds while nothing overflows and no product falls below 2^-960; -ffp-contract=off and
/// round-to-nearest are assumed. Source: Knuth and Dekker for the exact operations; Joldes, Muller and
/// Popescu, "Tight and rigorous error bounds for basic building blocks of double-word arithmetic", 2017, for
/// the bounds (3 u^2 + 13 u^3 and 8 u^2 with u = 2^-53).
#pragma once

#include <cmath>

namespace collision_node::impact {

/// A sum or product and what its rounding left: high + low is exact.
struct DoubleDouble {
  double high = 0.0, low = 0.0;

  DoubleDouble() = default;
  DoubleDouble(double value) : high(value) {}  // NOLINT(runtime/explicit): a double is a DoubleDouble
  DoubleDouble(double h, double l) : high(h), low(l) {}
};

inline DoubleDouble twoSum(double a, double b) {
  const double sum = a + b;
  const double b_part = sum - a;
  return {sum, (a - (sum - b_part)) + (b - b_part)};
}

/// Needs |a| >= |b| or a == 0.
inline DoubleDouble quickTwoSum(double a, double b) {
  const double sum = a + b;
  return {sum, b - (sum - a)};
}

inline DoubleDouble twoProduct(double a, double b) {
  constexpr double kSplit = 134217729.0;  // 2^27 + 1
  const double product = a * b;
  const double a_wide = kSplit * a, b_wide = kSplit * b;
  const double a_high = a_wide - (a_wide - a), b_high = b_wide - (b_wide - b);
  const double a_low = a - a_high, b_low = b - b_high;
  return {product, ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low};
}

inline DoubleDouble operator-(const DoubleDouble& a) { return {-a.high, -a.low}; }

inline DoubleDouble operator+(const DoubleDouble& a, const DoubleDouble& b) {
  const DoubleDouble s = twoSum(a.high, b.high), t = twoSum(a.low, b.low);
  const DoubleDouble v = quickTwoSum(s.high, s.low + t.high);
  return quickTwoSum(v.high, t.low + v.low);
}

inline DoubleDouble operator-(const DoubleDouble& a, const DoubleDouble& b) { return a + (-b); }

inline DoubleDouble operator*(const DoubleDouble& a, const DoubleDouble& b) {
  const DoubleDouble p = twoProduct(a.high, b.high);
  return quickTwoSum(p.high, p.low + (a.high * b.low + a.low * b.high));
}

/// Good to about 100 bits; nothing is proved with it.
inline DoubleDouble operator/(const DoubleDouble& a, const DoubleDouble& b) {
  const double first = a.high / b.high;
  const DoubleDouble rest = a - b * first;
  return quickTwoSum(first, rest.high / b.high);
}

inline double toDouble(double a) { return a; }
inline double toDouble(const DoubleDouble& a) { return a.high; }

/// Largest relative error of one operation.
template <typename Real>
constexpr double kRounding = 0x1p-53;
template <>
inline constexpr double kRounding<DoubleDouble> = 0x1p-103;

}  // namespace collision_node::impact

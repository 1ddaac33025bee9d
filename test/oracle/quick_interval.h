/// Closed intervals of doubles whose ends are moved outward after each operation: as sound as interval.h, a
/// hundred times as fast, and as coarse as doubles are.
#pragma once

#include <algorithm>
#include <cmath>

#include "test/oracle/interval.h"

namespace oracle {

struct Quick {
  double lo, hi;

  Quick(double value = 0) : lo(value), hi(value) {}
  Quick(double low, double high) : lo(low), hi(high) {}

  bool positive() const { return lo > 0; }
  bool negative() const { return hi < 0; }
};

/// At least one step of a double, also below the normal numbers.
inline double stepOf(double x) { return std::abs(x) * 0x1p-52 + 0x1p-1074; }
/// What was rounded to nearest, rounded outward.
inline Quick outward(double lo, double hi) { return {lo - stepOf(lo), hi + stepOf(hi)}; }

inline Quick operator-(const Quick& a) { return {-a.hi, -a.lo}; }
inline Quick operator+(const Quick& a, const Quick& b) { return outward(a.lo + b.lo, a.hi + b.hi); }
inline Quick operator-(const Quick& a, const Quick& b) { return outward(a.lo - b.hi, a.hi - b.lo); }
inline Quick operator*(const Quick& a, const Quick& b) {
  const double w = a.lo * b.lo, x = a.lo * b.hi, y = a.hi * b.lo, z = a.hi * b.hi;
  return outward(std::min(std::min(w, x), std::min(y, z)), std::max(std::max(w, x), std::max(y, z)));
}
/// The divisor must not hold zero.
inline Quick operator/(const Quick& a, const Quick& b) { return a * outward(1 / b.hi, 1 / b.lo); }

/// As for Interval; glibc's sine and cosine are within one step.
inline void sineAndCosine(const Quick& angle, Quick& sine, Quick& cosine) {
  const double middle = 0.5 * (angle.lo + angle.hi);
  const double reach = std::max(angle.hi - middle, middle - angle.lo) * (1 + 0x1p-50) + 0x1p-51;
  const auto around = [&](double value) {
    return Quick(std::max(-1.0, value - reach), std::min(1.0, value + reach));
  };
  sine = around(std::sin(middle));
  cosine = around(std::cos(middle));
}

/// Either kind of interval, and the numbers that are its ends, by the same names.
inline void convert(const Interval& from, Interval& to) { to = from; }
inline void convert(const Interval& from, Quick& to) {
  to = {from.lo.toDouble(MPFR_RNDD), from.hi.toDouble(MPFR_RNDU)};
}
template <class I>
Vector<I> converted(const I3& v) {
  Vector<I> r;
  for (std::size_t k = 0; k < 3; ++k) convert(v[k], r[k]);
  return r;
}
inline double middleOf(const Quick& t) { return 0.5 * (t.lo + t.hi); }
inline Mp middleOf(const Interval& t) {
  Mp m;
  mpfr_add(m.raw(), t.lo.raw(), t.hi.raw(), MPFR_RNDN);
  mpfr_div_2ui(m.raw(), m.raw(), 1, MPFR_RNDN);
  return m;
}
/// Never too small.
inline double widthOf(const Quick& t) { return (t.hi - t.lo) * (1 + 0x1p-50); }
inline double widthOf(const Interval& t) {
  Mp w;
  mpfr_sub(w.raw(), t.hi.raw(), t.lo.raw(), MPFR_RNDU);
  return w.toDouble(MPFR_RNDU);
}

}  // namespace oracle

/// Closed intervals of MPFR numbers: every operation rounds its ends outward, so the exact result is always
/// inside.
#pragma once

#include <mpfr.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <type_traits>

namespace oracle {

/// A number of kBits bits that holds its own digits and copies like a double.
class Mp {
 public:
  static constexpr mpfr_prec_t kBits = 240;

  Mp(double value = 0) {
    init();
    mpfr_set_d(v_, value, MPFR_RNDN);  // exact: a double has 53 bits
  }
  Mp(const Mp& other) {
    init();
    mpfr_set(v_, other.v_, MPFR_RNDN);
  }
  Mp& operator=(const Mp& other) {
    mpfr_set(v_, other.v_, MPFR_RNDN);
    return *this;
  }

  mpfr_ptr raw() { return v_; }
  mpfr_srcptr raw() const { return v_; }
  double toDouble(mpfr_rnd_t rounding = MPFR_RNDN) const { return mpfr_get_d(v_, rounding); }
  int sign() const { return mpfr_sgn(v_); }
  friend bool operator<(const Mp& a, const Mp& b) { return mpfr_less_p(a.v_, b.v_) != 0; }

 private:
  void init() { mpfr_custom_init_set(v_, MPFR_ZERO_KIND, 0, kBits, digits_); }

  mp_limb_t digits_[(kBits + GMP_NUMB_BITS - 1) / GMP_NUMB_BITS];
  mpfr_t v_;
};

struct Interval {
  Mp lo, hi;

  Interval(double value = 0) : lo(value), hi(value) {}
  Interval(const Mp& low, const Mp& high) : lo(low), hi(high) {}

  bool positive() const { return lo.sign() > 0; }
  bool negative() const { return hi.sign() < 0; }
  bool holdsZero() const { return !positive() && !negative(); }
};

inline Interval operator-(const Interval& a) {
  Interval r;
  mpfr_neg(r.lo.raw(), a.hi.raw(), MPFR_RNDD);
  mpfr_neg(r.hi.raw(), a.lo.raw(), MPFR_RNDU);
  return r;
}
inline Interval operator+(const Interval& a, const Interval& b) {
  Interval r;
  mpfr_add(r.lo.raw(), a.lo.raw(), b.lo.raw(), MPFR_RNDD);
  mpfr_add(r.hi.raw(), a.hi.raw(), b.hi.raw(), MPFR_RNDU);
  return r;
}
inline Interval operator-(const Interval& a, const Interval& b) {
  Interval r;
  mpfr_sub(r.lo.raw(), a.lo.raw(), b.hi.raw(), MPFR_RNDD);
  mpfr_sub(r.hi.raw(), a.hi.raw(), b.lo.raw(), MPFR_RNDU);
  return r;
}
inline Interval operator*(const Interval& a, const Interval& b) {
  Interval r;
  const auto set = [&](const Mp& x_lo, const Mp& y_lo, const Mp& x_hi, const Mp& y_hi) {
    mpfr_mul(r.lo.raw(), x_lo.raw(), y_lo.raw(), MPFR_RNDD);
    mpfr_mul(r.hi.raw(), x_hi.raw(), y_hi.raw(), MPFR_RNDU);
  };
  // The signs tell which ends make the extremes; only two intervals around zero have four candidates.
  if (a.lo.sign() >= 0) {
    set(b.lo.sign() >= 0 ? a.lo : a.hi, b.lo, b.hi.sign() >= 0 ? a.hi : a.lo, b.hi);
  } else if (a.hi.sign() <= 0) {
    set(b.hi.sign() >= 0 ? a.lo : a.hi, b.hi, b.lo.sign() >= 0 ? a.hi : a.lo, b.lo);
  } else if (b.lo.sign() >= 0) {
    set(a.lo, b.hi, a.hi, b.hi);
  } else if (b.hi.sign() <= 0) {
    set(a.hi, b.lo, a.lo, b.lo);
  } else {
    Interval other;
    set(a.lo, b.hi, a.hi, b.hi);
    mpfr_mul(other.lo.raw(), a.hi.raw(), b.lo.raw(), MPFR_RNDD);
    mpfr_mul(other.hi.raw(), a.lo.raw(), b.lo.raw(), MPFR_RNDU);
    if (other.lo < r.lo) r.lo = other.lo;
    if (r.hi < other.hi) r.hi = other.hi;
  }
  return r;
}
/// The divisor must not hold zero.
inline Interval operator/(const Interval& a, const Interval& b) {
  Interval inverse;
  mpfr_ui_div(inverse.lo.raw(), 1, b.hi.raw(), MPFR_RNDD);
  mpfr_ui_div(inverse.hi.raw(), 1, b.lo.raw(), MPFR_RNDU);
  return a * inverse;
}
/// Exact seconds between two stamps, as an enclosure.
inline Interval exactSeconds(std::int64_t from_ns, std::int64_t to_ns) {
  return Interval(static_cast<double>(to_ns - from_ns)) / Interval(1e9);  // both exact: spans below 2^53 ns
}

/// Of an interval of numbers >= 0.
inline Interval sqrt(const Interval& a) {
  Interval r;
  mpfr_sqrt(r.lo.raw(), a.lo.raw(), MPFR_RNDD);
  mpfr_sqrt(r.hi.raw(), a.hi.raw(), MPFR_RNDU);
  return r;
}

/// The angle in (-pi/2, pi/2) whose tangent is a.
inline Interval arctan(const Interval& a) {
  Interval r;
  mpfr_atan(r.lo.raw(), a.lo.raw(), MPFR_RNDD);
  mpfr_atan(r.hi.raw(), a.hi.raw(), MPFR_RNDU);
  return r;
}
inline Interval wholeTurn() {
  Interval r;
  mpfr_const_pi(r.lo.raw(), MPFR_RNDD);
  mpfr_const_pi(r.hi.raw(), MPFR_RNDU);
  return r + r;
}

/// Sine and cosine over an interval: the value at its middle, which a width of w changes by at most w/2 (and
/// never beyond one).
inline void sineAndCosine(const Interval& angle, Interval& sine, Interval& cosine) {
  Mp middle, reach, other;
  mpfr_add(middle.raw(), angle.lo.raw(), angle.hi.raw(), MPFR_RNDN);
  mpfr_div_2ui(middle.raw(), middle.raw(), 1, MPFR_RNDN);
  mpfr_sub(reach.raw(), angle.hi.raw(), middle.raw(), MPFR_RNDU);
  mpfr_sub(other.raw(), middle.raw(), angle.lo.raw(), MPFR_RNDU);
  mpfr_max(reach.raw(), reach.raw(), other.raw(), MPFR_RNDU);
  const auto widen = [&](Interval& r) {
    mpfr_sub(r.lo.raw(), r.lo.raw(), reach.raw(), MPFR_RNDD);
    mpfr_add(r.hi.raw(), r.hi.raw(), reach.raw(), MPFR_RNDU);
    if (mpfr_cmp_si(r.lo.raw(), -1) < 0) mpfr_set_si(r.lo.raw(), -1, MPFR_RNDD);
    if (mpfr_cmp_si(r.hi.raw(), 1) > 0) mpfr_set_si(r.hi.raw(), 1, MPFR_RNDU);
  };
  mpfr_sin(sine.lo.raw(), middle.raw(), MPFR_RNDD);
  mpfr_sin(sine.hi.raw(), middle.raw(), MPFR_RNDU);
  mpfr_cos(cosine.lo.raw(), middle.raw(), MPFR_RNDD);
  mpfr_cos(cosine.hi.raw(), middle.raw(), MPFR_RNDU);
  widen(sine);
  widen(cosine);
}

template <class I>
using Vector = std::array<I, 3>;
using I3 = Vector<Interval>;

/// Any Eigen 3-vector of doubles, taken exactly.
template <class EigenVector>
I3 interval3(const EigenVector& v) {
  return {Interval(v[0]), Interval(v[1]), Interval(v[2])};
}
template <class I>
Vector<I> plus(const Vector<I>& a, const Vector<I>& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
template <class I>
Vector<I> minus(const Vector<I>& a, const Vector<I>& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
template <class I>
Vector<I> times(const std::common_type_t<I>& s, const Vector<I>& a) {
  return {s * a[0], s * a[1], s * a[2]};
}
template <class I>
I dotOf(const Vector<I>& a, const Vector<I>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
template <class I>
Vector<I> crossOf(const Vector<I>& a, const Vector<I>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline Interval lengthOf(const I3& a) { return sqrt(dotOf(a, a)); }

}  // namespace oracle

/// When two convex sets meet under a pure translation, in rational arithmetic: exact to the last bit of the
/// input, through every degenerate case.
#pragma once

#include <gmpxx.h>

#include <array>
#include <optional>
#include <vector>

namespace oracle {

using Rational = mpq_class;
struct R3 : std::array<Rational, 3> {};

/// Any Eigen 3-vector of doubles, taken exactly.
template <class EigenVector>
R3 rational(const EigenVector& v) {
  return {Rational(v[0]), Rational(v[1]), Rational(v[2])};
}
inline R3 operator-(const R3& a, const R3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline R3 operator+(const R3& a, const R3& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
inline R3 operator*(const Rational& s, const R3& a) { return {s * a[0], s * a[1], s * a[2]}; }

/// The times (on the whole real line) at which they share a point, and one shared point of the resting set at
/// the first of them.
struct ContactTimes {
  Rational first, last;
  R3 point;
};

/// Solves sum of columns times unknowns = right side, 4 equations. Nothing when the columns are dependent or
/// there is no solution.
inline std::optional<std::vector<Rational>> solveExactly(std::vector<std::array<Rational, 4>> columns,
                                                         std::array<Rational, 4> right) {
  const std::size_t n = columns.size();
  for (std::size_t k = 0; k < n; ++k) {
    std::size_t pivot = k;
    while (pivot < 4 && columns[k][pivot] == 0) ++pivot;
    if (pivot == 4) return std::nullopt;
    for (auto& column : columns) std::swap(column[k], column[pivot]);
    std::swap(right[k], right[pivot]);
    for (std::size_t row = 0; row < 4; ++row) {
      if (row == k || columns[k][row] == 0) continue;
      const Rational factor = columns[k][row] / columns[k][k];
      for (std::size_t j = k; j < n; ++j) columns[j][row] -= factor * columns[j][k];
      right[row] -= factor * right[k];
    }
  }
  for (std::size_t row = n; row < 4; ++row) {
    if (right[row] != 0) return std::nullopt;
  }
  std::vector<Rational> x(n);
  for (std::size_t k = 0; k < n; ++k) x[k] = right[k] / columns[k][k];
  return x;
}

/// `moving` shifted by `offset` + t `velocity` (not zero) against `resting`, both hulls of a few points. They
/// share a point where offset + t velocity lies in the hull of the differences resting - moving. The least
/// and the largest such t are linear programmes, so each is attained with at most three differences whose
/// columns are independent; all choices are tried.
inline std::optional<ContactTimes> contactTimes(const std::vector<R3>& resting, const std::vector<R3>& moving,
                                                const R3& offset, const R3& velocity) {
  struct Difference {
    R3 w;
    std::size_t of;
  };
  std::vector<Difference> all;
  for (std::size_t i = 0; i < resting.size(); ++i) {
    for (const R3& m : moving) all.push_back({resting[i] - m, i});
  }
  std::optional<ContactTimes> best;
  const auto attempt = [&](const std::vector<std::size_t>& chosen) {
    std::vector<std::array<Rational, 4>> columns;
    for (const std::size_t k : chosen) columns.push_back({all[k].w[0], all[k].w[1], all[k].w[2], 1});
    columns.push_back({-velocity[0], -velocity[1], -velocity[2], 0});
    const auto x = solveExactly(columns, {offset[0], offset[1], offset[2], 1});
    if (!x) return;
    for (std::size_t k = 0; k < chosen.size(); ++k) {
      if ((*x)[k] < 0) return;
    }
    const Rational& t = x->back();
    if (best && t > best->last) best->last = t;
    if (best && t >= best->first) return;
    R3 point{0, 0, 0};
    for (std::size_t k = 0; k < chosen.size(); ++k) point = point + (*x)[k] * resting[all[chosen[k]].of];
    best = ContactTimes{t, best ? best->last : t, point};
  };
  for (std::size_t i = 0; i < all.size(); ++i) {
    attempt({i});
    for (std::size_t j = 0; j < i; ++j) {
      attempt({i, j});
      for (std::size_t k = 0; k < j; ++k) attempt({i, j, k});
    }
  }
  return best;
}

}  // namespace oracle

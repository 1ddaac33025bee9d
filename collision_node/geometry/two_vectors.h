/// Two vectors side by side, one of each body of a pair: what is done to both is done once. Every lane rounds
/// as the same expression of doubles would; no product is fused with a sum.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

#include "collision_node/geometry/types.h"

#if defined(__x86_64__)
#include <emmintrin.h>
#endif

namespace collision_node::geometry {

/// [0] is A's, [1] is B's.
using Two = double __attribute__((vector_size(2 * sizeof(double))));
using TwoBits = std::int64_t __attribute__((vector_size(2 * sizeof(std::int64_t))));

inline Two twice(double x) { return Two{x, x}; }
inline Two magnitude(Two x) { return (Two)((TwoBits)x & std::numeric_limits<std::int64_t>::max()); }
/// |x| with the sign of `of`.
inline Two withSignOf(Two x, Two of) {
  constexpr std::int64_t kSign = std::numeric_limits<std::int64_t>::min();
  return (Two)(((TwoBits)x & ~kSign) | ((TwoBits)of & kSign));
}
inline Two squareRoot(Two x) {
#if defined(__x86_64__)
  return (Two)_mm_sqrt_pd((__m128d)x);
#else
  return Two{std::sqrt(x[0]), std::sqrt(x[1])};
#endif
}

struct TwoVec3 {
  Two x, y, z;

  TwoVec3() = default;
  TwoVec3(Two x_both, Two y_both, Two z_both) : x(x_both), y(y_both), z(z_both) {}
  TwoVec3(const Vec3& a, const Vec3& b) : x{a.x(), b.x()}, y{a.y(), b.y()}, z{a.z(), b.z()} {}
  explicit TwoVec3(const Vec3& both) : x(twice(both.x())), y(twice(both.y())), z(twice(both.z())) {}

  Vec3 a() const { return {x[0], y[0], z[0]}; }
  Vec3 b() const { return {x[1], y[1], z[1]}; }
};

inline TwoVec3 operator+(const TwoVec3& p, const TwoVec3& q) { return {p.x + q.x, p.y + q.y, p.z + q.z}; }
inline TwoVec3 operator-(const TwoVec3& p, const TwoVec3& q) { return {p.x - q.x, p.y - q.y, p.z - q.z}; }
inline TwoVec3 operator*(Two s, const TwoVec3& p) { return {s * p.x, s * p.y, s * p.z}; }
inline TwoVec3 operator*(double s, const TwoVec3& p) { return twice(s) * p; }

inline Two dot(const TwoVec3& p, const TwoVec3& q) { return p.x * q.x + (p.y * q.y + p.z * q.z); }
inline Two norm(const TwoVec3& p) { return squareRoot(dot(p, p)); }
inline TwoVec3 cross(const TwoVec3& p, const TwoVec3& q) {
  return {p.y * q.z - p.z * q.y, p.z * q.x - p.x * q.z, p.x * q.y - p.y * q.x};
}

/// Two matrices, by columns.
struct TwoMat3 {
  TwoVec3 column[3];

  TwoMat3() = default;
  TwoMat3(const Mat3& a, const Mat3& b) {
    for (int j = 0; j < 3; ++j)
      column[j] = {Two{a(0, j), b(0, j)}, Two{a(1, j), b(1, j)}, Two{a(2, j), b(2, j)}};
  }
  void split(Mat3& a, Mat3& b) const {
    for (int j = 0; j < 3; ++j) {
      a.col(j) = column[j].a();
      b.col(j) = column[j].b();
    }
  }
  /// Its transpose times p.
  TwoVec3 backwards(const TwoVec3& p) const {
    return {dot(column[0], p), dot(column[1], p), dot(column[2], p)};
  }
};

}  // namespace collision_node::geometry

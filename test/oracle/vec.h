/// Vectors and rotations in 80 bit arithmetic, for the oracle only.
#pragma once

#include <algorithm>
#include <cmath>

namespace oracle {

using Real = long double;
static_assert(sizeof(long double) > sizeof(double), "the oracle needs an extended long double");

struct V3 {
  Real x = 0, y = 0, z = 0;
};

inline V3 operator+(const V3& a, const V3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline V3 operator-(const V3& a, const V3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline V3 operator-(const V3& a) { return {-a.x, -a.y, -a.z}; }
inline V3 operator*(Real s, const V3& a) { return {s * a.x, s * a.y, s * a.z}; }
inline Real dot(const V3& a, const V3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline V3 cross(const V3& a, const V3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline Real norm(const V3& a) { return std::sqrt(dot(a, a)); }
inline Real clamp01(Real u) { return std::min<Real>(1, std::max<Real>(0, u)); }
inline Real clampTo1(Real u) { return std::min<Real>(1, std::max<Real>(-1, u)); }

/// Any Eigen 3-vector of doubles, taken exactly.
template <class EigenVector>
V3 exact(const EigenVector& v) {
  return {static_cast<Real>(v[0]), static_cast<Real>(v[1]), static_cast<Real>(v[2])};
}

struct M3 {
  V3 column[3];
};

inline V3 operator*(const M3& m, const V3& v) {
  return v.x * m.column[0] + v.y * m.column[1] + v.z * m.column[2];
}
inline M3 operator*(const M3& a, const M3& b) {
  return {{a * b.column[0], a * b.column[1], a * b.column[2]}};
}

/// Rotation of a quaternion that need not be unit: it is normalised here.
template <class EigenQuaternion>
M3 rotationOf(const EigenQuaternion& q) {
  Real w = q.w(), x = q.x(), y = q.y(), z = q.z();
  const Real length = std::sqrt(w * w + x * x + y * y + z * z);
  w /= length, x /= length, y /= length, z /= length;
  return {{{1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)},
           {2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)},
           {2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)}}};
}

/// exp of the rotation vector (axis times angle), by Rodrigues' formula.
inline M3 rotationBy(const V3& rotation_vector) {
  const Real angle = norm(rotation_vector);
  if (!(angle > 0)) return {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  const V3 k = (1 / angle) * rotation_vector;
  const Real s = std::sin(angle), half = std::sin(angle / 2), v = 2 * half * half;  // v = 1 - cos(angle)
  const auto turned = [&](const V3& e) {
    const V3 ke = cross(k, e);
    return e + s * ke + v * cross(k, ke);
  };
  return {{turned({1, 0, 0}), turned({0, 1, 0}), turned({0, 0, 1})}};
}

}  // namespace oracle

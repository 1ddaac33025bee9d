/// What a Bvh is built from: boxes of floats, each with its element.
#pragma once

#include <cstdint>
#include <cstring>
#include <limits>

#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

namespace collision_node::geometry {

typedef float FourFloats __attribute__((vector_size(16)));

inline FourFloats smaller(const FourFloats& x, const FourFloats& y) { return x < y ? x : y; }
inline FourFloats larger(const FourFloats& x, const FourFloats& y) { return x > y ? x : y; }
inline FourFloats magnitude(const FourFloats& x) { return larger(x, -x); }
inline FourFloats loadFour(const float* from) {
  FourFloats x;
  std::memcpy(&x, from, sizeof x);
  return x;
}
inline void storeFour(float* to, const FourFloats& x) { std::memcpy(to, &x, sizeof x); }

/// Rows become columns.
inline void transpose(FourFloats row[4]) {
#if defined(__SSE2__)
  _MM_TRANSPOSE4_PS(row[0], row[1], row[2], row[3]);
#else
  for (int i = 0; i < 4; ++i) {
    for (int k = 0; k < i; ++k) {
      const float x = row[i][k];
      row[i][k] = row[k][i];
      row[k][i] = x;
    }
  }
#endif
}

/// A box of floats, one register a side; the last lanes are not looked at.
struct RegisterBox {
  static constexpr float kFar = std::numeric_limits<float>::infinity();
  FourFloats lower, upper;

  /// Holds nothing.
  static RegisterBox none() {
    return {FourFloats{kFar, kFar, kFar, kFar}, FourFloats{-kFar, -kFar, -kFar, -kFar}};
  }

  void add(const RegisterBox& o) {
    lower = smaller(o.lower, lower);
    upper = larger(o.upper, upper);
  }
  float halfArea() const {
    const float x = upper[0] - lower[0], y = upper[1] - lower[1], z = upper[2] - lower[2];
    return x * y + y * z + z * x;
  }
  float twiceCentre(int axis) const { return lower[axis] + upper[axis]; }
  int longestAxis() const {
    int axis = 0;
    for (int k = 1; k < 3; ++k) {
      if (upper[k] - lower[k] > upper[axis] - lower[axis]) axis = k;
    }
    return axis;
  }
};

/// An element's box, with its number in a lane that nobody looks at: two to a line of the cache.
struct alignas(32) Entry {
  RegisterBox box;

  void set(const RegisterBox& of, std::size_t element) {
    box = of;
    const auto number = static_cast<std::int32_t>(element);
    std::memcpy(reinterpret_cast<char*>(&box.upper) + 12, &number, sizeof number);
  }
  std::int32_t element() const {
    std::int32_t number;
    std::memcpy(&number, reinterpret_cast<const char*>(&box.upper) + 12, sizeof number);
    return number;
  }
};

}  // namespace collision_node::geometry

/// Eight floats side by side, as four_doubles.h has doubles: the same bits in registers of any width.
#pragma once

#include "collision_node/impact/four_doubles.h"

namespace collision_node::impact {

constexpr int kEight = 8;
using Eight = float __attribute__((vector_size(kEight * sizeof(float))));
using EightBits = std::int32_t __attribute__((vector_size(kEight * sizeof(std::int32_t))));

COLLISION_NODE_INLINE Eight allEight(float x) { return Eight{x, x, x, x, x, x, x, x}; }
COLLISION_NODE_INLINE EightBits allEight(std::int32_t x) { return EightBits{x, x, x, x, x, x, x, x}; }
COLLISION_NODE_INLINE Eight loadEight(const float* from) {
  Eight x;
  std::memcpy(&x, from, sizeof x);
  return x;
}

COLLISION_NODE_INLINE Eight larger(const Eight& x, const Eight& y) { return x > y ? x : y; }
COLLISION_NODE_INLINE Eight smaller(const Eight& x, const Eight& y) { return x < y ? x : y; }
COLLISION_NODE_INLINE EightBits smaller(const EightBits& x, const EightBits& y) { return x < y ? x : y; }

COLLISION_NODE_INLINE std::int32_t leastOf(EightBits x) {
  x = smaller(x, __builtin_shuffle(x, EightBits{4, 5, 6, 7, 0, 1, 2, 3}));
  x = smaller(x, __builtin_shuffle(x, EightBits{2, 3, 0, 1, 6, 7, 4, 5}));
  x = smaller(x, __builtin_shuffle(x, EightBits{1, 0, 3, 2, 5, 4, 7, 6}));
  return x[0];
}

/// One bit for each lane that is all ones.
COLLISION_NODE_INLINE unsigned lanesOf(const EightBits& mask) {
#if defined(__x86_64__)
  __m128 half[2];
  std::memcpy(half, &mask, sizeof half);
  return static_cast<unsigned>(_mm_movemask_ps(half[0]) | _mm_movemask_ps(half[1]) << 4);
#else
  unsigned all = 0;
  for (int i = 0; i < kEight; ++i) all |= static_cast<unsigned>(mask[i] & 1) << i;
  return all;
#endif
}

}  // namespace collision_node::impact

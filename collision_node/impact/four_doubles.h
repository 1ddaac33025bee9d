/// Four doubles side by side, for expressions that the compiler writes once for any 64-bit machine and once
/// for wide registers; the loader picks. No product is ever fused with a sum, so both give the same bits.
///
/// Files that include this are compiled without the warning about how wide vectors cross calls: they cross
/// none.
#pragma once

#include <cstdint>
#include <cstring>
#include <limits>

#include "collision_node/geometry/any_width.h"

#if defined(__x86_64__)
#include <emmintrin.h>
#endif

/// Of what a function of any width calls.
#define COLLISION_NODE_INLINE inline __attribute__((always_inline))

namespace collision_node::impact {

constexpr int kFour = 4;
using Four = double __attribute__((vector_size(kFour * sizeof(double))));
using FourBits = std::int64_t __attribute__((vector_size(kFour * sizeof(std::int64_t))));

constexpr std::int64_t kSignBit = std::numeric_limits<std::int64_t>::min();

COLLISION_NODE_INLINE Four loadFour(const double from[kFour]) {
  Four x;
  std::memcpy(&x, from, sizeof x);
  return x;
}

COLLISION_NODE_INLINE Four larger(const Four& x, const Four& y) { return x > y ? x : y; }
COLLISION_NODE_INLINE Four smaller(const Four& x, const Four& y) { return x < y ? x : y; }
COLLISION_NODE_INLINE Four magnitude(const Four& x) { return (Four)((FourBits)x & ~kSignBit); }
/// x where `of` is positive, -x where it is negative.
COLLISION_NODE_INLINE Four withSign(const Four& x, const Four& of) {
  return (Four)((FourBits)x ^ ((FourBits)of & kSignBit));
}

/// One bit for each lane that is all ones.
COLLISION_NODE_INLINE unsigned lanesOf(const FourBits& mask) {
#if defined(__x86_64__)
  __m128d half[2];
  std::memcpy(half, &mask, sizeof half);
  return static_cast<unsigned>(_mm_movemask_pd(half[0]) | _mm_movemask_pd(half[1]) << 2);
#else
  unsigned all = 0;
  for (int i = 0; i < kFour; ++i) all |= static_cast<unsigned>(mask[i] & 1) << i;
  return all;
#endif
}

/// One bit for each lane where x <= y.
COLLISION_NODE_INLINE unsigned whereOrdered(const Four& x, const Four& y) {
  const FourBits ordered = x <= y;
  return lanesOf(ordered);
}

/// x . y, of numbers or of fours.
template <typename X, typename Y>
COLLISION_NODE_INLINE auto dotOf(const X& x, const Y& y) {
  return (x[0] * y[0] + x[1] * y[1]) + x[2] * y[2];
}

}  // namespace collision_node::impact

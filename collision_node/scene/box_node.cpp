#include "collision_node/scene/box_node.h"

#include <algorithm>

#if defined(__x86_64__)
#include <emmintrin.h>
#endif

namespace collision_node::scene {

namespace {

constexpr int kWidth = BoxNode::kWidth;

// Wider than the baseline's registers: the compiler splits them there, or makes a second version, and the
// loader picks. Both give the same bits.
typedef float Floats __attribute__((vector_size(32), may_alias));
using Mask = decltype(Floats{} < Floats{});
constexpr int kLanes = 8, kHalves = kWidth / kLanes;

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define COLLISION_NODE_ANY_WIDTH __attribute__((target_clones("avx2", "default")))
#else
#define COLLISION_NODE_ANY_WIDTH
#endif
#define COLLISION_NODE_INLINE inline __attribute__((always_inline))

COLLISION_NODE_INLINE unsigned bits(const Mask& mask) {
#if defined(__x86_64__)
  __m128 half[2];
  __builtin_memcpy(half, &mask, sizeof mask);
  return static_cast<unsigned>(_mm_movemask_ps(half[0]) | _mm_movemask_ps(half[1]) << 4);
#else
  unsigned all = 0;
  for (int i = 0; i < kLanes; ++i) all |= (mask[i] & 1U) << i;
  return all;
#endif
}

// NaN, of an infinity less itself, changes nothing.
COLLISION_NODE_INLINE void larger(Floats& a, const Floats& b) { a = b > a ? b : a; }
COLLISION_NODE_INLINE void smaller(Floats& a, const Floats& b) { a = b < a ? b : a; }

COLLISION_NODE_INLINE const Floats& lanes(const BoxNode& node, int plane, int half) {
  return *reinterpret_cast<const Floats*>(node.plane[plane] + kLanes * half);
}

/// By bit.
COLLISION_NODE_INLINE unsigned lanesThatMeet(const BoxNode& node, const FloatBox& box) {
  unsigned all = 0;
  for (int half = 0; half < kHalves; ++half) {
    Mask meet = lanes(node, 0, half) <= box.plane[3];
    for (int k = 1; k < 3; ++k) meet &= lanes(node, k, half) <= box.plane[3 + k];
    for (int k = 0; k < 3; ++k) meet &= lanes(node, 3 + k, half) >= box.plane[k];
    all |= bits(meet) << (kLanes * half);
  }
  return all & ((1U << node.count) - 1U);
}

COLLISION_NODE_INLINE unsigned lanesThatMeet(const BoxNode& node, const FloatLine& line) {
  unsigned all = lanesThatMeet(node, line.box);
  for (int half = 0; half < kHalves; ++half) {
    Floats enter = {}, leave = enter + 1.0F;
    for (int k = 0; k < 3; ++k) {
      larger(enter, (lanes(node, line.near[k], half) - line.enter_at[k]) * line.inverse[k]);
      smaller(leave, (lanes(node, line.far[k], half) - line.leave_at[k]) * line.inverse[k]);
    }
    const Mask apart = enter > leave * (1.0F + FloatLine::kWider) + FloatLine::kLater;
    all &= ~(bits(apart) << (kLanes * half));
  }
  return all;
}

/// Level by level. Branches that nobody can foresee are what a walk costs: so the first few children that
/// meet are written whether there are so many or not.
template <typename Question>
COLLISION_NODE_INLINE void findAll(const BoxNode* nodes, std::int32_t root, const Question& question,
                                   BoxWalk& walk) {
  constexpr int kFew = 3;
  if (walk.room.empty()) walk.room.resize(64);
  std::size_t begin = 0, end = 1;
  walk.room[0] = root;
  for (std::int32_t level = nodes[root].level; level >= 0; --level) {
    const std::size_t last = end;
    for (; begin < last; ++begin) {
      if (end + kWidth > walk.room.size()) walk.room.resize(2 * walk.room.size());
      std::int32_t* out = walk.room.data() + end;
      const BoxNode& node = nodes[walk.room[begin]];
      unsigned meet = lanesThatMeet(node, question);
      end += static_cast<std::size_t>(__builtin_popcount(meet));
      for (int i = 0; i < kFew; ++i, meet &= meet - 1)
        out[i] = node.child[__builtin_ctz(meet | 1U << (kWidth - 1))];
      for (out += kFew; __builtin_expect(meet != 0, 0); meet &= meet - 1)
        *out++ = node.child[__builtin_ctz(meet)];
    }
  }
  walk.begin = begin;
  walk.end = end;
}

// The compiler wants the versions outside of any class and overload.
COLLISION_NODE_ANY_WIDTH void findByBox(const BoxNode* nodes, std::int32_t root, const FloatBox& box,
                                        BoxWalk& walk) {
  findAll(nodes, root, box, walk);
}

COLLISION_NODE_ANY_WIDTH void findByLine(const BoxNode* nodes, std::int32_t root, const FloatLine& line,
                                         BoxWalk& walk) {
  findAll(nodes, root, line, walk);
}

COLLISION_NODE_INLINE void areas(const Floats (&side)[3], Floats& half) {
  half = side[0] * side[1] + side[1] * side[2] + side[2] * side[0];
}

COLLISION_NODE_ANY_WIDTH int bestLane(const BoxNode& node, const FloatBox& box) {
  /// Among lanes that grow about alike, the smallest.
  constexpr float kShareOfArea = 0x1p-10F;
  alignas(32) float cost[kWidth];
  for (int half = 0; half < kHalves; ++half) {
    Floats own[3], joint[3];
    for (int k = 0; k < 3; ++k) {
      Floats low = lanes(node, k, half), high = lanes(node, 3 + k, half);
      own[k] = high - low;
      smaller(low, Floats{} + box.plane[k]);
      larger(high, Floats{} + box.plane[3 + k]);
      joint[k] = high - low;
    }
    Floats before, after;
    areas(own, before);
    areas(joint, after);
    const Floats all = (after - before) + kShareOfArea * after;
    __builtin_memcpy(cost + kLanes * half, &all, sizeof all);
  }
  std::int32_t best = 0x7fffffff;
  for (int lane = 0; lane < kWidth; ++lane) {
    std::int32_t key;
    __builtin_memcpy(&key, cost + lane, sizeof key);
    key = (key & ~(kWidth - 1)) | lane;
    key = lane < node.count ? key : 0x7fffffff;
    best = key < best ? key : best;
  }
  return best & (kWidth - 1);
}

COLLISION_NODE_INLINE float largest(const Floats& of) {
  const float a = std::max(of[0], of[4]), b = std::max(of[1], of[5]);
  const float c = std::max(of[2], of[6]), d = std::max(of[3], of[7]);
  return std::max(std::max(a, b), std::max(c, d));
}

COLLISION_NODE_ANY_WIDTH FloatBox boundsOfAll(const BoxNode& node) {
  FloatBox box;
  for (int k = 0; k < 3; ++k) {
    Floats low = lanes(node, k, 0), high = lanes(node, 3 + k, 0);
    for (int half = 1; half < kHalves; ++half) {
      smaller(low, lanes(node, k, half));
      larger(high, lanes(node, 3 + k, half));
    }
    box.plane[k] = -largest(-low);
    box.plane[3 + k] = largest(high);
  }
  return box;
}

}  // namespace

FloatBox BoxNode::bounds() const { return boundsOfAll(*this); }

int BoxNode::bestLaneFor(const FloatBox& box) const { return bestLane(*this, box); }

void findItems(const BoxNode* nodes, std::int32_t root, const FloatBox& box, BoxWalk& walk) {
  findByBox(nodes, root, box, walk);
}

void findItems(const BoxNode* nodes, std::int32_t root, const FloatLine& line, BoxWalk& walk) {
  findByLine(nodes, root, line, walk);
}

}  // namespace collision_node::scene

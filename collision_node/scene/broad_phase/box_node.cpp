#include "collision_node/scene/broad_phase/box_node.h"

#include <algorithm>
#include <limits>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace collision_node::scene {

namespace {

constexpr int kWidth = BoxNode::kWidth;

#define COLLISION_NODE_INLINE inline __attribute__((always_inline))

template <int kLanes>
struct Registers {
  typedef float Floats __attribute__((vector_size(kLanes * sizeof(float)), may_alias));
  typedef std::int32_t Mask __attribute__((vector_size(kLanes * sizeof(float))));

  static COLLISION_NODE_INLINE const Floats& lanes(const BoxNode& node, int plane, int first) {
    return *reinterpret_cast<const Floats*>(node.plane[plane] + first);
  }

  static COLLISION_NODE_INLINE unsigned bits(const Mask& mask) {
    unsigned all = 0;
#if defined(__SSE2__)
    __m128 quarter[kLanes / 4];
    __builtin_memcpy(quarter, &mask, sizeof mask);
    for (int i = 0; i < kLanes / 4; ++i) all |= static_cast<unsigned>(_mm_movemask_ps(quarter[i])) << (4 * i);
#else
    for (int i = 0; i < kLanes; ++i) all |= (mask[i] & 1U) << i;
#endif
    return all;
  }
};

// NaN, of an infinity less itself, changes nothing.
template <typename Floats>
COLLISION_NODE_INLINE void larger(Floats& a, const Floats& b) {
  a = b > a ? b : a;
}
template <typename Floats>
COLLISION_NODE_INLINE void smaller(Floats& a, const Floats& b) {
  a = b < a ? b : a;
}

/// By bit. A lane that is not in use meets nothing: it is inside out.
template <int kLanes>
COLLISION_NODE_INLINE unsigned lanesThatMeet(const BoxNode& node, const FloatBox& box) {
  using R = Registers<kLanes>;
  unsigned all = 0;
  for (int first = 0; first < kWidth; first += kLanes) {
    typename R::Mask meet = R::lanes(node, 0, first) <= box.plane[3];
    for (int k = 1; k < 3; ++k) meet &= R::lanes(node, k, first) <= box.plane[3 + k];
    for (int k = 0; k < 3; ++k) meet &= R::lanes(node, 3 + k, first) >= box.plane[k];
    all |= R::bits(meet) << first;
  }
  return all;
}

template <int kLanes>
COLLISION_NODE_INLINE unsigned lanesThatMeet(const BoxNode& node, const FloatLine& line) {
  using R = Registers<kLanes>;
  unsigned all = 0;
  for (int first = 0; first < kWidth; first += kLanes) {
    typename R::Floats enter = {}, leave = enter + 1.0F;
    for (int k = 0; k < 3; ++k) {
      larger(enter, (R::lanes(node, line.near[k], first) - line.enter_at[k]) * line.inverse[k]);
      smaller(leave, (R::lanes(node, line.far[k], first) - line.leave_at[k]) * line.inverse[k]);
    }
    const typename R::Mask apart = enter > leave * (1.0F + FloatLine::kWider) + FloatLine::kLater;
    all |= R::bits(~apart) << first;
  }
  return all;
}

/// Level by level. Branches that nobody can foresee are what a walk costs: so the first few children are
/// written whether so many meet or not.
template <int kLanes, typename Question>
COLLISION_NODE_INLINE void findAll(const BoxNode* nodes, std::int32_t root, const Question& question,
                                   BoxWalk& walk) {
  constexpr int kFew = 3;
  constexpr unsigned kAny = 1U << (kWidth - 1);  // keeps the search for a bit from having none
  if (walk.room.empty()) walk.room.resize(64);
  std::size_t begin = 0, end = 1;
  walk.room[0] = root;
  for (std::int32_t level = nodes[root].level; level >= 0; --level) {
    const std::size_t last = end;
    walk.leaves = begin;
    for (; begin < last; ++begin) {
      if (end + kWidth > walk.room.size()) walk.room.resize(2 * walk.room.size());
      std::int32_t* const out = walk.room.data();
      const BoxNode& node = nodes[out[begin]];
      unsigned meet = lanesThatMeet<kLanes>(node, question);
      for (int i = 0; i < kFew; ++i, meet &= meet - 1U) {
        out[end] = node.child[__builtin_ctz(meet | kAny)];
        end += meet != 0 ? 1 : 0;
      }
      for (; __builtin_expect(meet != 0, 0); meet &= meet - 1U) out[end++] = node.child[__builtin_ctz(meet)];
    }
  }
  walk.begin = begin;
  walk.end = end;
}

#if defined(__x86_64__)
template <typename Question>
__attribute__((target("avx2"))) void findAvx2(const BoxNode* nodes, std::int32_t root,
                                              const Question& question, BoxWalk& walk) {
  findAll<8>(nodes, root, question, walk);
}
#endif

template <typename Question>
void findOn(impact::Lanes lanes, const BoxNode* nodes, std::int32_t root, const Question& question,
            BoxWalk& walk) {
#if defined(__x86_64__)
  if (lanes == impact::Lanes::kAvx2) return findAvx2(nodes, root, question, walk);
#endif
  findAll<4>(nodes, root, question, walk);
}

using Four = Registers<4>;
constexpr int kLanes = 4;

/// Half the surface.
Four::Floats areaOf(const Four::Floats (&side)[3]) {
  return side[0] * side[1] + side[1] * side[2] + side[2] * side[0];
}

float largest(const Four::Floats& of) { return std::max(std::max(of[0], of[1]), std::max(of[2], of[3])); }

}  // namespace

FloatBox BoxNode::bounds() const {
  FloatBox box;
  for (int k = 0; k < 3; ++k) {
    Four::Floats low = Four::lanes(*this, k, 0), high = Four::lanes(*this, 3 + k, 0);
    for (int first = kLanes; first < kWidth; first += kLanes) {
      smaller(low, Four::lanes(*this, k, first));
      larger(high, Four::lanes(*this, 3 + k, first));
    }
    box.plane[k] = -largest(-low);
    box.plane[3 + k] = largest(high);
  }
  return box;
}

int BoxNode::bestLaneFor(const FloatBox& box) const {
  std::int32_t cost[kWidth];
  for (int first = 0; first < kWidth; first += kLanes) {
    Four::Floats own[3], joint[3];
    for (int k = 0; k < 3; ++k) {
      Four::Floats low = Four::lanes(*this, k, first), high = Four::lanes(*this, 3 + k, first);
      own[k] = high - low;
      smaller(low, Four::Floats{} + box.plane[k]);
      larger(high, Four::Floats{} + box.plane[3 + k]);
      joint[k] = high - low;
    }
    const Four::Floats after = areaOf(joint), all = (after - areaOf(own)) + kShareOfArea * after;
    __builtin_memcpy(cost + first, &all, sizeof all);
  }
  // None is below zero, so their bits have their order; the last ones give way to the lane's number.
  std::int32_t best = std::numeric_limits<std::int32_t>::max();
  for (int lane = 0; lane < kWidth; ++lane) {
    const std::int32_t key = (cost[lane] & ~(kWidth - 1)) | lane;
    best = lane < count && key < best ? key : best;
  }
  return best & (kWidth - 1);
}

void findItems(const BoxNode* nodes, std::int32_t root, const FloatBox& box, BoxWalk& walk,
               impact::Lanes lanes) {
  findOn(lanes, nodes, root, box, walk);
}

void findItems(const BoxNode* nodes, std::int32_t root, const FloatLine& line, BoxWalk& walk,
               impact::Lanes lanes) {
  findOn(lanes, nodes, root, line, walk);
}

}  // namespace collision_node::scene

#include "collision_node/scene/box_node.h"

#include <algorithm>
#include <limits>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace collision_node::scene {

namespace {

constexpr int kWidth = BoxNode::kWidth;

/// As wide as any 64-bit PC's registers. Registers of eight were a tenth faster, and would be a second
/// version of all this.
typedef float Floats __attribute__((vector_size(16), may_alias));
using Mask = decltype(Floats{} < Floats{});
constexpr int kLanes = 4;

unsigned bits(const Mask& mask) {
#if defined(__SSE2__)
  return static_cast<unsigned>(_mm_movemask_ps(reinterpret_cast<__m128>(mask)));
#else
  unsigned all = 0;
  for (int i = 0; i < kLanes; ++i) all |= (mask[i] & 1U) << i;
  return all;
#endif
}

// NaN, of an infinity less itself, changes nothing.
void larger(Floats& a, const Floats& b) { a = b > a ? b : a; }
void smaller(Floats& a, const Floats& b) { a = b < a ? b : a; }

const Floats& lanes(const BoxNode& node, int plane, int first) {
  return *reinterpret_cast<const Floats*>(node.plane[plane] + first);
}

/// By bit.
unsigned lanesThatMeet(const BoxNode& node, const FloatBox& box) {
  unsigned all = 0;
  for (int first = 0; first < kWidth; first += kLanes) {
    Mask meet = lanes(node, 0, first) <= box.plane[3];
    for (int k = 1; k < 3; ++k) meet &= lanes(node, k, first) <= box.plane[3 + k];
    for (int k = 0; k < 3; ++k) meet &= lanes(node, 3 + k, first) >= box.plane[k];
    all |= bits(meet) << first;
  }
  return all & ((1U << node.count) - 1U);
}

unsigned lanesThatMeet(const BoxNode& node, const FloatLine& line) {
  unsigned all = lanesThatMeet(node, line.box);
  for (int first = 0; first < kWidth; first += kLanes) {
    Floats enter = {}, leave = enter + 1.0F;
    for (int k = 0; k < 3; ++k) {
      larger(enter, (lanes(node, line.near[k], first) - line.enter_at[k]) * line.inverse[k]);
      smaller(leave, (lanes(node, line.far[k], first) - line.leave_at[k]) * line.inverse[k]);
    }
    const Mask apart = enter > leave * (1.0F + FloatLine::kWider) + FloatLine::kLater;
    all &= ~(bits(apart) << first);
  }
  return all;
}

/// Level by level. Branches that nobody can foresee are what a walk costs: so the first few children are
/// written whether so many meet or not.
template <typename Question>
void findAll(const BoxNode* nodes, std::int32_t root, const Question& question, BoxWalk& walk) {
  constexpr int kFew = 3;
  constexpr unsigned kAny = 1U << (kWidth - 1);  // keeps the search for a bit from having none
  if (walk.room.empty()) walk.room.resize(64);
  std::size_t begin = 0, end = 1;
  walk.room[0] = root;
  for (std::int32_t level = nodes[root].level; level >= 0; --level) {
    const std::size_t last = end;
    for (; begin < last; ++begin) {
      if (end + kWidth > walk.room.size()) walk.room.resize(2 * walk.room.size());
      std::int32_t* const out = walk.room.data();
      const BoxNode& node = nodes[out[begin]];
      unsigned meet = lanesThatMeet(node, question);
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

/// Half the surface.
Floats areaOf(const Floats (&side)[3]) { return side[0] * side[1] + side[1] * side[2] + side[2] * side[0]; }

float largest(const Floats& of) { return std::max(std::max(of[0], of[1]), std::max(of[2], of[3])); }

}  // namespace

FloatBox BoxNode::bounds() const {
  FloatBox box;
  for (int k = 0; k < 3; ++k) {
    Floats low = lanes(*this, k, 0), high = lanes(*this, 3 + k, 0);
    for (int first = kLanes; first < kWidth; first += kLanes) {
      smaller(low, lanes(*this, k, first));
      larger(high, lanes(*this, 3 + k, first));
    }
    box.plane[k] = -largest(-low);
    box.plane[3 + k] = largest(high);
  }
  return box;
}

int BoxNode::bestLaneFor(const FloatBox& box) const {
  constexpr float kShareOfArea = 0x1p-10F;  // among lanes that grow about alike, the smallest
  std::int32_t cost[kWidth];
  for (int first = 0; first < kWidth; first += kLanes) {
    Floats own[3], joint[3];
    for (int k = 0; k < 3; ++k) {
      Floats low = lanes(*this, k, first), high = lanes(*this, 3 + k, first);
      own[k] = high - low;
      smaller(low, Floats{} + box.plane[k]);
      larger(high, Floats{} + box.plane[3 + k]);
      joint[k] = high - low;
    }
    const Floats after = areaOf(joint), all = (after - areaOf(own)) + kShareOfArea * after;
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

void findItems(const BoxNode* nodes, std::int32_t root, const FloatBox& box, BoxWalk& walk) {
  findAll(nodes, root, box, walk);
}

void findItems(const BoxNode* nodes, std::int32_t root, const FloatLine& line, BoxWalk& walk) {
  findAll(nodes, root, line, walk);
}

}  // namespace collision_node::scene

#include "collision_node/scene/box_tree.h"

#include <algorithm>
#include <limits>
#include <numeric>

#if defined(__x86_64__)
#include <emmintrin.h>
#endif

namespace collision_node::scene {

namespace {

constexpr int kWidth = BoxTree::kWidth;
constexpr float kFar = std::numeric_limits<float>::infinity();
/// A node with fewer gives them to others. All but the root have so many, so there are less than 14 levels.
constexpr int kFewest = 5;
constexpr int kStack = 14 * kWidth;

// Wider than the baseline's registers: the compiler splits them there.
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

COLLISION_NODE_INLINE const Floats& lanes(const BoxTree::Node& node, int plane, int half) {
  return *reinterpret_cast<const Floats*>(node.plane[plane] + kLanes * half);
}

/// Lanes that meet, by bit.
COLLISION_NODE_INLINE unsigned meeting(const BoxTree::Node& node, const FloatBox& box) {
  unsigned all = 0;
  for (int half = 0; half < kHalves; ++half) {
    Mask meet = lanes(node, 0, half) <= box.plane[3];
    for (int k = 1; k < 3; ++k) meet &= lanes(node, k, half) <= box.plane[3 + k];
    for (int k = 0; k < 3; ++k) meet &= lanes(node, 3 + k, half) >= box.plane[k];
    all |= bits(meet) << (kLanes * half);
  }
  return all;
}

COLLISION_NODE_INLINE unsigned meeting(const BoxTree::Node& node, const FloatLine& line) {
  unsigned all = 0;
  for (int half = 0; half < kHalves; ++half) {
    Mask meet = lanes(node, 0, half) <= line.box.plane[3];
    for (int k = 1; k < 3; ++k) meet &= lanes(node, k, half) <= line.box.plane[3 + k];
    for (int k = 0; k < 3; ++k) meet &= lanes(node, 3 + k, half) >= line.box.plane[k];
    Floats enter = {}, leave = enter + 1.0F;
    for (int k = 0; k < 3; ++k) {
      larger(enter, (lanes(node, line.near[k], half) - line.enter_at[k]) * line.inverse[k]);
      smaller(leave, (lanes(node, line.far[k], half) - line.leave_at[k]) * line.inverse[k]);
    }
    meet &= enter <= leave * (1.0F + FloatLine::kWider) + FloatLine::kLater;
    all |= bits(meet) << (kLanes * half);
  }
  return all;
}

template <typename Question>
COLLISION_NODE_INLINE void findAll(const BoxTree::Node* nodes, std::int32_t root, const Question& question,
                                   std::vector<std::int32_t>& items) {
  std::int32_t stack[kStack];
  int waiting = 0;
  stack[waiting++] = root;
  do {
    const BoxTree::Node& node = nodes[stack[--waiting]];
    unsigned meet = meeting(node, question) & ((1U << node.count) - 1);
    if (node.level == 0) {
      for (; meet != 0; meet &= meet - 1) items.push_back(node.child[__builtin_ctz(meet)]);
    } else {
      for (; meet != 0; meet &= meet - 1) stack[waiting++] = node.child[__builtin_ctz(meet)];
    }
  } while (waiting > 0);
}

COLLISION_NODE_ANY_WIDTH void findBox(const BoxTree::Node* nodes, std::int32_t root, const FloatBox& box,
                                      std::vector<std::int32_t>& items) {
  findAll(nodes, root, box, items);
}

COLLISION_NODE_ANY_WIDTH void findLine(const BoxTree::Node* nodes, std::int32_t root, const FloatLine& line,
                                       std::vector<std::int32_t>& items) {
  findAll(nodes, root, line, items);
}

/// The lane whose surface grows least; where none grows, the smallest.
COLLISION_NODE_ANY_WIDTH int bestLane(const BoxTree::Node& node, const FloatBox& box) {
  alignas(32) float cost[kWidth];
  for (int half = 0; half < kHalves; ++half) {
    Floats own[3], joint[3];
    for (int k = 0; k < 3; ++k) {
      Floats low = lanes(node, k, half), high = lanes(node, 3 + k, half);
      own[k] = high - low;
      const Floats zero = {};
      smaller(low, zero + box.plane[k]);
      larger(high, zero + box.plane[3 + k]);
      joint[k] = high - low;
    }
    const Floats after = joint[0] * joint[1] + joint[1] * joint[2] + joint[2] * joint[0];
    const Floats before = own[0] * own[1] + own[1] * own[2] + own[2] * own[0];
    const Floats all = (after - before) + 0x1p-6F * after;
    __builtin_memcpy(cost + kLanes * half, &all, sizeof all);
  }
  int best = 0;
  for (int i = 1; i < node.count; ++i)
    if (cost[i] < cost[best]) best = i;
  return best;
}

COLLISION_NODE_ANY_WIDTH FloatBox boundsOf(const BoxTree::Node& node) {
  FloatBox box;
  for (int plane = 0; plane < 6; ++plane) {
    Floats most = lanes(node, plane, 0);
    if (plane < 3) {
      smaller(most, lanes(node, plane, 1));
      float a = std::min(most[0], most[4]), b = std::min(most[1], most[5]);
      float c = std::min(most[2], most[6]), d = std::min(most[3], most[7]);
      box.plane[plane] = std::min(std::min(a, b), std::min(c, d));
    } else {
      larger(most, lanes(node, plane, 1));
      float a = std::max(most[0], most[4]), b = std::max(most[1], most[5]);
      float c = std::max(most[2], most[6]), d = std::max(most[3], most[7]);
      box.plane[plane] = std::max(std::max(a, b), std::max(c, d));
    }
  }
  return box;
}

FloatBox boxAt(const BoxTree::Node& node, int lane) {
  FloatBox box;
  for (int plane = 0; plane < 6; ++plane) box.plane[plane] = node.plane[plane][lane];
  return box;
}

void setBox(BoxTree::Node& node, int lane, const FloatBox& box) {
  for (int plane = 0; plane < 6; ++plane) node.plane[plane][lane] = box.plane[plane];
}

void empty(BoxTree::Node& node, int lane) {
  for (int plane = 0; plane < 6; ++plane) node.plane[plane][lane] = plane < 3 ? kFar : -kFar;
}

void widen(BoxTree::Node& node, int lane, const FloatBox& box) {
  for (int k = 0; k < 3; ++k) {
    node.plane[k][lane] = std::min(node.plane[k][lane], box.plane[k]);
    node.plane[3 + k][lane] = std::max(node.plane[3 + k][lane], box.plane[3 + k]);
  }
}

}  // namespace

void BoxTree::clear() {
  nodes_.clear();
  free_.clear();
  root_ = newNode(0);
  size_ = 0;
}

FloatBox BoxTree::box(std::int32_t item) const {
  return boxAt(nodes_[place_[item] / kWidth], place_[item] % kWidth);
}

void BoxTree::find(const FloatBox& box, std::vector<std::int32_t>& items) const {
  findBox(nodes_.data(), root_, box, items);
}

void BoxTree::find(const FloatLine& line, std::vector<std::int32_t>& items) const {
  findLine(nodes_.data(), root_, line, items);
}

std::int32_t BoxTree::newNode(std::int32_t level) {
  std::int32_t index = static_cast<std::int32_t>(nodes_.size());
  if (free_.empty()) {
    nodes_.emplace_back();
  } else {
    index = free_.back();
    free_.pop_back();
  }
  Node& node = nodes_[index];
  for (int lane = 0; lane < kWidth; ++lane) empty(node, lane);
  node.parent = -1;
  node.count = 0;
  node.level = level;
  return index;
}

void BoxTree::freeNode(std::int32_t node) { free_.push_back(node); }

void BoxTree::insert(const FloatBox& box, std::int32_t item) {
  if (place_.size() <= static_cast<std::size_t>(item)) place_.resize(static_cast<std::size_t>(item) + 1);
  ++size_;
  insertAt(0, box, item);
}

void BoxTree::insertAt(std::int32_t level, const FloatBox& box, std::int32_t child) {
  std::int32_t at = root_;
  while (nodes_[at].level > level) {
    const int lane = bestLane(nodes_[at], box);
    widen(nodes_[at], lane, box);
    at = nodes_[at].child[lane];
  }
  put(at, box, child);
}

void BoxTree::set(std::int32_t node, int lane, const FloatBox& box, std::int32_t child) {
  setBox(nodes_[node], lane, box);
  nodes_[node].child[lane] = child;
  (nodes_[node].level == 0 ? place_[child] : nodes_[child].parent) = kWidth * node + lane;
}

/// What is above `node` holds the box already.
void BoxTree::put(std::int32_t node, const FloatBox& box, std::int32_t child) {
  if (nodes_[node].count == kWidth) {
    split(node, box, child);
  } else {
    set(node, nodes_[node].count++, box, child);
  }
}

/// One half of a full node and of the new box goes into a new node beside it.
void BoxTree::split(std::int32_t node, const FloatBox& box, std::int32_t child) {
  constexpr int kAll = kWidth + 1;
  FloatBox boxes[kAll];
  std::int32_t children[kAll];
  for (int i = 0; i < kWidth; ++i) {
    boxes[i] = boxAt(nodes_[node], i);
    children[i] = nodes_[node].child[i];
  }
  boxes[kWidth] = box;
  children[kWidth] = child;
  float low[3] = {kFar, kFar, kFar}, high[3] = {-kFar, -kFar, -kFar};
  for (const FloatBox& each : boxes) {
    for (int k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], each.plane[k] + each.plane[3 + k]);
      high[k] = std::max(high[k], each.plane[k] + each.plane[3 + k]);
    }
  }
  int axis = 0;
  for (int k = 1; k < 3; ++k)
    if (high[k] - low[k] > high[axis] - low[axis]) axis = k;
  int order[kAll];
  std::iota(order, order + kAll, 0);
  std::nth_element(order, order + kAll / 2, order + kAll, [&](int i, int j) {
    const float a = boxes[i].plane[axis] + boxes[i].plane[3 + axis];
    const float b = boxes[j].plane[axis] + boxes[j].plane[3 + axis];
    return a != b ? a < b : i < j;
  });

  const std::int32_t level = nodes_[node].level, beside = newNode(level);
  for (int i = 0; i < kWidth; ++i) {
    if (i < kAll / 2) {
      set(node, i, boxes[order[i]], children[order[i]]);
    } else {
      empty(nodes_[node], i);
    }
  }
  nodes_[node].count = kAll / 2;
  for (int i = kAll / 2; i < kAll; ++i)
    set(beside, nodes_[beside].count++, boxes[order[i]], children[order[i]]);
  if (node == root_) {
    root_ = newNode(level + 1);
    put(root_, boundsOf(nodes_[node]), node);
  } else {
    const std::int32_t place = nodes_[node].parent;
    setBox(nodes_[place / kWidth], place % kWidth, boundsOf(nodes_[node]));
  }
  put(nodes_[node].parent / kWidth, boundsOf(nodes_[beside]), beside);
}

void BoxTree::remove(std::int32_t item) {
  --size_;
  takeOut(place_[item]);
}

void BoxTree::takeOut(std::int32_t place) {
  const std::int32_t at = place / kWidth;
  const int last = --nodes_[at].count;
  if (place % kWidth != last) set(at, place % kWidth, boxAt(nodes_[at], last), nodes_[at].child[last]);
  empty(nodes_[at], last);
  if (at != root_) {
    if (nodes_[at].count < kFewest) {
      dissolve(at);
    } else {
      shrink(at);
    }
  } else if (nodes_[at].level > 0 && nodes_[at].count == 1) {
    root_ = nodes_[at].child[0];
    nodes_[root_].parent = -1;
    freeNode(at);
  }
}

void BoxTree::dissolve(std::int32_t index) {
  const Node node = nodes_[index];
  freeNode(index);
  takeOut(node.parent);
  for (int lane = 0; lane < node.count; ++lane)
    insertAt(node.level, boxAt(node, lane), node.child[lane]);
}

void BoxTree::shrink(std::int32_t node) {
  while (node != root_) {
    const FloatBox box = boundsOf(nodes_[node]);
    const std::int32_t place = nodes_[node].parent;
    Node& above = nodes_[place / kWidth];
    if (box.holds(boxAt(above, place % kWidth))) return;
    setBox(above, place % kWidth, box);
    node = place / kWidth;
  }
}

}  // namespace collision_node::scene

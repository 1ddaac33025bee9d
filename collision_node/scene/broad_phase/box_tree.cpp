#include "collision_node/scene/broad_phase/box_tree.h"

#include <algorithm>
#include <array>
#include <limits>

namespace collision_node::scene {

namespace {

constexpr int kWidth = BoxNode::kWidth;
/// A node that is left with fewer is dissolved. So all but the root have as many, and 14 above each other
/// would hold more than 2^31 items.
constexpr int kFewest = 5;

/// Half the surface. Only steers the tree's shape.
float area(const FloatBox& box) {
  const float x = box.plane[3] - box.plane[0], y = box.plane[4] - box.plane[1],
              z = box.plane[5] - box.plane[2];
  return x * y + y * z + z * x;
}

}  // namespace

void BoxTree::clear() {
  nodes_.clear();
  free_.clear();
  root_ = newNode(0);
  size_ = 0;
}

std::int32_t BoxTree::newNode(std::int32_t level) {
  std::int32_t index = static_cast<std::int32_t>(nodes_.size());
  if (free_.empty()) {
    nodes_.emplace_back();
  } else {
    index = free_.back();
    free_.pop_back();
  }
  BoxNode& node = nodes_[index];
  for (int lane = 0; lane < kWidth; ++lane) node.clear(lane);
  node.parent = -1;
  node.count = 0;
  node.level = level;
  return index;
}

void BoxTree::makePlaceFor(std::int32_t item) {
  if (place_.size() <= static_cast<std::size_t>(item)) place_.resize(static_cast<std::size_t>(item) + 1);
  ++size_;
}

void BoxTree::insert(const FloatBox& box, std::int32_t item) {
  makePlaceFor(item);
  insertAt(0, {box, item});
}

/// Whoever meets the box has been looked at: no way down from the root is needed to find out who grows least.
void BoxTree::insert(const FloatBox& box, std::int32_t item, const BoxWalk& walk) {
  std::int32_t best = -1;
  float least = std::numeric_limits<float>::infinity();
  for (const std::int32_t* at = walk.leavesBegin(); at != walk.leavesEnd(); ++at) {
    const std::int32_t place = nodes_[*at].parent;
    if (place < 0) break;
    const FloatBox own = nodes_[place / kWidth].box(place % kWidth);
    const float after = area(around(own, box)), cost = (after - area(own)) + BoxNode::kShareOfArea * after;
    if (cost < least) {
      least = cost;
      best = *at;
    }
  }
  if (best < 0) return insert(box, item);
  makePlaceFor(item);
  for (std::int32_t place = nodes_[best].parent; place >= 0; place = nodes_[place / kWidth].parent) {
    BoxNode& above = nodes_[place / kWidth];
    const FloatBox own = above.box(place % kWidth);
    if (own.holds(box)) break;
    above.setBox(place % kWidth, around(own, box));
  }
  put(best, {box, item});
}

void BoxTree::insertAt(std::int32_t level, const Entry& entry) {
  std::int32_t at = root_;
  while (nodes_[at].level > level) {
    const int lane = nodes_[at].bestLaneFor(entry.box);
    nodes_[at].widen(lane, entry.box);
    at = nodes_[at].child[lane];
  }
  put(at, entry);
}

void BoxTree::set(std::int32_t node, int lane, const Entry& entry) {
  nodes_[node].setBox(lane, entry.box);
  nodes_[node].child[lane] = entry.child;
  (nodes_[node].level == 0 ? place_[entry.child] : nodes_[entry.child].parent) = kWidth * node + lane;
}

/// What is above `node` holds the box already.
void BoxTree::put(std::int32_t node, const Entry& entry) {
  if (nodes_[node].count == kWidth) {
    split(node, entry);
  } else {
    set(node, nodes_[node].count++, entry);
  }
}

/// Of a full node and one more, some go into a new node beside it: along the axis on which their middles are
/// farthest apart, cut where surface times number of boxes is smallest.
void BoxTree::split(std::int32_t node, const Entry& entry) {
  constexpr int kAll = kWidth + 1;
  std::array<Entry, kAll> all, sorted;
  for (int lane = 0; lane < kWidth; ++lane) all[lane] = {nodes_[node].box(lane), nodes_[node].child[lane]};
  all[kWidth] = entry;
  float middle[3][kAll], widest = -1.0F;
  int axis = 0;
  for (int k = 0; k < 3; ++k) {
    for (int i = 0; i < kAll; ++i) middle[k][i] = all[i].box.plane[k] + all[i].box.plane[3 + k];
    const auto [low, high] = std::minmax_element(middle[k], middle[k] + kAll);
    if (*high - *low > widest) {
      widest = *high - *low;
      axis = k;
    }
  }
  for (int i = 0; i < kAll; ++i) {  // few enough to count for each how many come first, without a branch
    const float own = middle[axis][i];
    int before = 0;
    for (int k = 0; k < i; ++k) before += middle[axis][k] <= own ? 1 : 0;
    for (int k = i + 1; k < kAll; ++k) before += middle[axis][k] < own ? 1 : 0;
    sorted[before] = all[i];
  }
  float right[kAll];  // the surface of all from here on
  FloatBox box = sorted[kAll - 1].box;
  for (int i = kAll - 1; i > 0; --i) right[i] = area(box = around(box, sorted[i].box));
  int cut = kAll / 2;
  float least = std::numeric_limits<float>::infinity();
  box = sorted[0].box;
  for (int i = 1; i <= kAll - kFewest; ++i) {
    const float cost = area(box) * static_cast<float>(i) + right[i] * static_cast<float>(kAll - i);
    if (i >= kFewest && cost < least) {
      least = cost;
      cut = i;
    }
    box = around(box, sorted[i].box);
  }

  const std::int32_t level = nodes_[node].level, beside = newNode(level);
  for (int lane = cut; lane < kWidth; ++lane) nodes_[node].clear(lane);
  for (int i = 0; i < kAll; ++i) set(i < cut ? node : beside, i < cut ? i : i - cut, sorted[i]);
  nodes_[node].count = cut;
  nodes_[beside].count = kAll - cut;
  if (node == root_) {
    root_ = newNode(level + 1);
    set(root_, nodes_[root_].count++, {nodes_[node].bounds(), node});
  } else {
    const std::int32_t place = nodes_[node].parent;
    nodes_[place / kWidth].setBox(place % kWidth, nodes_[node].bounds());
  }
  put(nodes_[node].parent / kWidth, {nodes_[beside].bounds(), beside});
}

void BoxTree::remove(std::int32_t item) {
  --size_;
  takeOut(place_[item]);
}

/// Where the next ones are is known: their nodes are fetched meanwhile.
void BoxTree::remove(const std::vector<std::int32_t>& items) {
  constexpr std::size_t kAhead = 4, kLine = 64;
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (i + kAhead < items.size()) {
      const auto* node = reinterpret_cast<const char*>(&nodes_[place_[items[i + kAhead]] / kWidth]);
      for (std::size_t at = 0; at < sizeof(BoxNode); at += kLine) __builtin_prefetch(node + at);
    }
    remove(items[i]);
  }
}

void BoxTree::takeOut(std::int32_t place) {
  const std::int32_t at = place / kWidth;
  BoxNode& node = nodes_[at];
  const int lane = place % kWidth, last = --node.count;
  const FloatBox gone = node.box(lane);
  if (lane != last) set(at, lane, {node.box(last), node.child[last]});
  node.clear(last);
  if (at == root_) {
    if (node.level == 0 || node.count > 1) return;
    root_ = node.child[0];
    nodes_[root_].parent = -1;
    free_.push_back(at);
  } else if (node.count < kFewest) {
    dissolve(at);
  } else {
    shrink(at, gone);
  }
}

/// What the node has goes to others on its level.
void BoxTree::dissolve(std::int32_t index) {
  const BoxNode node = nodes_[index];
  free_.push_back(index);
  takeOut(node.parent);
  for (int lane = 0; lane < node.count; ++lane) insertAt(node.level, {node.box(lane), node.child[lane]});
}

/// Makes the boxes above `node`, which no longer has `gone`, as small as they may be. What lay within a box
/// and on none of its planes has not kept it large.
void BoxTree::shrink(std::int32_t node, FloatBox gone) {
  while (node != root_) {
    const std::int32_t place = nodes_[node].parent;
    BoxNode& above = nodes_[place / kWidth];
    const FloatBox before = above.box(place % kWidth);
    if (before.holdsInside(gone)) return;
    const FloatBox box = nodes_[node].bounds();
    if (box.holds(before)) return;
    above.setBox(place % kWidth, box);
    gone = before;
    node = place / kWidth;
  }
}

}  // namespace collision_node::scene

#include "collision_node/scene/box_tree.h"

#include <algorithm>
#include <utility>

namespace collision_node::scene {

namespace {

Bounds around(const Bounds& a, const Bounds& b) {
  return {a.lower.cwiseMin(b.lower), a.upper.cwiseMax(b.upper)};
}

/// Half the surface. Only steers the tree's shape.
double area(const Bounds& box) {
  const Vec3 size = box.upper - box.lower;
  return size.x() * size.y() + size.y() * size.z() + size.z() * size.x();
}

}  // namespace

void BoxTree::clear() {
  nodes_.clear();
  root_ = free_ = -1;
  size_ = 0;
}

std::int32_t BoxTree::newNode() {
  if (free_ < 0) {
    nodes_.emplace_back();
    return static_cast<std::int32_t>(nodes_.size()) - 1;
  }
  const std::int32_t node = std::exchange(free_, nodes_[free_].parent);
  nodes_[node] = Node();
  return node;
}

/// Where the tree's surface grows least, going down from the root.
std::int32_t BoxTree::bestSibling(const Bounds& box) const {
  std::int32_t at = root_;
  while (nodes_[at].height > 0) {
    const double own = area(nodes_[at].box), joint = area(around(nodes_[at].box, box));
    double best = 2.0 * joint;  // to stop here
    std::int32_t next = -1;
    for (const std::int32_t child : nodes_[at].child) {
      const Bounds& theirs = nodes_[child].box;
      const double grown = area(around(theirs, box)) - (nodes_[child].height > 0 ? area(theirs) : 0.0);
      const double cost = grown + 2.0 * (joint - own);
      if (cost >= best) continue;
      best = cost;
      next = child;
    }
    if (next < 0) break;
    at = next;
  }
  return at;
}

std::int32_t BoxTree::insert(const Bounds& box, std::int32_t item) {
  const std::int32_t leaf = newNode();
  nodes_[leaf].box = box;
  nodes_[leaf].child[0] = item;
  ++size_;
  if (root_ < 0) {
    root_ = leaf;
    return leaf;
  }
  const std::int32_t sibling = bestSibling(box);
  const std::int32_t parent = newNode();
  nodes_[parent].parent = nodes_[sibling].parent;
  nodes_[parent].child[0] = sibling;
  nodes_[parent].child[1] = leaf;
  replaceChild(nodes_[sibling].parent, sibling, parent);
  nodes_[sibling].parent = nodes_[leaf].parent = parent;
  mend(parent);
  return leaf;
}

void BoxTree::remove(std::int32_t leaf) {
  --size_;
  const std::int32_t parent = nodes_[leaf].parent;
  if (parent < 0) {
    root_ = -1;
  } else {
    const std::int32_t sibling = nodes_[parent].child[nodes_[parent].child[0] == leaf ? 1 : 0];
    const std::int32_t above = nodes_[parent].parent;
    replaceChild(above, parent, sibling);
    nodes_[sibling].parent = above;
    nodes_[parent].parent = std::exchange(free_, parent);
    mend(above);
  }
  nodes_[leaf].parent = std::exchange(free_, leaf);
}

void BoxTree::replaceChild(std::int32_t parent, std::int32_t child, std::int32_t by) {
  if (parent < 0) {
    root_ = by;
  } else {
    nodes_[parent].child[nodes_[parent].child[0] == child ? 0 : 1] = by;
  }
}

void BoxTree::refit(std::int32_t index) {
  Node& node = nodes_[index];
  const Node& left = nodes_[node.child[0]];
  const Node& right = nodes_[node.child[1]];
  node.box = around(left.box, right.box);
  node.height = 1 + std::max(left.height, right.height);
}

/// Makes boxes and heights right from `node` up to the root.
void BoxTree::mend(std::int32_t node) {
  while (node >= 0) {
    node = balance(node);
    refit(node);
    node = nodes_[node].parent;
  }
}

/// Where one side is higher by two, its root goes up in place of `top`, and its lower child to `top`. Returns
/// the root of what was below `top`.
std::int32_t BoxTree::balance(std::int32_t top) {
  const int lean = nodes_[nodes_[top].child[1]].height - nodes_[nodes_[top].child[0]].height;
  if (lean >= -1 && lean <= 1) return top;
  const int high = lean > 0 ? 1 : 0;
  const std::int32_t up = nodes_[top].child[high];
  const int lower = nodes_[nodes_[up].child[0]].height < nodes_[nodes_[up].child[1]].height ? 0 : 1;
  const std::int32_t moved = nodes_[up].child[lower];
  const std::int32_t above = nodes_[top].parent;
  replaceChild(above, top, up);
  nodes_[up].parent = above;
  nodes_[up].child[lower] = top;
  nodes_[top].parent = up;
  nodes_[top].child[high] = moved;
  nodes_[moved].parent = top;
  refit(top);
  return up;
}

}  // namespace collision_node::scene

/// A tree of boxes that come and go one by one.
///
/// Guarantee: visit() calls for every box in the tree that meets what is asked about; a box that only touches
/// counts. Insertion and removal follow one path to the root. Source: E. Catto, b2DynamicTree (2009): surface
/// area descent, rotations of an AVL tree.
#pragma once

#include <cstdint>
#include <vector>

#include "collision_node/scene/sweep.h"

namespace collision_node::scene {

class BoxTree {
 public:
  /// Returns the leaf's name, which it keeps until it is removed.
  std::int32_t insert(const Bounds& box, std::int32_t item);
  void remove(std::int32_t leaf);
  void clear();

  const Bounds& box(std::int32_t leaf) const { return nodes_[leaf].box; }
  std::int32_t item(std::int32_t leaf) const { return nodes_[leaf].child[0]; }
  std::size_t size() const { return size_; }

  /// `Question` has meets(const Bounds&), which may err on the side of true. Calls found(leaf).
  template <typename Question, typename Found>
  void visit(const Question& question, Found&& found) const {
    if (root_ < 0) return;
    // Depth first: one for each level and one more wait at most.
    std::int32_t usual[kUsualHeight + 1];
    std::vector<std::int32_t> higher(nodes_[root_].height > kUsualHeight ? nodes_[root_].height + 1 : 0);
    std::int32_t* stack = higher.empty() ? usual : higher.data();
    int waiting = 0;
    stack[waiting++] = root_;
    while (waiting > 0) {
      const std::int32_t index = stack[--waiting];
      const Node& node = nodes_[index];
      if (!question.meets(node.box)) continue;
      if (node.height == 0) {
        found(index);
      } else {
        __builtin_prefetch(&nodes_[node.child[0]]);
        stack[waiting++] = node.child[0];
        stack[waiting++] = node.child[1];
      }
    }
  }

 private:
  static constexpr int kUsualHeight = 63;  ///< balanced trees of a million leaves have half of it

  /// One line of the cache.
  struct alignas(64) Node {
    Bounds box{Vec3::Zero(), Vec3::Zero()};
    std::int32_t parent = -1;
    std::int32_t child[2] = {-1, -1};  ///< of a leaf: its item, and nothing
    std::int32_t height = 0;           ///< of a leaf: 0
  };

  std::int32_t newNode();
  std::int32_t bestSibling(const Bounds& box) const;
  void refit(std::int32_t node);
  void mend(std::int32_t node);
  std::int32_t balance(std::int32_t node);
  void replaceChild(std::int32_t parent, std::int32_t child, std::int32_t by);

  std::vector<Node> nodes_;
  std::int32_t root_ = -1, free_ = -1;  ///< free nodes hang together by `parent`
  std::size_t size_ = 0;
};

}  // namespace collision_node::scene

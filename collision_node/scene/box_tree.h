/// A tree of boxes that come and go one by one, sixteen a node.
///
/// Guarantee: find() names every box in the tree that meets what is asked about; a box that only touches
/// counts. Source: A. Guttman, R-trees (1984); nodes laid out so that one operation serves all boxes of one.
#pragma once

#include <cstdint>
#include <vector>

#include "collision_node/scene/float_box.h"

namespace collision_node::scene {

class BoxTree {
 public:
  BoxTree() { clear(); }

  /// `item` >= 0 names the box; no other in the tree may have its name.
  void insert(const FloatBox& box, std::int32_t item);
  void remove(std::int32_t item);
  void clear();

  FloatBox box(std::int32_t item) const;
  std::size_t size() const { return size_; }

  /// Adds to `items`.
  void find(const FloatBox& box, std::vector<std::int32_t>& items) const;
  void find(const FloatLine& line, std::vector<std::int32_t>& items) const;

  static constexpr int kWidth = 16;
  struct alignas(64) Node {
    float plane[6][kWidth];       ///< of an empty lane: inside out
    std::int32_t child[kWidth];  ///< a node; on level 0: an item
    std::int32_t parent;         ///< the place above: kWidth * node + lane
    std::int32_t count;          ///< the first so many lanes are in use
    std::int32_t level;
  };

 private:
  std::int32_t newNode(std::int32_t level);
  void freeNode(std::int32_t node);
  void insertAt(std::int32_t level, const FloatBox& box, std::int32_t child);
  void put(std::int32_t node, const FloatBox& box, std::int32_t child);
  void set(std::int32_t node, int lane, const FloatBox& box, std::int32_t child);
  void split(std::int32_t node, const FloatBox& box, std::int32_t child);
  void takeOut(std::int32_t place);
  void dissolve(std::int32_t node);
  void shrink(std::int32_t node);

  std::vector<Node> nodes_;
  std::vector<std::int32_t> place_;  ///< by item
  std::vector<std::int32_t> free_;
  std::int32_t root_ = 0;
  std::size_t size_ = 0;
};

}  // namespace collision_node::scene

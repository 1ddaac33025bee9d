/// A tree of boxes that come and go one by one, thirty-two a node.
///
/// Guarantee: find() names every box in the tree that meets what is asked about; a box that only touches
/// counts. Of a line, see FloatLine; it may err on the side of too many. Source: A. Guttman, R-trees (1984).
#pragma once

#include <cstdint>
#include <vector>

#include "collision_node/scene/broad_phase/box_node.h"

namespace collision_node::scene {

class BoxTree {
 public:
  BoxTree() { clear(); }

  /// `item` >= 0 names the box; names are counted from 0 on, and no two boxes may have the same.
  void insert(const FloatBox& box, std::int32_t item);
  /// The same, when find() was asked last about the box, or the line that it is around, and nothing was put
  /// in or taken out since: `walk` is where it met others.
  void insert(const FloatBox& box, std::int32_t item, const BoxWalk& walk);
  void remove(std::int32_t item);
  void remove(const std::vector<std::int32_t>& items);
  void clear();
  std::size_t size() const { return size_; }

  /// The walk has the items then, in no order that means anything.
  template <typename Question>
  void find(const Question& question, BoxWalk& walk, impact::Lanes lanes = impact::fastestLanes()) const {
    findItems(nodes_.data(), root_, question, walk, lanes);
  }

 private:
  struct Entry {
    FloatBox box;
    std::int32_t child;
  };

  void makePlaceFor(std::int32_t item);
  std::int32_t newNode(std::int32_t level);
  void insertAt(std::int32_t level, const Entry& entry);
  void put(std::int32_t node, const Entry& entry);
  void set(std::int32_t node, int lane, const Entry& entry);
  void split(std::int32_t node, const Entry& entry);
  void takeOut(std::int32_t place);
  void dissolve(std::int32_t node);
  void shrink(std::int32_t node, FloatBox gone);

  std::vector<BoxNode> nodes_;
  std::vector<std::int32_t> place_;  ///< of an item: kWidth * node + lane
  std::vector<std::int32_t> free_;   ///< nodes
  std::int32_t root_ = 0;
  std::size_t size_ = 0;
};

}  // namespace collision_node::scene

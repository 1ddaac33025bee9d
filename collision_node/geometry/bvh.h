/// A bounding volume hierarchy of axis-aligned boxes, four children a block, one element a leaf, about 43
/// bytes an element.
///
/// Guarantee: every node's box, and its reach, hold what they were built from in exact arithmetic: boxes are
/// floats relative to the hierarchy's own origin, rounded outward. Source of the build: Wald 2007, binned
/// surface area heuristic; upper levels of large bodies between the cells of a grid (grid_order.h).
#pragma once

#include <cstdint>
#include <vector>

#include "collision_node/geometry/types.h"

namespace collision_node::geometry {

/// An axis-aligned box [m].
struct Bounds {
  Vec3 lower, upper;
};

/// A triangle by its vertices.
struct Triangle {
  std::int32_t v[3];
  std::int32_t loaded;  ///< its number among all triangles as loaded
};

/// One node, gathered from its block.
struct BvhNode {
  float centre[3];                 ///< relative to Bvh::origin() [m]
  float half[3];                   ///< half extents [m]
  float reach;                     ///< >= distance of any point of the node from the *frame's* origin [m]
  std::int32_t link;               ///< >= 0: the block of its children; < 0: a leaf of element ~link
  float plate[3];                  ///< whole numbers, |plate| <= kPlateLength; zero where there is no plate
  float plate_middle, plate_half;  ///< |plate . (p - origin) - middle| <= half for every point p of the node

  bool leaf() const { return link < 0; }
  std::int32_t element() const { return ~link; }
};

constexpr double kPlateLength = 127.0;

/// Up to four nodes with the same parent, laid out so that one operation serves all of them. In memory a
/// block is followed by all that is below its first node, then by all that is below its second, and so on.
struct alignas(16) BvhBlock {
  static constexpr int kWidth = 4;

  BvhBlock() {}  // who makes it fills it
  float centre[3][kWidth];
  float half[3][kWidth];  ///< far below zero where there is no node: such a box meets nothing
  float reach[kWidth];
  std::int32_t link[kWidth];
  float plate_middle[kWidth];
  float plate_half[kWidth];
  std::int8_t plate[3][kWidth];
};

class Bvh {
 public:
  static constexpr std::int32_t kRoot = 0;

  Bvh() = default;
  /// Elements are the triangles, in the order of the tree, which is left in `order`, and then `others`, by
  /// boxes in the body's frame. The same input gives the same tree on any machine.
  Bvh(const std::vector<Vec3>& vertices, const std::vector<Triangle>& triangles,
      const std::vector<Bounds>& others, std::vector<std::int32_t>& order);
  /// Gives a plate to every node that holds nothing but triangles. These, and the vertices, are in the order
  /// in which the tree meets them first.
  void addPlates(const std::vector<Vec3>& vertices, const std::vector<Triangle>& triangles);

  /// Another box for a hierarchy over one box; asks for no memory.
  void replaceOnly(const Bounds& box);

  /// Nodes are numbered 4 block + lane.
  BvhNode operator[](std::int32_t node) const;
  const BvhBlock& block(std::int32_t i) const { return blocks_[i]; }
  /// Asks for a block that will be needed soon; `link` as in BvhNode.
  void prefetch(std::int32_t link) const {
    if (link < 0) return;
    __builtin_prefetch(&blocks_[link]);
    __builtin_prefetch(reinterpret_cast<const char*>(&blocks_[link]) + 64);
    __builtin_prefetch(reinterpret_cast<const char*>(&blocks_[link]) + 128);
  }
  /// Some numbers below are not nodes: exists() tells.
  std::int32_t size() const { return BvhBlock::kWidth * static_cast<std::int32_t>(blocks_.size()); }
  std::size_t bytes() const { return blocks_.size() * sizeof(BvhBlock); }
  bool exists(std::int32_t node) const;
  const Vec3& origin() const { return origin_; }
  /// The node's box in the body's frame: exact sums of doubles need not be representable, hence for proofs
  /// the caller works relative to origin(), or budgets for the sum.
  Vec3 centre(std::int32_t node) const;
  Vec3 half(std::int32_t node) const;

 private:
  Vec3 origin_ = Vec3::Zero();
  std::vector<BvhBlock> blocks_;
};

inline BvhNode Bvh::operator[](std::int32_t node) const {
  const BvhBlock& b = blocks_[node / BvhBlock::kWidth];
  const int i = node % BvhBlock::kWidth;
  return {{b.centre[0][i], b.centre[1][i], b.centre[2][i]},
          {b.half[0][i], b.half[1][i], b.half[2][i]},
          b.reach[i],
          b.link[i],
          {static_cast<float>(b.plate[0][i]), static_cast<float>(b.plate[1][i]),
           static_cast<float>(b.plate[2][i])},
          b.plate_middle[i],
          b.plate_half[i]};
}

}  // namespace collision_node::geometry

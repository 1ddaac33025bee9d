/// Thirty-two boxes side by side, so that one operation serves many of them.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "collision_node/impact/straight/path_walk.h"
#include "collision_node/scene/broad_phase/float_box.h"

namespace collision_node::scene {

struct alignas(64) BoxNode {
  static constexpr int kWidth = 32;
  /// Of what comes to hold a box, among those whose surface grows about alike the smallest.
  static constexpr float kShareOfArea = 0x1p-10F;

  float plane[6][kWidth];      ///< as in FloatBox; of a lane that is not in use: inside out
  std::int32_t child[kWidth];  ///< a node; on level 0: an item
  std::int32_t parent;         ///< the place above, kWidth * node + lane; -1: none
  std::int32_t count;          ///< the first so many lanes are in use
  std::int32_t level;

  FloatBox box(int lane) const {
    FloatBox box;
    for (int i = 0; i < 6; ++i) box.plane[i] = plane[i][lane];
    return box;
  }
  void setBox(int lane, const FloatBox& box) {
    for (int i = 0; i < 6; ++i) plane[i][lane] = box.plane[i];
  }
  void widen(int lane, const FloatBox& with) { setBox(lane, around(box(lane), with)); }
  void clear(int lane) {
    constexpr float kFar = std::numeric_limits<float>::infinity();
    for (int i = 0; i < 6; ++i) plane[i][lane] = i < 3 ? kFar : -kFar;
  }

  /// Of all lanes in use.
  FloatBox bounds() const;
  /// The lane whose surface grows least by `box`.
  int bestLaneFor(const FloatBox& box) const;
};

/// A list that keeps its room, and what a walk has yet to see.
struct BoxWalk {
  std::vector<std::int32_t> room;
  std::size_t leaves = 0, begin = 0, end = 0;

  const std::int32_t* items() const { return room.data() + begin; }
  std::size_t count() const { return end - begin; }
  /// The nodes on level 0 that the items were looked for in.
  const std::int32_t* leavesBegin() const { return room.data() + leaves; }
  const std::int32_t* leavesEnd() const { return room.data() + begin; }
};

/// Leaves the items below `root` whose boxes meet what is asked about, and perhaps some whose boxes do not
/// meet a line. All items are equally far below it.
void findItems(const BoxNode* nodes, std::int32_t root, const FloatBox& box, BoxWalk& walk,
               impact::Lanes lanes);
void findItems(const BoxNode* nodes, std::int32_t root, const FloatLine& line, BoxWalk& walk,
               impact::Lanes lanes);

}  // namespace collision_node::scene

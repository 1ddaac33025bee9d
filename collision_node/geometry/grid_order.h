/// The upper levels of a Bvh without a pass for each: elements are sorted into the cells of a grid once, and
/// the cells are split where area times number of elements is smallest.
#pragma once

#include <vector>

#include "collision_node/geometry/bvh_elements.h"

namespace collision_node::geometry {

class GridOrder {
 public:
  /// A range of entries that is known to fall into two.
  struct Split {
    std::size_t middle;     ///< where the second begins
    RegisterBox box[2];     ///< of both
    std::int32_t below[2];  ///< the splits of both; kNone where all lie in one cell
  };
  static constexpr std::int32_t kNone = -1;

  /// Writes an entry for each element, in the order of the cells where there are enough of them to be worth
  /// it, else as they are. The same elements give the same order on any machine.
  GridOrder(const Elements& elements, Entry* entries);

  std::int32_t root() const { return root_; }  ///< as Split::below
  const Split& operator[](std::int32_t i) const { return splits_[static_cast<std::size_t>(i)]; }
  std::size_t largestCell() const { return largest_cell_; }  ///< of how many entries nothing is known

 private:
  struct Cell {
    RegisterBox box;
    int place[3];  ///< in the grid
    std::size_t count, next;
  };

  void sort(const Elements& elements, int along, float per_length, Entry* entries);
  std::int32_t split(std::size_t begin, std::size_t end);

  std::size_t largest_cell_;
  std::vector<Cell> cells_;          ///< those that hold something
  std::vector<std::int32_t> order_;  ///< of the cells
  std::vector<Split> splits_;
  std::int32_t root_ = kNone;
};

}  // namespace collision_node::geometry

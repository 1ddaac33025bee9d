/// Plates of a Bvh: planes on either side of what lies below a node.
#include <algorithm>
#include <cmath>
#include <limits>

#include "collision_node/geometry/bvh_elements.h"

namespace collision_node::geometry {
namespace {

constexpr int kWidth = BvhBlock::kWidth;
constexpr float kFar = RegisterBox::kFar;

/// Heights of points along the axis of each lane.
struct Heights {
  FourFloats axis[3] = {};
  FourFloats low = FourFloats{} + kFar, high = FourFloats{} - kFar;

  FourFloats along(const FourFloats& x, const FourFloats& y, const FourFloats& z) const {
    return (axis[0] * x + axis[1] * y) + axis[2] * z;
  }
  void add(const FourFloats& height) {
    low = smaller(height, low);
    high = larger(height, high);
  }
};

/// From the last block to the first, so that a block comes after all that is below it, and what those left is
/// at the end of a list, the first lane's last.
///
/// A node's vertices are those that its triangles are the first to meet, which lie in one row, and those that
/// it shares with triangles before it, which are few. So each level looks at half a vertex a triangle and at
/// the node's rim, where corners would be three a triangle.
class Plates {
 public:
  Plates(const std::vector<Vec3>& vertices, const std::vector<Triangle>& triangles, const Vec3& origin,
         std::vector<BvhBlock>& blocks)
      : vertices_(vertices),
        triangles_(triangles),
        images_(imagesOf(vertices, origin)),
        blocks_(blocks),
        met_before_(1, 0),
        last_kept_(vertices.size(), -1) {
    met_before_.reserve(triangles.size() + 1);
    for (const Triangle& t : triangles)
      met_before_.push_back(std::max(met_before_.back(), 1 + std::max({t.v[0], t.v[1], t.v[2]})));
    for (auto block = static_cast<std::int32_t>(blocks.size()); block-- > 0;) serve(block);
  }

 private:
  /// What lies below a node.
  struct Below {
    Vec3 normal = Vec3::Zero();  ///< sum of the triangles' normals, each as long as twice its area
    std::int32_t begin = std::numeric_limits<std::int32_t>::max(), end = 0;  ///< triangles
    std::size_t shared = 0;  ///< where its vertices that were met before begin in shared_
    bool only_triangles = true;

    void add(const Below& more) {
      normal += more.normal;
      begin = std::min(begin, more.begin);
      end = std::max(end, more.end);
      only_triangles = only_triangles && more.only_triangles;
    }
  };

  const FourFloats& image(std::int32_t vertex) const { return images_[static_cast<std::size_t>(vertex)]; }
  const Triangle& triangle(std::int32_t i) const { return triangles_[static_cast<std::size_t>(i)]; }
  std::int32_t metBefore(std::int32_t triangle) const {
    return met_before_[static_cast<std::size_t>(triangle)];
  }

  Below belowLeaf(std::int32_t element) const {
    Below below;
    below.only_triangles = static_cast<std::size_t>(element) < triangles_.size();
    if (!below.only_triangles) return below;
    below.begin = element;
    below.end = element + 1;
    const auto vertex = [this](std::int32_t v) -> const Vec3& {
      return vertices_[static_cast<std::size_t>(v)];
    };
    const std::int32_t* const v = triangle(element).v;
    below.normal = (vertex(v[1]) - vertex(v[0])).cross(vertex(v[2]) - vertex(v[0]));
    return below;
  }

  void serve(std::int32_t number) {
    BvhBlock& block = blocks_[static_cast<std::size_t>(number)];
    Below below[kWidth], all;
    float axis[3][kWidth] = {};
    std::int32_t leaf[kWidth] = {};  // where there is none the first triangle, whose heights nobody asks for
    int count = 0;
    bool leaves = false;
    for (; count < kWidth && block.half[0][count] >= 0.0F; ++count) {
      const std::int32_t link = block.link[count];
      if (link < 0) {
        below[count] = belowLeaf(~link);
      } else {
        below[count] = below_.back();
        below_.pop_back();
      }
      all.add(below[count]);
      if (!below[count].only_triangles) continue;
      setAxis(block, count, below[count].normal, axis);
      if (link >= 0) continue;
      leaf[count] = ~link;
      leaves = true;
    }
    Heights heights;
    for (int k = 0; k < 3; ++k) heights.axis[k] = loadFour(axis[k]);
    if (leaves) addCorners(leaf, heights);
    std::size_t end = shared_end_;
    for (int lane = 0; lane < count; ++lane) {
      if (block.link[lane] < 0) continue;
      if (below[lane].only_triangles) setHeights(below[lane], end, lane, heights);
      end = below[lane].shared;
    }
    setPlates(block, heights);
    all.shared = end;
    if (all.end > 0) keepShared(number, count, end, metBefore(all.begin));
    below_.push_back(all);
  }

  /// Across the mean normal. Any direction is sound; short ones keep |plate| below its limit.
  static void setAxis(BvhBlock& block, int lane, const Vec3& normal, float axis[3][kWidth]) {
    const double length = normal.norm();
    if (!(length > 0.0 && length < std::numeric_limits<double>::infinity())) return;
    const double scale = (kPlateLength - 1.0) / length;
    for (int k = 0; k < 3; ++k) {
      constexpr int kAbove = 256;  // is cut off as it is rounded, whatever the sign
      const int nearest = static_cast<int>(normal[k] * scale + (kAbove + 0.5)) - kAbove;
      block.plate[k][lane] = static_cast<std::int8_t>(nearest);
      axis[k][lane] = static_cast<float>(nearest);
    }
  }

  void addCorners(const std::int32_t leaf[kWidth], Heights& heights) const {
    for (int corner = 0; corner < 3; ++corner) {
      FourFloats x[kWidth];
      for (int lane = 0; lane < kWidth; ++lane) x[lane] = image(triangle(leaf[lane]).v[corner]);
      transpose(x);
      heights.add(heights.along(x[0], x[1], x[2]));
    }
  }

  /// Four of the lane's vertices at a time.
  void setHeights(const Below& below, std::size_t shared_end, int lane, Heights& heights) const {
    Heights own;
    for (int k = 0; k < 3; ++k) own.axis[k] = FourFloats{} + heights.axis[k][lane];
    const auto add = [&](std::size_t begin, std::size_t end, const auto& image_at) {
      for (std::size_t i = begin; i < end; i += kWidth) {
        FourFloats x[kWidth];
        for (std::size_t k = 0; k < kWidth; ++k) x[k] = image_at(std::min(i + k, end - 1));
        transpose(x);
        own.add(own.along(x[0], x[1], x[2]));
      }
    };
    add(static_cast<std::size_t>(metBefore(below.begin)), static_cast<std::size_t>(metBefore(below.end)),
        [this](std::size_t i) { return images_[i]; });
    add(below.shared, shared_end, [this](std::size_t i) { return image(shared_[i]); });
    heights.low[lane] = std::min(std::min(own.low[0], own.low[1]), std::min(own.low[2], own.low[3]));
    heights.high[lane] = std::max(std::max(own.high[0], own.high[1]), std::max(own.high[2], own.high[3]));
  }

  /// A corner's difference from the origin is rounded to float, and so are three products and two sums: in
  /// all four roundings of at most 2^-24 |axis_k x_k| in each coordinate, x within the node's box, and one
  /// more of the middle. Twelve hold them and this sum's own; the last term holds what is lost near zero.
  static void setPlates(BvhBlock& block, const Heights& heights) {
    FourFloats size = {};
    for (int k = 0; k < 3; ++k)
      size += magnitude(heights.axis[k]) * (magnitude(loadFour(block.centre[k])) + loadFour(block.half[k]));
    const FourFloats middle = 0.5F * heights.low + 0.5F * heights.high;
    const FourFloats half =
        larger(heights.high - middle, middle - heights.low) + 12.0F * 0x1p-24F * size + 1e-35F;
    for (int lane = 0; lane < kWidth; ++lane) {
      if (heights.axis[0][lane] == 0.0F && heights.axis[1][lane] == 0.0F && heights.axis[2][lane] == 0.0F)
        continue;
      block.plate_middle[lane] = middle[lane];
      block.plate_half[lane] = half[lane];
    }
  }

  /// Of the vertices below a block, leaves those that were met before it at the end of the list, each once.
  void keepShared(std::int32_t number, int count, std::size_t begin, std::int32_t met_before) {
    const BvhBlock& block = blocks_[static_cast<std::size_t>(number)];
    if (shared_end_ + 3 * kWidth > shared_.size()) shared_.resize(2 * shared_.size() + 64);
    std::size_t kept = begin;
    const auto keep = [&](std::int32_t v) {
      shared_[kept] = v;
      std::int32_t& last = last_kept_[static_cast<std::size_t>(v)];
      kept += (v < met_before) & (last != number) ? 1 : 0;
      last = number;
    };
    for (std::size_t i = begin; i < shared_end_; ++i) keep(shared_[i]);
    for (int lane = 0; lane < count; ++lane) {
      if (block.link[lane] >= 0 || static_cast<std::size_t>(~block.link[lane]) >= triangles_.size()) continue;
      for (const std::int32_t v : triangle(~block.link[lane]).v) keep(v);
    }
    shared_end_ = kept;
  }

  const std::vector<Vec3>& vertices_;
  const std::vector<Triangle>& triangles_;
  const std::vector<FourFloats> images_;
  std::vector<BvhBlock>& blocks_;
  std::vector<std::int32_t> met_before_;  ///< by triangle: how many vertices those before it have
  std::vector<std::int32_t> last_kept_;   ///< by vertex: the last block that was asked whether it shares it
  std::vector<std::int32_t> shared_;
  std::size_t shared_end_ = 0;
  std::vector<Below> below_;  ///< blocks whose parent is yet to come
};

}  // namespace

void Bvh::addPlates(const std::vector<Vec3>& vertices, const std::vector<Triangle>& triangles) {
  if (!triangles.empty()) Plates(vertices, triangles, origin_, blocks_);
}

}  // namespace collision_node::geometry

/// Plates of a Bvh: planes on either side of what lies below a node.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "collision_node/geometry/bvh.h"

namespace collision_node::geometry {
namespace {

constexpr int kWidth = BvhBlock::kWidth;

using Floats = float __attribute__((vector_size(16)));

Floats load(const float* from) {
  Floats x;
  std::memcpy(&x, from, sizeof x);
  return x;
}

Floats larger(const Floats& x, const Floats& y) { return x > y ? x : y; }
Floats smaller(const Floats& x, const Floats& y) { return x < y ? x : y; }
Floats magnitude(const Floats& x) { return x < 0.0F ? -x : x; }

/// The triangles in their order, side by side.
class Triangles {
 public:
  Triangles(const std::vector<std::int32_t>& order, const Vec3& origin,
            const std::function<Bvh::Corners(std::int32_t)>& corners)
      : stride_(order.size() + kWidth),
        at_(9 * stride_),
        normals_(order.size() + 1, Vec3::Zero()),
        others_(order.size() + 1) {
    for (std::size_t i = 0; i < order.size(); ++i) {
      const Bvh::Corners t = corners(order[i]);
      const bool triangle = t[0] != nullptr;
      others_[i + 1] = others_[i] + (triangle ? 0 : 1);
      normals_[i + 1] = normals_[i];
      if (!triangle) continue;
      normals_[i + 1] += (*t[1] - *t[0]).cross(*t[2] - *t[0]);
      for (std::size_t corner = 0; corner < 3; ++corner) {
        const Vec3 x = *t[corner] - origin;
        for (std::size_t k = 0; k < 3; ++k) at_[(3 * corner + k) * stride_ + i] = static_cast<float>(x[k]);
      }
    }
  }

  bool only(std::int32_t begin, std::int32_t end) const { return others_[end] == others_[begin]; }
  /// Sum of normals, each as long as twice its triangle's area. Rounding only tilts the plate.
  Vec3 normal(std::int32_t begin, std::int32_t end) const { return normals_[end] - normals_[begin]; }
  /// A corner of four triangles, relative to the origin.
  void corner(std::int32_t first, int corner, Floats x[3]) const {
    for (int k = 0; k < 3; ++k) x[k] = load(&at_[(3 * corner + k) * stride_ + first]);
  }

 private:
  std::size_t stride_;
  std::vector<float> at_;             ///< all x of first corners, all y, ...; rounded to float
  std::vector<Vec3> normals_;         ///< sums of normals up to each
  std::vector<std::int32_t> others_;  ///< counts of what is no triangle up to each
};

/// The least and the largest height of the corners along the axes, rounded in float, lane by lane.
void widen(const Triangles& triangles, std::int32_t first, const Floats axis[3], Floats& low, Floats& high) {
  for (int corner = 0; corner < 3; ++corner) {
    Floats x[3];
    triangles.corner(first, corner, x);
    const Floats along = (axis[0] * x[0] + axis[1] * x[1]) + axis[2] * x[2];
    low = smaller(along, low);
    high = larger(along, high);
  }
}

/// Gives the block's lanes plates across the mean normals of their triangles.
void setPlates(BvhBlock& block, const Triangles& triangles, const std::int32_t begin[kWidth],
               const std::int32_t end[kWidth]) {
  // Any direction is sound; short ones keep |plate| below its limit.
  Floats axis[3] = {};
  for (int lane = 0; lane < kWidth; ++lane) {
    if (begin[lane] == end[lane] || !triangles.only(begin[lane], end[lane])) continue;
    const Vec3 normal = triangles.normal(begin[lane], end[lane]);
    const double length = normal.norm();
    if (!(length > 0.0)) continue;
    const double scale = (kPlateLength - 1.0) / length;
    for (int k = 0; k < 3; ++k) {
      const double wanted = normal[k] * scale;
      block.plate[k][lane] = static_cast<std::int8_t>(wanted + (wanted < 0.0 ? -0.5 : 0.5));
      axis[k][lane] = block.plate[k][lane];
    }
  }
  constexpr float kFar = std::numeric_limits<float>::infinity();
  Floats low = kFar - Floats{}, high = -low;
  bool leaves = true;
  for (int lane = 0; lane < kWidth; ++lane)
    leaves = leaves &&
             (begin[lane] == end[lane] || (end[lane] == begin[lane] + 1 && begin[lane] == begin[0] + lane));
  if (leaves) {
    widen(triangles, begin[0], axis, low, high);
  } else {
    for (int lane = 0; lane < kWidth; ++lane) {
      const Floats all[3] = {axis[0][lane] - Floats{}, axis[1][lane] - Floats{}, axis[2][lane] - Floats{}};
      Floats least = kFar - Floats{}, most = -least;
      std::int32_t first = begin[lane];
      for (; first + kWidth <= end[lane]; first += kWidth) widen(triangles, first, all, least, most);
      for (; first < end[lane]; ++first) {
        Floats one_low = kFar - Floats{}, one_high = -one_low;
        widen(triangles, first, all, one_low, one_high);
        least[0] = std::min(least[0], one_low[0]);
        most[0] = std::max(most[0], one_high[0]);
      }
      low[lane] = std::min(std::min(least[0], least[1]), std::min(least[2], least[3]));
      high[lane] = std::max(std::max(most[0], most[1]), std::max(most[2], most[3]));
    }
  }
  // A corner's difference from the origin is rounded to float, and so are three products and two sums: in all
  // four roundings of at most 2^-24 |axis_k x_k| in each coordinate, x within the node's box, and one more of
  // the middle. Twelve hold them and this sum's own; the last term holds what is lost near zero.
  Floats size = {};
  for (int k = 0; k < 3; ++k)
    size += magnitude(axis[k]) * (magnitude(load(block.centre[k])) + load(block.half[k]));
  const Floats middle = 0.5F * low + 0.5F * high;
  const Floats half = larger(high - middle, middle - low) + 12.0F * 0x1p-24F * size + 1e-42F;
  for (int lane = 0; lane < kWidth; ++lane) {
    if (axis[0][lane] == 0.0F && axis[1][lane] == 0.0F && axis[2][lane] == 0.0F) continue;
    block.plate_middle[lane] = middle[lane];
    block.plate_half[lane] = half[lane];
  }
}

}  // namespace

void Bvh::addPlates(const std::function<Corners(std::int32_t)>& corners) {
  const Triangles triangles(order_, origin_, corners);
  for (std::size_t block = 0; block < blocks_.size(); ++block) {
    std::int32_t begin[kWidth], end[kWidth];
    for (std::size_t lane = 0; lane < kWidth; ++lane) {
      begin[lane] = held_[kWidth * block + lane].begin;
      end[lane] = held_[kWidth * block + lane].end;
    }
    setPlates(blocks_[block], triangles, begin, end);
  }
  order_ = std::vector<std::int32_t>();  // gives the memory back
  held_ = std::vector<Held>();
}

}  // namespace collision_node::geometry

/// Plates of a Bvh: planes on either side of what lies below a node.
#include <algorithm>
#include <cmath>
#include <limits>

#include "collision_node/geometry/bvh.h"
#include "collision_node/geometry/round_to_float.h"

namespace collision_node::geometry {
namespace {

/// The corners of triangles in a given order, each vertex once, in the order of their first use.
struct Points {
  Points(const std::vector<std::int32_t>& order, const Vec3& origin,
         const std::function<Bvh::Corners(std::int32_t)>& corners) {
    normals.reserve(order.size() + 1);
    others.reserve(order.size() + 1);
    first.reserve(order.size() + 1);
    used.reserve(3 * order.size());
    places.reserve(order.size());
    std::vector<Bvh::Corners> triangles;
    triangles.reserve(order.size());
    const Vec3 *lowest = nullptr, *highest = nullptr;  // of the one array that all corners lie in
    for (const std::int32_t element : order) {
      triangles.push_back(corners(element));
      if (triangles.back()[0] == nullptr) continue;
      for (const Vec3* p : triangles.back()) {
        if (lowest == nullptr) lowest = highest = p;
        lowest = std::min(lowest, p);
        highest = std::max(highest, p);
      }
    }
    std::vector<std::int32_t> number(lowest == nullptr ? 0 : highest - lowest + 1, -1);
    normals.push_back(Vec3::Zero());
    others.push_back(0);
    for (const Bvh::Corners& t : triangles) {
      first.push_back(static_cast<std::int32_t>(places.size()));
      const bool triangle = t[0] != nullptr;
      others.push_back(others.back() + (triangle ? 0 : 1));
      normals.push_back(triangle ? Vec3(normals.back() + (*t[1] - *t[0]).cross(*t[2] - *t[0]))
                                 : normals.back());
      if (!triangle) {
        used.insert(used.end(), 3, -1);
        continue;
      }
      for (const Vec3* p : t) {
        std::int32_t& n = number[static_cast<std::size_t>(p - lowest)];
        if (n < 0) {
          n = static_cast<std::int32_t>(places.size());
          places.push_back(*p - origin);
        }
        used.push_back(n);
      }
    }
    first.push_back(static_cast<std::int32_t>(places.size()));
  }

  /// Every vertex of [begin, end), triangles only: those first used there lie together, the others are looked
  /// up.
  template <typename See>
  void forEach(std::int32_t begin, std::int32_t end, const See& see) const {
    for (std::int32_t i = first[begin]; i < first[end]; ++i) see(places[i]);
    for (std::int32_t i = 3 * begin; i < 3 * end; ++i) {
      if (used[i] < first[begin]) see(places[used[i]]);
    }
  }

  // Sums of normals, and counts of what is no triangle, up to each: those of a node are a difference of two.
  // Rounding only tilts the plate.
  std::vector<Vec3> normals;
  std::vector<std::int32_t> others;

 private:
  std::vector<Vec3> places;         ///< relative to the origin
  std::vector<std::int32_t> first;  ///< how many places were used before a triangle
  std::vector<std::int32_t> used;   ///< three numbers of places for each triangle, -1 for what is none
};

}  // namespace

void Bvh::addPlates(const std::function<Corners(std::int32_t)>& corners) {
  constexpr std::int32_t kMost = 1024;  // larger parts of a surface are rarely flat
  for (std::int32_t node = 0; node < size(); ++node) {
    if (exists(node) && (*this)[node].leaf()) order_[held_[node].begin] = (*this)[node].element();
  }
  const Points points(order_, origin_, corners);
  for (std::int32_t node = 0; node < size(); ++node) {
    const Held held = held_[node];
    if (held.end == held.begin || held.end - held.begin > kMost) continue;
    const Vec3 normal = points.normals[held.end] - points.normals[held.begin];
    const double length = normal.norm();
    if (points.others[held.end] != points.others[held.begin] || !(length > 0.0)) continue;
    // Any direction is sound; short ones keep |plate| below its limit.
    Vec3 axis = normal * ((kPlateLength - 1.0) / length);
    for (double& part : axis) part = static_cast<std::int8_t>(part + (part < 0.0 ? -0.5 : 0.5));
    double low = std::numeric_limits<double>::infinity(), high = -low;
    points.forEach(held.begin, held.end, [&](const Vec3& x) {
      const double along = axis.dot(x);
      low = std::min(low, along);
      high = std::max(high, along);
    });
    // Each `along` is a sum of three rounded products of rounded differences, of points within the node's
    // box.
    BvhBlock& block = blocks_[node / BvhBlock::kWidth];
    const int lane = node % BvhBlock::kWidth;
    double scale = 0.0;
    for (int k = 0; k < 3; ++k) {
      const double far = std::abs(block.centre[k][lane]) + block.half[k][lane];
      scale += far * far;
    }
    const double rounding = 16.0 * 1.2e-16 * kPlateLength * std::sqrt(scale);
    for (int k = 0; k < 3; ++k) block.plate[k][lane] = static_cast<std::int8_t>(axis[k]);
    block.plate_middle[lane] = static_cast<float>(0.5 * (low + high));
    const double middle = block.plate_middle[lane];
    block.plate_half[lane] = roundedUp(std::max(high - middle, middle - low) + rounding);
  }
  order_ = std::vector<std::int32_t>();  // gives the memory back
  held_ = std::vector<Held>();
}

}  // namespace collision_node::geometry

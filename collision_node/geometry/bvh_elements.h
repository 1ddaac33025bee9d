/// The elements that a Bvh is built over, as boxes of floats that are made anew each time they are asked for:
/// a vertex, which six triangles share, is rounded once, and no list of boxes is written or read.
#pragma once

#include <vector>

#include "collision_node/geometry/bvh.h"
#include "collision_node/geometry/bvh_entry.h"

namespace collision_node::geometry {

/// Vertices relative to an origin, as the nearest floats.
std::vector<FourFloats> imagesOf(const std::vector<Vec3>& vertices, const Vec3& origin);

class Elements {
 public:
  /// A coordinate x is off by kRounding |x| + kLeast at most, as double and as float, even when the sum of
  /// these is itself rounded.
  static constexpr float kRounding = 0x1.1p-24F, kLeast = 0x1p-126F;

  /// Triangles first, then the others.
  Elements(const std::vector<Vec3>& vertices, const std::vector<Triangle>& triangles,
           const std::vector<Bounds>& others);

  std::size_t size() const { return triangles_.size() + others_.size(); }
  const Vec3& origin() const { return origin_; }  ///< in the middle of all
  const RegisterBox& around() const { return around_; }
  RegisterBox box(std::size_t element) const {
    if (element >= triangles_.size()) return others_[element - triangles_.size()];
    const std::int32_t* const v = triangles_[element].v;
    const FourFloats &a = image(v[0]), &b = image(v[1]), &c = image(v[2]);
    return {smaller(smaller(a, b), c), larger(larger(a, b), c)};
  }

 private:
  const FourFloats& image(std::int32_t vertex) const { return images_[static_cast<std::size_t>(vertex)]; }

  const std::vector<Triangle>& triangles_;
  Vec3 origin_;
  std::vector<FourFloats> images_;  ///< of the vertices
  std::vector<RegisterBox> others_;
  RegisterBox around_ = RegisterBox::none();
};

}  // namespace collision_node::geometry

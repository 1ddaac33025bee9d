#include "collision_node/geometry/bvh_elements.h"

namespace collision_node::geometry {
namespace {

Vec3 middleOf(const std::vector<Vec3>& vertices, const std::vector<Bounds>& others) {
  Vec3 lower = vertices.empty() ? others.front().lower : vertices.front(), upper = lower;
  for (const Vec3& v : vertices) {
    lower = lower.cwiseMin(v);
    upper = upper.cwiseMax(v);
  }
  for (const Bounds& b : others) {
    lower = lower.cwiseMin(b.lower);
    upper = upper.cwiseMax(b.upper);
  }
  return 0.5 * lower + 0.5 * upper;
}

FourFloats imageOf(const Vec3& v, const Vec3& origin) {
  const Vec3 x = v - origin;
  return FourFloats{static_cast<float>(x[0]), static_cast<float>(x[1]), static_cast<float>(x[2]), 0.0F};
}

}  // namespace

std::vector<FourFloats> imagesOf(const std::vector<Vec3>& vertices, const Vec3& origin) {
  std::vector<FourFloats> images;
  images.reserve(vertices.size());
  for (const Vec3& v : vertices) images.push_back(imageOf(v, origin));
  return images;
}

Elements::Elements(const std::vector<Vec3>& vertices, const std::vector<Triangle>& triangles,
                   const std::vector<Bounds>& others)
    : triangles_(triangles), origin_(middleOf(vertices, others)), images_(imagesOf(vertices, origin_)) {
  others_.reserve(others.size());
  for (const Bounds& b : others) {
    others_.push_back({imageOf(b.lower, origin_), imageOf(b.upper, origin_)});
    around_.add(others_.back());
  }
  for (const FourFloats& image : images_) around_.add({image, image});
}

}  // namespace collision_node::geometry

/// Random shapes for the fuzz test.
#pragma once

#include <cmath>
#include <cstdint>
#include <random>
#include <string>

#include "collision_node/geometry/shape.h"

namespace fuzz {

/// Uniform numbers whose sequence does not depend on the standard library's distributions.
class Random {
 public:
  Random(std::uint64_t seed, int index) {
    std::seed_seq sequence{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32),
                           static_cast<std::uint32_t>(index)};
    engine_.seed(sequence);
  }
  double unit() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }
  double in(double lo, double hi) { return lo + (hi - lo) * unit(); }
  double decade(double lo, double hi) { return std::pow(10.0, in(lo, hi)); }
  int below(int n) { return static_cast<int>(unit() * n); }
  bool chance(double p) { return unit() < p; }
  collision_node::geometry::Vec3 direction();
  collision_node::geometry::Quat orientation();

 private:
  std::mt19937_64 engine_;
};

enum class ShapeKind { kPoint, kSphere, kBox, kCylinder, kCapsule, kClosedMesh, kOpenMesh, kConvex };
constexpr int kShapeKinds = 8;
const char* toString(ShapeKind kind);

/// A shape of about the given size [m]. `grid` > 0 rounds every length to its multiples, so that a shift by
/// such a multiple is exact in double.
collision_node::geometry::Shape makeShape(Random& random, ShapeKind kind, double scale, double grid);

/// A point that belongs to the shape, in its own frame.
collision_node::geometry::Vec3 pointOf(Random& random, const collision_node::geometry::Shape& shape);

}  // namespace fuzz

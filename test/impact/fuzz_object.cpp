#include "test/impact/fuzz_object.h"

#include <cmath>

#include "test/oracle/model.h"

namespace fuzz {

namespace g = collision_node::geometry;
using g::Vec3;

Object makeObject(Random& random, ShapeKind kind, double scale) {
  Object out;
  out.kind = toString(kind);
  const bool compound = random.chance(0.1) && kind != ShapeKind::kPoint;
  // Snapped lengths and shifts make the placed vertices exact, so that both sides see the same geometry.
  const double grid = compound ? std::ldexp(1.0, std::ilogb(scale) - 26) : 0.0;
  out.shapes.push_back({makeShape(random, kind, scale, grid), {}, out.kind});
  if (compound) {
    constexpr ShapeKind kPrimitives[] = {ShapeKind::kSphere, ShapeKind::kBox, ShapeKind::kCylinder,
                                         ShapeKind::kCapsule};
    const ShapeKind second = kPrimitives[random.below(4)];
    g::Pose origin;
    origin.position = (scale * random.in(0.5, 3) * random.direction() / grid).array().round().matrix() * grid;
    out.kind += std::string("+") + toString(second);
    out.shapes.push_back({makeShape(random, second, scale, grid), origin, toString(second)});
  }
  const g::PlacedShape& target = out.shapes[random.below(static_cast<int>(out.shapes.size()))];
  out.aim = target.origin * pointOf(random, target.shape);
  out.reach = static_cast<double>(oracle::makeModel(out.shapes).reach);
  return out;
}

}  // namespace fuzz

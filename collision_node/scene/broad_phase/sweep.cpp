#include "collision_node/scene/broad_phase/sweep.h"

#include <limits>

namespace collision_node::scene {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kDown = 1.0 - 0x1p-46;

}  // namespace

Bounds grown(const Bounds& box, double by) {
  Bounds out;
  for (int i = 0; i < 3; ++i) {
    out.lower[i] = std::nextafter(box.lower[i] - by, -kInfinity);
    out.upper[i] = std::nextafter(box.upper[i] + by, kInfinity);
  }
  return out;
}

double distanceBetween(const Bounds& a, const Bounds& b) {
  const Vec3 apart = (a.lower - b.upper).cwiseMax(b.lower - a.upper).cwiseMax(0.0);
  return apart.norm() * kDown;
}

}  // namespace collision_node::scene

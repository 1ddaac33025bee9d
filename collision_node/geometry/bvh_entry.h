/// What a Bvh is built from: boxes of floats, each with its element.
#pragma once

#include <cstdint>
#include <cstring>
#include <limits>

namespace collision_node::geometry {

typedef float FourFloats __attribute__((vector_size(16)));

/// A box of floats, one register a side; the last lanes are not looked at.
struct RegisterBox {
  static constexpr float kFar = std::numeric_limits<float>::infinity();
  FourFloats lower = {kFar, kFar, kFar, kFar};
  FourFloats upper = {-kFar, -kFar, -kFar, -kFar};

  void add(const RegisterBox& o) {
    lower = o.lower < lower ? o.lower : lower;
    upper = o.upper > upper ? o.upper : upper;
  }
  float halfArea() const {
    const float x = upper[0] - lower[0], y = upper[1] - lower[1], z = upper[2] - lower[2];
    return x * y + y * z + z * x;
  }
  float twiceCentre(int axis) const { return lower[axis] + upper[axis]; }
  int longestAxis() const {
    int axis = 0;
    for (int k = 1; k < 3; ++k) {
      if (upper[k] - lower[k] > upper[axis] - lower[axis]) axis = k;
    }
    return axis;
  }
};

/// An element's box, with its number in a lane that nobody looks at: two to a line of the cache.
struct alignas(32) Entry {
  RegisterBox box;

  void setElement(std::int32_t element) {
    float bits;
    std::memcpy(&bits, &element, sizeof bits);
    box.upper[3] = bits;
  }
  std::int32_t element() const {
    std::int32_t element;
    std::memcpy(&element, reinterpret_cast<const char*>(&box.upper) + 12, sizeof element);
    return element;
  }
};

}  // namespace collision_node::geometry

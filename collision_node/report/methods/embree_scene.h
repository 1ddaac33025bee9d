/// Triangles as an Embree scene, robust, in float. To be included only where Embree is there.
#pragma once

#include <embree3/rtcore.h>

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "collision_node/geometry/types.h"

namespace collision_node::report {

class EmbreeScene {
 public:
  EmbreeScene(const std::vector<geometry::Vec3>& vertices,
              const std::vector<std::array<std::int32_t, 3>>& triangles);
  ~EmbreeScene();
  EmbreeScene(const EmbreeScene&) = delete;
  EmbreeScene& operator=(const EmbreeScene&) = delete;

  /// The first hit on the straight way, as a share of it.
  std::optional<double> firstHit(const geometry::Vec3& from, const geometry::Vec3& way) const;

 private:
  RTCDevice device_;
  RTCScene scene_;
};

}  // namespace collision_node::report

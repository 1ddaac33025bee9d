/// What the tests of the certified solver share.
#pragma once

#include <gtest/gtest.h>

#include "test/impact/watched_pair.h"

namespace collision_node::impact {

using motion::RigidMotion;
using moving::flight;
using moving::holds;
using moving::kFrame;
using moving::kInAndOut;
using moving::resting;
using moving::Watched;
using Phase = PairState::Phase;

inline geometry::PlacedShape point() { return moving::placed(geometry::Point{}); }
inline geometry::PlacedShape sphere(double radius) { return moving::placed(geometry::Sphere{radius}); }
inline geometry::PlacedShape box(double size) { return moving::placed(geometry::Box{Vec3::Constant(size)}); }

}  // namespace collision_node::impact

#include "collision_node/impact/convex/core_pair.h"

#include <algorithm>

#include "collision_node/impact/convex/gjk.h"

namespace collision_node::impact {

using geometry::squareRoot;
using geometry::twice;
using geometry::withSignOf;

namespace {

const Vec3& farthest(const Element& hull, const Vec3& u) {
  return *std::max_element(hull.vertices, hull.vertices + hull.count,
                           [&u](const Vec3& p, const Vec3& q) { return u.dot(p) < u.dot(q); });
}

}  // namespace

/// A core that has axes of its own is placed as exactly as its corners are: within the placing error.
CorePair::CorePair(const Element& a, const Element& b)
    : rim_{a.rim_radius, b.rim_radius},
      reach_{coreReach(a), coreReach(b)},
      radius_(a.radius + b.radius),
      has_hull_(a.frame == nullptr || b.frame == nullptr),
      hull_{a.frame == nullptr ? &a : nullptr, b.frame == nullptr ? &b : nullptr} {
  static const geometry::CoreFrame kNone{Vec3::Zero(), Vec3::Zero(), 0.0, true, Mat3::Identity()};
  const geometry::CoreFrame &frame_a = hull_[0] ? kNone : *a.frame, &frame_b = hull_[1] ? kNone : *b.frame;
  centre_ = TwoVec3(frame_a.centre, frame_b.centre);
  half_ = TwoVec3(frame_a.half, frame_b.half);
  half_.z += Two{a.half_length, b.half_length};  // a cylinder's frame has none
  turned_ = !frame_a.aligned || !frame_b.aligned;
  if (turned_) axes_ = TwoMat3(frame_a.axes, frame_b.axes);
}

double CorePair::hullsAlong(const TwoVec3& u) const {
  double sum = 0.0;
  if (hull_[0] != nullptr) sum += u.a().dot(farthest(*hull_[0], u.a()));
  if (hull_[1] != nullptr) sum -= u.b().dot(farthest(*hull_[1], -u.b()));
  return sum;
}

CorePair::Trend CorePair::trend(const TwoVec3 (&u)[3], double at) const {
  const TwoVec3 there = u[0] + at * (u[1] + at * u[2]);
  const TwoVec3 corner(withSignOf(half_.x, there.x), withSignOf(half_.y, there.y),
                       withSignOf(half_.z, there.z));
  const Two across2 = u[0].x * u[0].x + u[0].y * u[0].y;
  // Along a cylinder's axis its rim tells nothing.
  const Two safe = across2 > 0.0 ? across2 : twice(1.0);
  const Two length = squareRoot(safe), per = across2 > 0.0 ? rim_ / length : twice(0.0);
  const Two turn = u[0].x * u[1].y - u[0].y * u[1].x;
  const Two value = dot(corner, u[0]) + per * across2;
  const Two rate = dot(corner, u[1]) + per * (u[0].x * u[1].x + u[0].y * u[1].y);
  const Two bend = dot(corner, u[2]) + per * (u[0].x * u[2].x + u[0].y * u[2].y + 0.5 * turn * turn / safe);
  Trend trend{value[0] + value[1], rate[0] + rate[1], bend[0] + bend[1]};
  if (has_hull_) addHulls(u, there, trend);
  return trend;
}

void CorePair::addHulls(const TwoVec3 (&u)[3], const TwoVec3& there, Trend& trend) const {
  if (hull_[0] != nullptr) {
    const Vec3& x = farthest(*hull_[0], there.a());
    trend.value += x.dot(u[0].a());
    trend.rate += x.dot(u[1].a());
    trend.bend += x.dot(u[2].a());
  }
  if (hull_[1] != nullptr) {
    const Vec3& x = farthest(*hull_[1], -there.b());
    trend.value -= x.dot(u[0].b());
    trend.rate -= x.dot(u[1].b());
    trend.bend -= x.dot(u[2].b());
  }
}

}  // namespace collision_node::impact

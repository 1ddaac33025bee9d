#include "collision_node/impact/walk/time_slabs.h"

#include <algorithm>
#include <cmath>

namespace collision_node::impact {
namespace {

constexpr std::size_t kMany = std::size_t{1} << 19;

void store(const Mat3& m, double to[3][4]) {
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) to[i][k] = m(i, k);
    to[i][3] = 0.0;
  }
}

void store(const Vec3& v, double to[4]) {
  for (int k = 0; k < 3; ++k) to[k] = v[k];
  to[3] = 0.0;
}

/// The view of points y + `far` (y from the other hierarchy's middle), relative to `near`.
void fill(SlabView& view, const Vec3& p0, const Vec3& p1, const Mat3& q0, const Mat3& q1, const Mat3& extent,
          const Vec3& near, const Vec3& far, double bend) {
  store(p0 + q0 * far - near, view.p0);
  store(p1 + q1 * far, view.p1);
  store(q0, view.q0);
  store(q1, view.q1);
  store(extent, view.extent);
  view.bend = bend;
}

}  // namespace

void TimeSlabs::start(double low, double high) {
  slabs_.clear();
  add(low, high);
}

std::int32_t TimeSlabs::add(double low, double high) {
  const RelativeMotion& m = piece_.motion;
  Slab s;
  s.middle = 0.5 * (low + high);
  s.half = std::max(high - s.middle, s.middle - low) * (1.0 + 4.0 * kUnit);
  const Instant now = piece_.at(s.middle);
  const Vec3 &wa = m.omegaA(), &wb = m.omegaB();
  const Vec3 turn = wb - wa;
  s.turn = turn.norm() * kUp;
  const Mat3 back_a = now.ra.transpose(), q0 = back_a * now.rb;
  Mat3 q1;
  for (int k = 0; k < 3; ++k) q1.col(k) = back_a * turn.cross(now.rb.col(k));

  // |x''| <= |d'' - 2 w x d' + w x (w x d)| + (|O|^2 + |wa x wb|) |y|, the first at the middle plus its
  // growth.
  const Vec3 bend = m.acceleration(s.middle);
  const double bend_sup = bend.norm() + s.half * m.jerk();
  const double speed_sup = now.d_rate.norm() + s.half * bend_sup;
  const auto pathBend = [&](const Vec3& w, double spin) {
    const Vec3 g = bend - 2.0 * w.cross(now.d_rate) + w.cross(w.cross(now.d));
    return (g.norm() + s.half * (m.jerk() + 2.0 * spin * bend_sup + spin * spin * speed_sup)) * kUp;
  };
  s.bend_q = (s.turn * s.turn + wa.cross(wb).norm()) * kUp;
  Mat3 extent =
      (q0.cwiseAbs() + s.half * q1.cwiseAbs()).array() + (0.5 * s.half * s.half * s.bend_q + 64.0 * kUnit);
  extent = extent.cwiseMin(1.0 + 64.0 * kUnit);

  const Vec3 &middle_a = piece_.a.bvh().origin(), &middle_b = piece_.b.bvh().origin();
  fill(s.in_a, back_a * now.d, back_a * (now.d_rate - wa.cross(now.d)), q0, q1, extent, middle_a, middle_b,
       pathBend(wa, m.spinA()));
  fill(s.in_b, -(now.rb.transpose() * now.d), -(now.rb.transpose() * (now.d_rate - wb.cross(now.d))),
       q0.transpose(), q1.transpose(), extent.transpose(), middle_b, middle_a, pathBend(wb, m.spinB()));
  slabs_.push_back(s);
  are_many_ = are_many_ || slabs_.size() >= kMany;
  return static_cast<std::int32_t>(slabs_.size()) - 1;
}

std::int32_t TimeSlabs::childOf(std::int32_t slab, bool late) {
  if (slabs_[slab].child[late] < 0) {
    const double middle = slabs_[slab].middle, half = slabs_[slab].half;
    const std::int32_t child = late ? add(middle, middle + half) : add(middle - half, middle);
    slabs_[slab].child[late] = child;
    ++subdivisions_;
  }
  return slabs_[slab].child[late];
}

}  // namespace collision_node::impact

#include "collision_node/impact/convex/near_support.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace collision_node::impact {

NearSupport::NearSupport(const PosedCore& core, const Vec3& up)
    : centre_(core.place(core.element->frame->centre)),
      round_(core.element->vertices == nullptr),
      leans_(true) {
  constexpr double kAlong = 1e-9;  // with less, rounding may have made the side that leans towards up
  const Element& e = *core.element;
  axes_ = e.frame->aligned ? *core.rotation : Mat3(*core.rotation * e.frame->axes);
  if (round_) {
    const Vec3 axis = axes_.col(2);
    Vec3 side = up - up.dot(axis) * axis;
    side -= side.dot(axis) * axis;
    const double radial = side.norm();
    leans_ = radial > kAlong;
    axes_.col(0) = leans_ ? Vec3(side / radial) : axis.unitOrthogonal();
    axes_.col(1) = axis.cross(axes_.col(0));
    slope_ = Vec3(radial, 0.0, up.dot(axis));
    half_ = Vec3(e.rim_radius, 0.0, e.half_length);
  } else {
    slope_ = axes_.transpose() * up;
    half_ = e.frame->half;
  }
  for (int k = 0; k < 3; ++k) {
    if (slope_[k] < 0.0) axes_.col(k) = -axes_.col(k);
  }
  slope_ = slope_.cwiseAbs();
  top_ = up.dot(centre_) + slope_.dot(half_);
}

/// The depth is the sum of what each axis adds.
NearSupport::Cap NearSupport::cap(double depth, double tilt) const {
  Cap cap;
  for (int k = 0; k < 3; ++k)
    cap.reach[k] = 2.0 * slope_[k] * half_[k] > depth ? 0.5 * depth / slope_[k] : half_[k];
  if (round_) {
    const double r = half_[0];
    if (!leans_) cap.reach[0] = r;
    const double low = r - 2.0 * cap.reach[0];
    double across = low > 0.0 ? std::sqrt((r - low) * (r + low)) : r;
    // The support's place on the rim turns with the normal as the cylinder sees it.
    if (leans_ && tilt < 0.5 * slope_[0]) across = std::min(across, r * 2.0 * tilt / slope_[0]);
    cap.reach[1] = across;
  }
  Vec3 inward = half_ - cap.reach;
  if (round_) inward[1] = 0.0;
  cap.centre = centre_ + axes_ * inward;
  return cap;
}

Strip NearSupport::strip(const Cap& cap, const Vec3& n, const Vec3& e1, const Vec3& e2) const {
  int along = 0;
  cap.reach.maxCoeff(&along);
  const Vec3 across = n.cross(axes_.col(along));
  const double length = across.norm();
  Strip s;
  s.length2 = 4.0 * cap.reach[along] * cap.reach[along] * length * length;
  if (!(length > 0.0)) return s;
  const Vec3 unit = across / length;
  const double middle = unit.dot(cap.centre);
  double half = 0.0;
  for (int k = 0; k < 3; ++k) half += std::abs(unit.dot(axes_.col(k))) * cap.reach[k];
  s.across = {unit.dot(e1), unit.dot(e2)};
  s.low = middle - half;
  s.high = middle + half;
  return s;
}

int NearSupport::flatness(double depth) const {
  int flat = 0;
  for (int k = 0; k < 3; ++k) flat += half_[k] > 0.0 && 2.0 * slope_[k] * half_[k] <= depth;
  return flat;
}

Feature NearSupport::feature(double depth) const {
  if (round_) return slope_[2] > 1.0 - 1e-12 ? Feature::kFace : Feature::kSmooth;
  const int flat = flatness(depth);
  return flat == 0 ? Feature::kVertex : flat == 1 ? Feature::kEdge : Feature::kFace;
}

Vec3 NearSupport::stand(const Vec3& near, double level, Ways& ways) const {
  Vec3 at = half_;
  const Vec3 seen = axes_.transpose() * (near - centre_);
  const auto isFlat = [&](int k) { return half_[k] > 0.0 && 2.0 * slope_[k] * half_[k] <= level; };
  for (int k = round_ ? 2 : 0; k < 3; ++k) {
    if (!isFlat(k)) continue;
    at[k] = std::clamp(seen[k], -half_[k], half_[k]);
    const double reach = half_[k] - std::abs(at[k]);
    ways.depth += slope_[k] * (half_[k] - at[k]);
    ways.add({axes_.col(k), reach, slope_[k] * reach});
  }
  if (round_) {
    const double r = half_[0];
    if (isFlat(0) || !leans_) {  // an end; also where rounding hides which of its sides is higher
      const double from_axis = std::sqrt(seen[0] * seen[0] + seen[1] * seen[1]);
      const double share = from_axis > r ? r / from_axis : 1.0;
      at[0] = share * seen[0];
      at[1] = share * seen[1];
      ways.depth += 2.0 * slope_[0] * r;
      ways.add({axes_.col(2), r - share * from_axis, 0.0, 0.0, true});
    } else {  // a side or a rim: by an angle about the axis with the cosine 1 - part
      const double part = std::min(1.0, level / (r * slope_[0]));
      ways.add(
          {axes_.col(1), r * std::sqrt(part * (2.0 - part)), r * slope_[0] * part, r * part * slope_[2]});
    }
  }
  return centre_ + axes_ * at;
}

std::optional<double> NearPair::normalCone(double moved, const Vec3& near_a, const Vec3& near_b,
                                           bool forward) const {
  constexpr double kLeastThickness = 4.0, kMost = 0.5;
  const int flat_a = a_.flatness(moved), flat_b = b_.flatness(moved);
  if (flat_a + flat_b > 2) return std::nullopt;
  // The sharper one tells where the other is met.
  NearSupport::Ways ways;
  Vec3 w;
  if (flat_a <= flat_b) {
    const Vec3 x = a_.stand(near_a, moved, ways);
    w = b_.stand(x, moved, ways) - x;
  } else {
    const Vec3 x = b_.stand(near_b, moved, ways);
    w = x - a_.stand(x, moved, ways);
  }
  const double beside = (w - n_ * n_.dot(w)).norm();
  double sine = std::numeric_limits<double>::infinity();
  const auto offer = [&](double reach, double height) {
    if (reach > 0.0) sine = std::min(sine, (moved + ways.depth + height) / reach);
  };
  for (int i = 0; i < ways.count; ++i) {
    const NearSupport::Way& p = ways.way[i];
    if (p.all) offer(p.reach * std::abs(n_.dot(p.direction)) - beside, p.height);
    for (int j = 0; j < i; ++j) {
      const NearSupport::Way& q = ways.way[j];
      if (p.all || q.all) continue;
      const double turn = std::abs(n_.dot(p.direction.cross(q.direction)));
      offer(std::min(p.reach, q.reach) * turn - beside - p.bend - q.bend, p.height + q.height);
    }
  }
  if (!(sine < kMost)) return std::nullopt;
  // A normal that leans by more than a right angle has everything behind it.
  const double size = a_.size() + b_.size() + beside;
  if (!forward && !(a_.thickness() + b_.thickness() > kLeastThickness * (moved + sine * size)))
    return std::nullopt;
  return angleOf(sine) * (1.0 + 64.0 * kUnit);
}

bool NearPair::commonDisc(double depth, double tilt_a, double tilt_b, double moved_a, double moved_b,
                          Vec3* place, double* radius) const {
  constexpr double kPoint = 8.0, kThin = 1e-6, kWide = 20.0;
  const NearSupport::Cap a = a_.cap(depth, tilt_a), b = b_.cap(depth, tilt_b);
  const double radius_a = a.radius() + moved_a, radius_b = b.radius() + moved_b;
  const bool a_is_less = radius_a <= radius_b;
  *radius = std::min(radius_a, radius_b);
  *place = a_is_less ? a.centre : b.centre;
  if (!(a.radius() <= kPoint * moved_a || b.radius() <= kPoint * moved_b)) {
    const Vec3 e1 = n_.unitOrthogonal(), e2 = n_.cross(e1);
    const Strip line_a = a_.strip(a, n_, e1, e2), line_b = b_.strip(b, n_, e1, e2);
    const auto isThin = [](const Strip& s) {
      return (s.high - s.low) * (s.high - s.low) < kThin * s.length2;
    };
    const bool thin_a = isThin(line_a), thin_b = isThin(line_b);
    Vec2 centre;
    double both = 0.0;
    if (thin_a && thin_b && crossing(line_a, moved_a, line_b, moved_b, &centre, &both)) {
      if (both < *radius) {
        *place = centre.x() * e1 + centre.y() * e2;
        *radius = both;
      }
    } else if ((a_is_less ? thin_b : thin_a) || !(std::max(radius_a, radius_b) > kWide * *radius)) {
      return false;  // what they have in common may be less
    }
  }
  *place += n_ * (a_.top() - n_.dot(*place));
  return true;
}

}  // namespace collision_node::impact

#include "collision_node/impact/convex/closest_points.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "collision_node/geometry/any_width.h"
#include "collision_node/geometry/two_vectors.h"
#include "collision_node/impact/convex/sliding_features.h"

namespace collision_node::impact {
namespace {

bool isSegment(const Element& e) { return e.vertices != nullptr && e.count <= 2; }

}  // namespace

ClampingCore::ClampingCore(const Element& e)
    : frame(*e.frame),
      round(e.vertices == nullptr),
      half(round ? Vec3(e.rim_radius, e.rim_radius, e.half_length) : frame.half) {}

ClampingCore::Seen ClampingCore::see(const Vec3& x, const Vec3& edge) const {
  // By masks, as nobody could foretell branches.
  using geometry::Two;
  using geometry::TwoBits;
  const auto where = [](TwoBits on, Two v) { return (Two)((TwoBits)v & on); };
  const auto beyond = [&](Two from, Two most) { return geometry::magnitude(from) - most; };
  const Two along{x[2], 0.0}, edge_z{edge[2], 0.0}, over_z = beyond(along, Two{half[2], 0.0});
  const TwoBits on_z = over_z > 0.0;
  const Two across{x[0], x[1]}, edge_xy{edge[0], edge[1]};
  Two offset, bend = where(on_z, edge_z * edge_z);
  if (!round) {
    const Two over = beyond(across, Two{half[0], half[1]});
    const TwoBits on = over > 0.0;
    offset = geometry::withSignOf(where(on, over), across);
    bend += where(on, edge_xy * edge_xy);
  } else {
    const Two square = across * across, radial = edge_xy * across, edge2 = edge_xy * edge_xy;
    const double distance2 = square[0] + square[1], turn = radial[0] + radial[1];
    const double inner = distance2 > half[0] * half[0] ? half[0] / std::sqrt(distance2) : 1.0;
    offset = (1.0 - inner) * across;
    bend += (1.0 - inner) * edge2;
    bend[0] += inner < 1.0 ? inner * turn * turn / distance2 : 0.0;
  }
  const Two offset_z = geometry::withSignOf(where(on_z, over_z), along);
  return {{offset[0], offset[1], offset_z[0]}, bend[0] + bend[1]};
}

ClampingCore::Stretch ClampingCore::stretch(const Vec3& x) const {
  const auto on = [&](int k) { return std::abs(x[k]) > half[k] ? 1.0 : 0.0; };
  if (!round) return {{on(0), on(1), on(2)}, 0.0, 0.0, 0.0};
  const double distance2 = x[0] * x[0] + x[1] * x[1];
  if (!(distance2 > half[0] * half[0])) return {{0.0, 0.0, on(2)}, 0.0, 0.0, 0.0};
  const double around = 1.0 - half[0] / std::sqrt(distance2);
  return {{around, around, on(2)}, x[0], x[1], (1.0 - around) / distance2};
}

/// Newton's method on half the derivative of the squared distance, which grows along the edge; halving where
/// it leaves what is known to hold the root. Of an edge that grazes a curved side the root is threefold, and
/// each step two thirds of the one before: three of them are one.
double ClampingCore::nearestShare(const Vec3& x, const Vec3& edge, double guess) const {
  constexpr int kMost = 64;
  constexpr double kClose = 1e-10;  // another step of Newton squares it
  double low = -1.0, high = 2.0, share = std::clamp(guess, 0.0, 1.0), before = 0.0;
  for (int i = 0; i < kMost; ++i) {
    const Seen seen = see(x + share * edge, edge);
    const double slope = seen.offset.dot(edge);
    high = slope > 0.0 ? share : high;
    low = slope > 0.0 ? low : share;
    if (slope == 0.0 || high <= 0.0 || low >= 1.0) return share;
    const double step = seen.bend > 0.0 ? -slope / seen.bend : 0.0;
    const bool grazes =
        round && step * before > 0.0 && std::abs(3.0 * step - 2.0 * before) < 0.2 * std::abs(before);
    before = step;
    double next = std::clamp(share + (grazes ? 3.0 * step : step), 0.0, 1.0);
    if (std::abs(next - share) <= kClose) return next;
    if (!(next > low && next < high)) next = 0.5 * (std::max(low, 0.0) + std::min(high, 1.0));
    share = next;
  }
  return share;
}

bool SlidingPoints::fit(const Element& a, const Element& b) {
  return a.frame != nullptr && b.frame != nullptr && (isSegment(a) || isSegment(b));
}

SlidingPoints::SlidingPoints(const Element& a, const Element& b, bool curve_is_a)
    : a_(a), b_(b), curve_is_a_(curve_is_a), solid_(curve_is_a ? b : a) {}

SlidingPoints::SlidingPoints(const Element& a, const Element& b)
    : SlidingPoints(a, b, isSegment(a) && !(isSegment(b) && b.count < a.count)) {}

COLLISION_NODE_ANY_WIDTH COLLISION_NODE_WITH_CALLS void SlidingPoints::find(const Cores& cores) {
  const PosedCore &segment = curve_is_a_ ? cores.a : cores.b, &solid = curve_is_a_ ? cores.b : cores.a;
  frame_ = solid_.frame.aligned ? *solid.rotation : Mat3(*solid.rotation * solid_.frame.axes);
  const Vec3* const ends = segment.element->vertices;
  place_ = segment.place(ends[0]);
  x_ = frame_.transpose() * (place_ - solid.place(solid_.frame.centre));
  if (segment.element->count == 2) {
    edge_w_ = *segment.rotation * (ends[1] - ends[0]);
    edge_ = frame_.transpose() * edge_w_;
    const double length2 = edge_.squaredNorm();
    if (share_ == 0.0 && length2 > 0.0) share_ = -x_.dot(edge_) / length2;
    share_ = solid_.nearestShare(x_, edge_, share_);
    x_ += share_ * edge_;
    place_ += share_ * edge_w_;
  }
  offset_ = solid_.see(x_, edge_).offset;
  distance_ = offset_.norm();
  slides_ = share_ > 0.0 && share_ < 1.0;
}

/// Newton's method on the derivative of half the squared distance round the rim.
COLLISION_NODE_ANY_WIDTH COLLISION_NODE_WITH_CALLS bool SlidingPoints::findOnRim(const Cores& cores,
                                                                                 const Vec3& direction) {
  const PosedCore &rim = curve_is_a_ ? cores.a : cores.b, &solid = curve_is_a_ ? cores.b : cores.a;
  const Element& e = *rim.element;
  const Mat3 own = *rim.rotation * e.frame->axes;
  const Vec3 out = own.transpose() * (curve_is_a_ ? direction : Vec3(-direction));
  double cosine = out.x(), sine = out.y(), length = std::sqrt(cosine * cosine + sine * sine);
  // Near a side or an end of the cylinder another feature may hold the closest points.
  constexpr double kSharp = 1e-3;
  if (!(length > kSharp * std::abs(out.z()) && std::abs(out.z()) > kSharp * length)) return false;
  frame_ = solid_.frame.aligned ? *solid.rotation : Mat3(*solid.rotation * solid_.frame.axes);
  const double end = std::copysign(e.half_length, out.z());
  const Vec3 middle = rim.place(e.centre + end * e.frame->axes.col(2));
  const Vec3 centre = frame_.transpose() * (middle - solid.place(solid_.frame.centre));
  const Vec3 first = frame_.transpose() * own.col(0) * e.rim_radius,
             second = frame_.transpose() * own.col(1) * e.rim_radius;
  slides_ = true;
  constexpr int kMost = 8;
  constexpr double kClose = 1e-12, kFar = 0.5;
  for (int i = 0; i < kMost; ++i) {
    cosine /= length;
    sine /= length;
    const Vec3 arm = cosine * first + sine * second;
    x_ = centre + arm;
    edge_ = cosine * second - sine * first;
    const ClampingCore::Seen seen = solid_.see(x_, edge_);
    offset_ = seen.offset;
    if (offset_.isZero(0.0)) {  // inside
      distance_ = 0.0;
      on_rim_ = e.centre + e.frame->axes * Vec3(e.rim_radius * cosine, e.rim_radius * sine, end);
      return true;
    }
    curving_ = -offset_.dot(arm);
    const double bend = seen.bend + curving_, slope = offset_.dot(edge_);
    if (!(bend > 0.0) || !(std::abs(slope) < kFar * bend)) return false;
    const double step = -slope / bend;
    if (std::abs(step) < kClose) {
      distance_ = offset_.norm();
      place_ = middle + frame_ * arm;
      edge_w_ = frame_ * edge_;
      on_rim_ = e.centre + e.frame->axes * Vec3(e.rim_radius * cosine, e.rim_radius * sine, end);
      return distance_ > 0.0;
    }
    const double turned = cosine - step * sine;
    sine += step * cosine;
    cosine = turned;
    length = std::sqrt(cosine * cosine + sine * sine);
  }
  return false;
}

bool SlidingPoints::atCorner() const {
  return !solid_.round && (offset_.array() != 0.0 || solid_.half.array() == 0.0).all();
}

bool SlidingPoints::onFace(double margin) const {
  int beyond = 0, inside = 0;
  for (int k = solid_.round ? 2 : 0; k < 3; ++k) {
    beyond += std::abs(x_[k]) - solid_.half[k] > margin;
    inside += std::abs(x_[k]) - solid_.half[k] < -margin;
  }
  if (!solid_.round) return beyond == 1 && inside == 2;
  const double within = solid_.half[0] - margin;
  return beyond == 1 && within > 0.0 && x_[0] * x_[0] + x_[1] * x_[1] < within * within;
}

COLLISION_NODE_ANY_WIDTH
Closest SlidingPoints::closest(const Cores& cores) const {
  const Element &curve = curve_is_a_ ? a_ : b_, &solid = curve_is_a_ ? b_ : a_;
  const PosedCore& placed = curve_is_a_ ? cores.b : cores.a;
  // The solid's point, in its object's frame. Corners are taken as they are stored: facts look for them.
  Vec3 nearest = x_ - offset_;
  if (solid_.shrunk == 0.0 && atCorner()) {
    const int bits = (nearest.x() > 0.0 ? 1 : 0) | (nearest.y() > 0.0 ? 2 : 0) | (nearest.z() > 0.0 ? 4 : 0);
    nearest = solid.vertices[solid.count == 8 ? bits : solid.count == 2 ? bits >> 2 : 0];
  } else {
    nearest = solid_.frame.centre + solid_.frame.axes * nearest;
  }
  Closest c;
  const bool on_rim = curve.vertices == nullptr, at_end = !slides_ || on_rim;
  c.count = at_end ? 1 : 2;
  c.v = outward();
  const Vec3 on_solid = placed.place(nearest);
  const PosedCore& other = curve_is_a_ ? cores.a : cores.b;
  for (int i = 0; i < c.count; ++i) {
    const Vec3& x = on_rim ? on_rim_ : curve.vertices[at_end ? (share_ == 1.0 ? 1 : 0) : i];
    const Vec3 w = on_solid - other.place(x);
    c.point[i] = curve_is_a_ ? SupportPair{w, x, nearest} : SupportPair{-w, nearest, x};
    c.weight[i] = at_end ? 1.0 : i == 0 ? 1.0 - share_ : share_;
  }
  c.overlap = distance_ == 0.0;
  if (!slides_ && !c.overlap) {
    // How far the rest of the segment lies beyond the closest point.
    const double beyond = std::abs(offset_.dot(edge_)) / distance_;
    c.sure = curve.count == 1 ? std::numeric_limits<double>::infinity() : beyond;
  }
  return c;
}

/// In the solid's own turning axes, with M the derivative of the offset o, e the curve's derivative and x'
/// the velocity of its closest point, were it fixed on the curve: o' = M (x' + e s'), and s' keeps o . e = 0.
COLLISION_NODE_ANY_WIDTH COLLISION_NODE_WITH_CALLS Axis SlidingPoints::axis(const RelativeMotion& m,
                                                                            const Instant& now) const {
  Axis axis;
  if (!(distance_ > 0.0)) return axis;
  const double outward = curve_is_a_ ? -1.0 : 1.0;  // from the solid to the segment, or back
  const Vec3 &omega = curve_is_a_ ? m.omegaB() : m.omegaA(),
             &other_omega = curve_is_a_ ? m.omegaA() : m.omegaB();
  // The curve's point from both objects' origins.
  const Vec3 from_b = place_ - now.d, &arm = curve_is_a_ ? place_ : from_b,
             &other = curve_is_a_ ? from_b : place_;
  const Vec3 v = frame_.transpose() * (outward * now.d_rate + other_omega.cross(arm) - omega.cross(other));
  const ClampingCore::Stretch stretch = solid_.stretch(x_);
  const Vec3 n = acrossCurve();
  Vec3 rate = stretch * v;
  if (slides_) {
    const double length2 = edge_.squaredNorm();
    const Vec3 stretched = stretch * edge_;
    const double bend = edge_.dot(stretched) + curving_;
    if (bend > 1e-12 * length2) {
      const Vec3 edge_rate = frame_.transpose() * (other_omega - omega).cross(edge_w_);
      rate -= stretched * ((offset_.dot(edge_rate) + edge_.dot(rate)) / bend);
    }
  }
  rate = (rate - n * n.dot(rate)) / distance_;
  axis.direction = outward * (frame_ * n);
  axis.rate = omega.cross(axis.direction) + outward * (frame_ * rate);
  axis.valid = true;
  return axis;
}

int edgeOf(const Element& e, const Closest& closest, bool of_a, Vec3 (&ends)[2]) {
  int count = 0;
  for (int i = 0; i < closest.count; ++i) {
    const Vec3& x = of_a ? closest.point[i].local_a : closest.point[i].local_b;
    const auto isIt = [&x](const Vec3& v) { return (v - x).cwiseAbs().sum() == 0.0; };
    if (std::any_of(ends, ends + count, isIt)) continue;
    // Points found on a rim are opposite to any point.
    if (count == 2 || std::none_of(e.vertices, e.vertices + e.count, isIt)) return 0;
    ends[count++] = x;
  }
  return count;
}

Closest closestOnEdges(const Cores& cores, const Closest& hint) {
  const bool cylinder_is_a = cores.a.element->vertices == nullptr;
  const PosedCore &cylinder = cylinder_is_a ? cores.a : cores.b, &other = cylinder_is_a ? cores.b : cores.a;
  Closest best;
  if (cylinder.element->vertices != nullptr || other.element->vertices == nullptr) return best;
  const ClampingCore solid(*cylinder.element);
  const Vec3 centre = cylinder.place(solid.frame.centre);
  const Mat3 frame = *cylinder.rotation * solid.frame.axes;
  Vec3 corner[4], seen[4];  // in the other's frame, and from the cylinder's centre in its own axes
  int count = 0;
  for (int i = 0; i < hint.count; ++i) {
    const Vec3& x = cylinder_is_a ? hint.point[i].local_b : hint.point[i].local_a;
    if (std::find(corner, corner + count, x) != corner + count) continue;
    corner[count] = x;
    seen[count++] = frame.transpose() * (other.place(x) - centre);
  }
  double nearest = std::numeric_limits<double>::infinity();
  const auto offer = [&](int i, int j, double share) {
    const Vec3 edge = seen[j] - seen[i], x = seen[i] + share * edge;
    const Vec3 offset = solid.see(x, edge).offset, p = solid.frame.centre + solid.frame.axes * (x - offset);
    const double distance = offset.norm();
    if (!(distance < nearest)) return;
    nearest = distance;
    best.count = i == j ? 1 : 2;
    const int ends[2] = {i, j};
    for (int k = 0; k < best.count; ++k) {
      const Vec3 from = seen[ends[k]] - (x - offset);
      const Vec3 w = frame * (cylinder_is_a ? from : Vec3(-from));
      best.point[k] = {w, cylinder_is_a ? p : corner[ends[k]], cylinder_is_a ? corner[ends[k]] : p};
      best.weight[k] = best.count == 1 ? 1.0 : k == 0 ? 1.0 - share : share;
    }
    best.v = frame * (cylinder_is_a ? offset : Vec3(-offset));
  };
  for (int i = 0; i < count; ++i) {
    offer(i, i, 0.0);
    for (int j = 0; j < i; ++j) offer(i, j, solid.nearestShare(seen[i], seen[j] - seen[i], 0.5));
  }
  best.overlap = best.count > 0 && best.v.isZero(0.0);
  return best;
}

}  // namespace collision_node::impact

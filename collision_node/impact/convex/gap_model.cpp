#include "collision_node/impact/convex/gap_model.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "collision_node/geometry/any_width.h"
#include "collision_node/impact/convex/closest_points.h"

namespace collision_node::impact {
/// The bodies see the axis turn; what is left of it beyond the second order is at most s^3 (cubic + s
/// quartic) for the cores' points together.
GapModel::GapModel(const PairPiece& piece, const Instant& now, const CorePair& cores, const Axis& axis)
    : cores_(cores), direction_(axis.direction), rate_(axis.rate) {
  see(piece, now);
}

COLLISION_NODE_ANY_WIDTH
void GapModel::see(const PairPiece& piece, const Instant& now) {
  const CorePair& cores = cores_;
  const RelativeMotion& m = piece.motion;
  const TwoMat3 rotation(now.ra, now.rb);
  const TwoVec3 direction(direction_), rate(rate_), omega(m.omegaA(), m.omegaB());
  const TwoVec3 turning = cross(omega, direction);
  seen_[0] = rotation.backwards(direction);
  seen_[1] = rotation.backwards(rate - turning);
  seen_[2] = rotation.backwards(cross(omega, 0.5 * turning - rate));
  length_ = direction_.norm() * kUp;
  rate_length_ = rate_.norm() * kUp;
  grown_ = cores.radius() + piece.contact_distance;
  level_[0] = direction_.dot(now.d) - cores.centresAlong(seen_[0]);
  level_[1] = rate_.dot(now.d) + direction_.dot(now.d_rate) - cores.centresAlong(seen_[1]);
  level_[2] = rate_.dot(now.d_rate) - cores.centresAlong(seen_[2]);
  for (TwoVec3& u : seen_) u = cores.own(u);
  const Two spin{m.spinA(), m.spinB()}, share = spin * spin * cores.reach() * (kUp / 6.0);
  const Two third = share * norm(3.0 * rate - turning), fourth = share * spin;
  cubic_ = third[0] + third[1];
  quartic_ = (fourth[0] + fourth[1]) * rate_length_;
  if (m.maxAcceleration() > 0.0) {
    const Vec3 acceleration = m.acceleration(now.t);
    level_[2] += 0.5 * direction_.dot(acceleration);
    cubic_ += (0.5 * rate_length_ * acceleration.norm() + length_ * m.jerk() / 6.0) * kUp;
    quartic_ += rate_length_ * m.jerk() * (kUp / 6.0);
  }
  point_error_ = piece.point_error;
  rate_error_ = piece.rate_error;
  first_ = level_[0] - cores.reachAlong(seen_[0]) - length_ * (grown_ + point_error_);
}

/// At the control points of the seen axis over [0, end].
GapModel::Bounds GapModel::until(double end) const {
  const double half = 0.5 * end, reach = length_ + end * rate_length_;
  const TwoVec3 middle = seen_[0] + half * seen_[1], last = seen_[0] + end * (seen_[1] + end * seen_[2]);
  const Two grown = grown_ * norm(TwoVec3(direction_) + Two{half, end} * TwoVec3(rate_));
  Bounds bounds;
  bounds.first = first_;
  bounds.middle = (level_[0] + half * level_[1]) - cores_.reachAlong(middle) - grown[0] -
                  reach * (point_error_ + half * rate_error_);
  bounds.last = (level_[0] + end * (level_[1] + end * level_[2])) - cores_.reachAlong(last) - grown[1] -
                end * end * end * (cubic_ + end * quartic_) - reach * (point_error_ + end * rate_error_);
  return bounds;
}

GapModel::Trend GapModel::trend(double span) const {
  const double speed = std::abs(level_[1]);  // about, of approach
  const CorePair::Trend cores = cores_.trend(seen_, first_ < span * speed ? first_ / speed : span);
  const double along = direction_.dot(rate_) / length_;
  Trend t;
  // Features of the end lie no farther out now than those of now do, but for rounding.
  t.first = std::max(first_, level_[0] - cores.value - length_ * (grown_ + point_error_));
  t.slope = level_[1] - cores.rate - grown_ * along - rate_length_ * point_error_ - length_ * rate_error_;
  t.bend = level_[2] - cores.bend - 0.5 * grown_ * (rate_length_ * rate_length_ - along * along) / length_ -
           rate_length_ * rate_error_;
  t.cubic = cubic_;
  t.quartic = quartic_;
  return t;
}

double GapModel::Trend::root(double span) const {
  double s = span;
  const double discriminant = slope * slope - 4.0 * bend * first;
  if (discriminant >= 0.0) {
    const double root = slope < 0.0 ? 2.0 * first / (std::sqrt(discriminant) - slope)
                                    : (slope + std::sqrt(discriminant)) / (-2.0 * bend);
    if (root > 0.0 && root < s) s = root;
  }
  constexpr int kMost = 24;
  constexpr double kClose = 1e-3;  // the next step squares it
  for (int i = 0; i < kMost; ++i) {
    const double value = at(s), rate = slopeAt(s);
    if (!(value < 0.0)) return s;
    const double next = rate < 0.0 ? s - value / rate : 0.0;
    if (!(next > 0.0)) {
      s *= 0.5;
      continue;
    }
    if (s - next < kClose * s) return next;
    s = next;
  }
  return s;
}

Axis axisOf(const PairPiece& piece, const Instant& now, const Closest& closest, bool rounded) {
  Axis axis;
  if (closest.overlap) return axis;
  const RelativeMotion& m = piece.motion;
  Vec3 rate[4];
  for (int i = 0; i < closest.count; ++i) {
    rate[i] = now.d_rate + m.omegaB().cross(now.rb * closest.point[i].local_b) -
              m.omegaA().cross(now.ra * closest.point[i].local_a);
  }
  const double gap = closest.v.norm();
  if (closest.count == 3) {
    // The normal of the three difference points: exact however small the gap is.
    const Vec3 e1 = closest.point[1].w - closest.point[0].w, e2 = closest.point[2].w - closest.point[0].w;
    const Vec3 f1 = rate[1] - rate[0], f2 = rate[2] - rate[0];
    Vec3 n = e1.cross(e2);
    Vec3 n_rate = f1.cross(e2) + e1.cross(f2);
    const double length = n.norm();
    if (length > 1e-13 * e1.norm() * e2.norm()) {
      if (n.dot(closest.v) < 0.0) {
        n = -n;
        n_rate = -n_rate;
      }
      axis.direction = n / length;
      axis.rate = (n_rate - axis.direction * axis.direction.dot(n_rate)) / length;
      axis.valid = true;
      return axis;
    }
  }
  if (!(gap > 0.0)) return axis;
  axis.direction = closest.v / gap;
  axis.valid = true;
  if (closest.count == 2) {
    // Stay perpendicular to the segment between the two points.
    const Vec3 e = closest.point[1].w - closest.point[0].w;
    const double length2 = e.squaredNorm();
    // What rounding left along it would cost its whole length, which may be many times the gap.
    axis.direction -= e * (e.dot(axis.direction) / length2);
    const Vec3 along = e * (-axis.direction.dot(rate[1] - rate[0]) / length2);
    axis.rate = along;
    if (rounded) {
      Vec3 v_rate = closest.weight[0] * rate[0] + closest.weight[1] * rate[1];
      v_rate -= axis.direction * axis.direction.dot(v_rate);
      v_rate -= e * (e.dot(v_rate) / length2);
      axis.rate += v_rate / gap;
    }
  } else if (closest.count == 1 && rounded) {
    axis.rate = (rate[0] - axis.direction * axis.direction.dot(rate[0])) / gap;
  }
  return axis;
}

namespace {

/// Normals made unit, with their rates kept across them. Between cores that are apart every point of B lies
/// beyond every point of A, so any two of them tell which of the two directions can have a gap.
class AxisList {
 public:
  AxisList(const Instant& now, const Element& a, const Element& b)
      : across_(now.d + now.rb * anyPoint(b) - now.ra * anyPoint(a)) {}

  void add(const Vec3& n, const Vec3& n_rate, double scale) {
    const double length = n.norm();
    if (!(length > 1e-14 * scale)) return;
    const double sign = n.dot(across_) < 0.0 ? -1.0 : 1.0;
    Axis axis;
    axis.direction = n * (sign / length);
    axis.rate = (n_rate - n * (n.dot(n_rate) / (length * length))) * (sign / length);
    axis.valid = true;
    axes_.push_back(axis);
  }

  const Axes& all() const { return axes_; }

 private:
  static const Vec3& anyPoint(const Element& e) { return e.vertices == nullptr ? e.centre : e.vertices[0]; }

  Axes axes_;
  Vec3 across_;
};

/// An element in the world, from A's origin, and how it turns.
struct Turning {
  const Element& element;
  const Mat3& rotation;
  Vec3 origin;
  Vec3 omega;
};

/// Axis, side normals through the other's vertices, and normals of the axis with the other's edges.
void addCylinderAxes(AxisList& axes, const Turning& round, const Turning& beside) {
  const Element &cylinder = round.element, &other = beside.element;
  const Vec3 &omega = round.omega, &other_omega = beside.omega;
  const Vec3 axis = round.rotation * cylinder.axis;
  axes.add(axis, omega.cross(axis), 1.0);
  if (other.vertices == nullptr) {
    const Vec3 second = beside.rotation * other.axis;
    axes.add(axis.cross(second), omega.cross(axis).cross(second) + axis.cross(other_omega.cross(second)),
             1.0);
    return;
  }
  if (other.count > 8) return;
  const bool box = other.frame != nullptr && other.count == 8;
  if (box || other.count == 3) {  // the faces against the rim
    const auto edgeTo = [&](int i) -> Vec3 {
      return beside.rotation * (other.vertices[i] - other.vertices[0]);
    };
    for (const int i : {1, 2, 4}) {
      if (!box && i > 1) break;
      const Vec3 n = box ? edgeTo(i) : edgeTo(1).cross(edgeTo(2));
      axes.add(n, other_omega.cross(n), box ? 0.0 : edgeTo(1).norm() * edgeTo(2).norm());
    }
  }
  const Vec3 centre = round.origin + round.rotation * cylinder.centre;
  for (int i = 0; i < other.count; ++i) {
    const Vec3 x = beside.origin + beside.rotation * other.vertices[i] - centre;
    const Vec3 across = x - axis * axis.dot(x);
    axes.add(across, omega.cross(across), x.norm());
    for (int j = 0; j < i; ++j) {
      if (box && (j > 0 || (i != 1 && i != 2 && i != 4))) continue;
      const Vec3 edge = beside.rotation * (other.vertices[i] - other.vertices[j]);
      axes.add(axis.cross(edge), omega.cross(axis).cross(edge) + axis.cross(other_omega.cross(edge)),
               edge.norm());
    }
  }
}

}  // namespace

Axes rimAxes(const PairPiece& piece, const Instant& now, const Element& a, const Element& b,
             const Closest& closest) {
  const bool cylinder_is_a = a.vertices == nullptr;
  const Closest nearest = closestOnEdges(Cores(now, a, b), closest);
  if (nearest.count == 0) return {};
  const Element& cylinder = cylinder_is_a ? a : b;
  const Mat3 &rotation = cylinder_is_a ? now.ra : now.rb, &other_rotation = cylinder_is_a ? now.rb : now.ra;
  const RelativeMotion& m = piece.motion;
  const Vec3 &omega = cylinder_is_a ? m.omegaA() : m.omegaB(),
             &other_omega = cylinder_is_a ? m.omegaB() : m.omegaA();
  const auto onCylinder = [&](int i) -> const Vec3& {
    return cylinder_is_a ? nearest.point[i].local_a : nearest.point[i].local_b;
  };
  const auto onOther = [&](int i) -> const Vec3& {
    return cylinder_is_a ? nearest.point[i].local_b : nearest.point[i].local_a;
  };
  const Vec3 arm = onCylinder(0) - cylinder.centre, axis = rotation * cylinder.axis;
  Vec3 radial = rotation * (arm - cylinder.axis * cylinder.axis.dot(arm));
  if (!(radial.norm() > 0.0)) return {};
  radial.normalize();
  AxisList axes(now, a, b);
  // The closest vector, with what rounding left of it across the rim taken away: the rim's point stays
  // extreme.
  const Vec3 wedge = axis * axis.dot(nearest.v) + radial * radial.dot(nearest.v);
  axes.add(wedge, omega.cross(wedge), 0.0);
  if (nearest.count == 2) {
    const Vec3 edge = other_rotation * (onOther(1) - onOther(0)), tangent = axis.cross(radial);
    axes.add(edge.cross(tangent), other_omega.cross(edge).cross(tangent) + edge.cross(omega.cross(tangent)),
             edge.norm());
  }
  return axes.all();
}

namespace {

/// Along the two shortest edges of a triangle: of a sliver's normal, longer ones would lose the digits.
void addFaceAxis(AxisList& axes, const Vec3 edges[3], const Vec3& omega) {
  const double length2[3] = {edges[0].squaredNorm(), edges[1].squaredNorm(), edges[2].squaredNorm()};
  const auto longest = std::max_element(length2, length2 + 3) - length2;
  const Vec3 &first = edges[(longest + 1) % 3], &second = edges[(longest + 2) % 3];
  const Vec3 n = first.cross(second);
  axes.add(n, omega.cross(n), first.norm() * second.norm());
}

}  // namespace

Axes featureAxes(const PairPiece& piece, const Instant& now, const Element& a, const Element& b) {
  if (a.vertices != nullptr && b.vertices != nullptr && (a.count > 3 || b.count > 3)) return {};
  const RelativeMotion& m = piece.motion;
  AxisList axes(now, a, b);
  if (a.vertices == nullptr || b.vertices == nullptr) {
    const Turning turning_a{a, now.ra, Vec3::Zero(), m.omegaA()}, turning_b{b, now.rb, now.d, m.omegaB()};
    if (a.vertices == nullptr) addCylinderAxes(axes, turning_a, turning_b);
    if (b.vertices == nullptr) addCylinderAxes(axes, turning_b, turning_a);
    return axes.all();
  }
  Vec3 edges_a[3], edges_b[3];
  const int count_a = a.count == 3 ? 3 : a.count - 1, count_b = b.count == 3 ? 3 : b.count - 1;
  for (int i = 0; i < count_a; ++i) edges_a[i] = now.ra * (a.vertices[(i + 1) % a.count] - a.vertices[i]);
  for (int j = 0; j < count_b; ++j) edges_b[j] = now.rb * (b.vertices[(j + 1) % b.count] - b.vertices[j]);
  if (count_a == 3) addFaceAxis(axes, edges_a, m.omegaA());
  if (count_b == 3) addFaceAxis(axes, edges_b, m.omegaB());
  for (int i = 0; i < count_a; ++i) {
    for (int j = 0; j < count_b; ++j) {
      const Vec3 n = edges_a[i].cross(edges_b[j]);
      const Vec3 n_rate =
          m.omegaA().cross(edges_a[i]).cross(edges_b[j]) + edges_a[i].cross(m.omegaB().cross(edges_b[j]));
      axes.add(n, n_rate, edges_a[i].norm() * edges_b[j].norm());
    }
  }
  return axes.all();
}

COLLISION_NODE_ANY_WIDTH COLLISION_NODE_WITH_CALLS Apart apartFor(const GapModel& model, double span) {
  if (!(model.first() > 0.0) || !(span > 0.0)) return {};
  GapModel::Trend trend = model.trend(span);
  constexpr int kRounds = 2, kRefits = 3, kMost = 7;
  constexpr double kInside = 1e-9, kUnsure = 0.05;
  double end = span;
  for (int round = 0; round < kRounds; ++round) {
    if (round > 0) trend = model.trend(end);  // in so much less time other features are the farthest
    // Of a pair that recedes the chord tells nothing until the end is near.
    const int bold = round == 0 ? kMost : trend.slope > 0.0 ? kMost - kRefits : 0;
    for (int i = 0; i < kMost; ++i) {
      if (i < kRefits) {
        const double root = trend.root(end);
        // What is not in the trend goes with the third power of time.
        const double unsure = root * root * root * (trend.cubic + root * trend.quartic) / trend.first;
        if (root < end) end = root * (1.0 - kInside - kUnsure * std::min(1.0, unsure));
      }
      const GapModel::Bounds bounds = model.until(end);
      if (bounds.positive()) return {end, bounds.last, -trend.slopeAt(end)};
      // Features changed, or nearly all of the time was asked for. The chord to the end is about where the
      // bound comes to zero, unless the pair recedes at first.
      const double chord = bounds.last > 0.0 ? 0.5 : 0.9 * bounds.first / (bounds.first - bounds.last);
      const double missed = bounds.last - trend.at(end);
      if (i + 1 < kRefits && missed < 0.0 && !(bounds.last > 0.0)) {
        trend.bend += missed / (end * end);
        end *= 1.0 - 1e-6;
      } else {
        end *= i < bold ? std::max(0.25, chord) : chord;
      }
    }
  }
  return {};
}

}  // namespace collision_node::impact

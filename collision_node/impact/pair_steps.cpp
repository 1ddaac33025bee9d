#include "collision_node/impact/pair_steps.h"

#include <algorithm>
#include <limits>

#include "collision_node/impact/triangle_pair.h"

namespace collision_node::impact {

PairSteps::PairSteps(const PairPiece& piece, const Element& a, const Element& b)
    : piece_(piece),
      a_(a),
      b_(b),
      reach_{coreReach(a), coreReach(b)},
      radius_(a.radius + b.radius + piece.contact_distance) {
  if (SlidingPoints::fit(a, b)) sliding_.emplace(a, b);
}

double PairSteps::advance(double from, double to, double stop, std::uint64_t& tests) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  constexpr int kMaxSteps = 4000;
  const bool triangles = a_.triangle >= 0 && b_.triangle >= 0;
  double t = from;
  for (int step = 0; step < kMaxSteps; ++step) {
    if (step > 0) ++tests;
    const Instant now = piece_.at(t);
    Axis axis, other;
    double s = triangles ? TrianglePair(piece_, now, a_, b_).apartFor(to - t, &axis) : 0.0;
    if (s < to - t && !(s > stop)) {
      // The gap along the axis is what counts, and a few hundredths less of it are as good.
      constexpr double kLoss = 3e-2;
      const Axis through = closestAt(now, kLoss);
      const double by_points = longest(now, through, to - t, &other);
      if (by_points > s) {
        s = by_points;
        axis = other;
      }
    }
    if (!(s > 0.0)) return t;
    if (s >= to - t) return kInfinity;
    const double next = t + s;
    if (!(next > t)) return t;
    t = next;
    parting_ = {{axis.direction + s * axis.rate, axis.rate, true}, t};
    if (s < stop) return t;
  }
  return t;
}

Axis PairSteps::closestAt(const Instant& now, double loss) {
  Axis axis;
  if (sliding_) {
    sliding_->find(Cores(now, a_, b_));
    distance_ = sliding_->distance();
    axis = sliding_->axis(piece_.motion, now);
  } else if (!staysOnEdge(now, loss, &axis) && !staysOnRim(now, loss, &axis)) {
    closest_ = closestPoints(Cores(now, a_, b_), closest_, radius_, loss);
    distance_ = closest_.v.norm();
    axis = axisOf(piece_, now, closest_, radius_ > 0.0);
  }
  return axis;
}

/// Where a cylinder was closest to a vertex or an edge of the other, it most often still is: then the two
/// slide along each other, and nothing need be searched. That no other point is closer shows in the gap.
bool PairSteps::staysOnEdge(const Instant& now, double loss, Axis* axis) {
  const bool cylinder_is_a = a_.vertices == nullptr;
  if (cylinder_is_a == (b_.vertices == nullptr)) return false;
  const Element& other = cylinder_is_a ? b_ : a_;
  Vec3 ends[2];
  int count = 0;
  for (int i = 0; i < closest_.count; ++i) {
    const Vec3& x = cylinder_is_a ? closest_.point[i].local_b : closest_.point[i].local_a;
    // Points found on a rim are opposite to any point.
    if (std::find(other.vertices, other.vertices + other.count, x) == other.vertices + other.count)
      return false;
    if (std::find(ends, ends + count, x) != ends + count) continue;
    if (count == 2) return false;
    ends[count++] = x;
  }
  if (count == 0) return false;
  Element edge;
  edge.vertices = ends;
  edge.count = count;
  const Element &a = cylinder_is_a ? a_ : edge, &b = cylinder_is_a ? edge : b_;
  SlidingPoints points(a, b);
  const Cores cores(now, a, b);
  points.find(cores);
  return takeOver(points, cores, now, loss, axis);
}

/// The same of a cylinder that was closest with its rim.
bool PairSteps::staysOnRim(const Instant& now, double loss, Axis* axis) {
  if (!parting_.axis.valid) return false;
  const Cores cores(now, a_, b_);
  for (const bool rim_is_a : {true, false}) {
    const Element &rim = rim_is_a ? a_ : b_, &other = rim_is_a ? b_ : a_;
    if (rim.vertices != nullptr || other.frame == nullptr) continue;
    SlidingPoints points = SlidingPoints::ofRim(a_, b_, rim_is_a);
    if (points.findOnRim(cores, parting_.at(now.t)) && takeOver(points, cores, now, loss, axis)) return true;
  }
  return false;
}

bool PairSteps::takeOver(const SlidingPoints& points, const Cores& part, const Instant& now, double loss,
                         Axis* axis) {
  const Axis found = points.axis(piece_.motion, now);
  if (!found.valid) return false;
  const double gap = Cores(now, a_, b_).gapAlong(found.direction);
  if (points.distance() - gap > loss * (points.distance() - radius_)) return false;
  closest_ = points.closest(part);
  distance_ = points.distance();
  *axis = found;
  return true;
}

double PairSteps::apartFor(const Instant& now, const Closest& closest, double span, Axis* proved) {
  closest_ = closest;
  distance_ = closest.v.norm();
  Axis through;
  if (sliding_) {
    sliding_->find(Cores(now, a_, b_));
    through = sliding_->axis(piece_.motion, now);
  } else {
    through = axisOf(piece_, now, closest, radius_ > 0.0);
  }
  return longest(now, through, span, proved);
}

double PairSteps::longest(const Instant& now, Axis axis, double span, Axis* proved) {
  double best = 0.0, gap = 0.0;
  const auto propose = [&](const Axis& proposed) {
    if (!proposed.valid) return;
    const double s = impact::apartFor(GapModel(piece_, now, a_, b_, proposed, reach_), span, &gap);
    if (!(s > best)) return;
    best = s;
    *proved = proposed;
  };
  propose(axis);
  // More are tried only where the first does worse than plain advancement by the distance would.
  const double plain = (distance_ - radius_ - 2.0 * piece_.point_error) / piece_.speed;
  if (best >= span || !(best < 0.5 * plain || best == 0.0)) return best;
  const Cores cores(now, a_, b_);
  if (sliding_) closest_ = sliding_->closest(cores);
  axis.rate.setZero();
  propose(axis);
  if (distance_ > 0.0) propose({closest_.v / distance_, Vec3::Zero(), true});
  if (best < 0.5 * plain || best == 0.0) {
    for (const Axis& other : featureAxes(piece_, now, a_, b_)) {
      if (cores.gapAlong(other.direction) > radius_) propose(other);
    }
    if (best == 0.0) {
      for (const Axis& other : rimAxes(piece_, now, a_, b_, closest_)) propose(other);
    }
  }
  return best;
}

}  // namespace collision_node::impact

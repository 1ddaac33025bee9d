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
      radius_(a.radius + b.radius + piece.contact_distance) {}

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
      // The gap along the axis is what counts, and a hundredth less of it is as good.
      constexpr double kLoss = 1e-2;
      closest_ = closestPoints(Cores(now, a_, b_), closest_, radius_, kLoss);
      const double by_points = apartFor(now, closest_, to - t, &other);
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

double PairSteps::apartFor(const Instant& now, const Closest& closest, double span, Axis* proved) const {
  double best = 0.0, gap = 0.0;
  const auto propose = [&](const Axis& axis) {
    if (!axis.valid) return;
    const double s = impact::apartFor(GapModel(piece_, now, a_, b_, axis, reach_), span, &gap);
    if (!(s > best)) return;
    best = s;
    *proved = axis;
  };
  const bool slides = closest.exact;  // a point and a cylinder
  Axis axis = slides ? axisToCylinder(piece_, now, a_, b_) : axisOf(piece_, now, closest, radius_ > 0.0);
  propose(axis);
  // More are tried only where the first does worse than plain advancement by the distance would.
  const double plain = (closest.v.norm() - radius_ - 2.0 * piece_.point_error) / piece_.speed;
  if (best >= span || !(best < 0.5 * plain || best == 0.0)) return best;
  axis.rate.setZero();
  propose(axis);
  const double length = closest.v.norm();
  if (length > 0.0) propose({closest.v / length, Vec3::Zero(), true});
  if (best < 0.5 * plain || best == 0.0) {
    const Cores cores(now, a_, b_);
    for (const Axis& other : featureAxes(piece_, now, a_, b_)) {
      if (cores.gapAlong(other.direction) > radius_) propose(other);
    }
    if (best == 0.0) {
      for (const Axis& other : rimAxes(piece_, now, a_, b_, closest)) propose(other);
    }
  }
  return best;
}

}  // namespace collision_node::impact

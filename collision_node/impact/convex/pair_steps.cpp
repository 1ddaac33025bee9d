#include "collision_node/impact/convex/pair_steps.h"

#include <algorithm>
#include <limits>

#include "collision_node/geometry/any_width.h"
#include "collision_node/impact/convex/sliding_features.h"
#include "collision_node/impact/convex/triangle_pair.h"

namespace collision_node::impact {

PairSteps::PairSteps(const PairPiece& piece, const Element& a, const Element& b)
    : piece_(piece), a_(a), b_(b), radius_(a.radius + b.radius + piece.contact_distance) {
  if (SlidingPoints::fit(a, b)) sliding_.emplace(a, b);
}

COLLISION_NODE_ANY_WIDTH COLLISION_NODE_WITH_CALLS double PairSteps::advance(double from, double to,
                                                                             double stop,
                                                                             std::uint64_t& tests,
                                                                             std::uint64_t most) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  constexpr int kMaxSteps = 4000;
  constexpr double kHardly = 2.0;  // of a tenth of the bracket
  const bool triangles = a_.triangle >= 0 && b_.triangle >= 0;
  double t = from, before = 0.0;  // the last step
  for (int step = 0; step < kMaxSteps; ++step) {
    if (step > 0 && ++tests > most) return t;
    const Instant now = piece_.at(t);
    Axis axis, other;
    double s = triangles ? TrianglePair(piece_, now, a_, b_).apartFor(to - t, &axis) : 0.0;
    if (s < to - t && !(s > stop)) {
      // The gap along the axis is what counts, and a few hundredths less of it are as good.
      constexpr double kLoss = 3e-2, kFirstLoss = 0.2;
      const Axis through = closestAt(now, step == 0 ? kFirstLoss : kLoss);
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
    // What the axis does not show: now, and what the turning adds. The gap at which a step begins is what the
    // axis of the one before did not show, and that shrinks with the square of the step. Where hardly any
    // will be left, no more need be looked for.
    const double hidden = std::max(0.0, distance_ - radius_ - first_);
    const double growing = step > 0 ? first_ * (s / before) * (s / before) : first_;
    if (last_.time == s && last_.gap + hidden + growing < kHardly * stop * last_.closing) return t;
    before = s;
  }
  return t;
}

Axis PairSteps::closestAt(const Instant& now, double loss) {
  Axis axis;
  if (sliding_) {
    sliding_->find(Cores(now, a_, b_));
    distance_ = sliding_->distance();
    axis = sliding_->axis(piece_.motion, now);
    return axis;
  }
  const Vec3 parting = parting_.at(now.t);
  const bool stays = slideOnFeatures(now, a_, b_, closest_, parting_.axis.valid ? &parting : nullptr, 0.0,
                                     [&](const SlidingPoints& points, const Cores& part, double radius) {
                                       return takeOver(points, part, radius, now, loss, &axis);
                                     });
  if (!stays) {
    closest_ = closestPoints(Cores(now, a_, b_), closest_, {radius_, loss});
    distance_ = closest_.v.norm();
    axis = axisOf(piece_, now, closest_, radius_ > 0.0);
  }
  return axis;
}

void PairSteps::modelAlong(const Axis& axis, const Instant& now) {
  if (!cores_) cores_.emplace(a_, b_);
  through_.emplace(piece_, now, *cores_, axis);
}

bool PairSteps::takeOver(const SlidingPoints& points, const Cores& part, double radius, const Instant& now,
                         double loss, Axis* axis) {
  const Axis found = points.axis(piece_.motion, now);
  const double distance = points.distance() - radius;
  if (!found.valid || !(distance > 0.0)) return false;
  modelAlong(found, now);
  const double hidden = distance - radius_ - piece_.point_error - through_->first();
  if (hidden > loss * (distance - radius_)) {
    through_.reset();
    return false;
  }
  closest_ = points.closest(part);
  closest_.v = distance * found.direction;
  distance_ = distance;
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
  double best = 0.0;
  const auto propose = [&](const Axis& proposed) {
    if (!proposed.valid) return;
    if (!through_) modelAlong(proposed, now);
    const Apart apart = impact::apartFor(*through_, span);
    const double first = through_->first();
    through_.reset();
    if (!(apart.time > best)) return;
    best = apart.time;
    first_ = first;
    last_ = apart;
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
    // Along a rim the search for the closest points may end a little before them: from elsewhere it seldom
    // does.
    for (int k = 0; k < 3 && best == 0.0 && plain > 0.0; ++k) {
      const Closest again = closestPoints(cores, Vec3(Vec3::Unit(k)), {radius_});
      if (again.overlap || !(again.v.norm() < distance_)) continue;
      propose(axisOf(piece_, now, again, radius_ > 0.0));
    }
  }
  return best;
}

}  // namespace collision_node::impact

/// Two moving models: static distance at an instant, and the first touching instant by a march that is never
/// late.
#pragma once

#include <cstdint>
#include <queue>
#include <tuple>
#include <vector>

#include "test/oracle/model.h"

namespace oracle {

/// What a march over [from, to] found. `lo` is proved: apart on [from, lo). `hi` (when `verified`) is an
/// instant at which the two touch. Not found: apart on all of [from, to], unless `gave_up` (then apart on
/// [from, lo)).
struct FirstTouch {
  bool found = false;
  bool verified = false;
  bool gave_up = false;
  Real lo = 0, hi = 0;
  int part_a = -1, part_b = -1;
};

/// The nearest parts at one instant.
struct NearestParts {
  Gap gap;
  int part_a = -1, part_b = -1;
  bool inside = false;  ///< one lies inside a closed surface of the other
};

class Pair {
 public:
  Pair(Model a, Model b, Path path_a, Path path_b, Real duration)
      : a_(std::move(a)),
        b_(std::move(b)),
        path_a_(path_a),
        path_b_(path_b),
        near_a_(path_a.relativeTo(path_a)),
        near_b_(path_b.relativeTo(path_a)),
        duration_(duration) {
    origin_speed_ = speedBound(path_a_, path_b_, duration_);
    const Real start_distance = norm(near_b_.at(0).position);
    size_ = a_.reach + b_.reach;
    scale_ = size_ + start_distance + origin_speed_ * duration_;
    turn_ = path_a_.turn(duration_) + path_b_.turn(duration_);
  }

  /// The same with b moved by `by` [m], world axes.
  Pair shifted(const V3& by) const {
    Pair other = *this;
    other.path_b_.shift(by);
    other.near_b_.shift(by);
    return other;
  }

  const Model& a() const { return a_; }
  const Model& b() const { return b_; }
  /// Contact without extent in time: a point passes a surface without volume.
  bool crossesInNoTime() const {
    return (a_.only_points && !b_.has_volume) || (b_.only_points && !a_.has_volume);
  }
  /// One side is points only: it may pass through a surface of the other in no time.
  bool hasPoint() const { return a_.only_points || b_.only_points; }
  const Path& pathA() const { return path_a_; }
  const Path& pathB() const { return path_b_; }
  Real duration() const { return duration_; }
  Real size() const { return size_; }  ///< sum of both reaches [m]
  Real smaller() const {               ///< the smaller reach that is not 0 [m]
    return std::min(a_.reach > 0 ? a_.reach : b_.reach, b_.reach > 0 ? b_.reach : a_.reach);
  }
  Real scale() const { return scale_; }  ///< bounds every relative coordinate on the piece [m]
  /// Two cylinders may meet: their static distance is only good to about 1e-12 of the size when they almost
  /// touch.
  bool hasCylinder() const { return hasCylinder(a_) || hasCylinder(b_); }
  bool hasTwoCylinders() const { return hasCylinder(a_) && hasCylinder(b_); }
  /// Below this two sets count as touching: a few hundred roundings of the largest coordinate, and of the
  /// largest angle. [m]
  Real touchDistance() const { return (2e-17L + 1e-18L * turn_) * scale_; }
  Real marchEnd() const { return 5 * touchDistance(); }  ///< the march stops at this distance [m]

  /// Bound of the speed at which two parts approach. [m/s]
  Real speed(const Part& a, const Part& b) const {
    return (origin_speed_ + path_a_.spin() * a.reach + path_b_.spin() * b.reach) * (1 + 1e-12L);
  }
  Real maxSpeed() const { return origin_speed_ + path_a_.spin() * a_.reach + path_b_.spin() * b_.reach; }
  /// Bound of the relative acceleration of any two material points. [m/s^2]
  Real maxAcceleration() const {
    return accelerationBound(path_a_, path_b_, duration_) + path_a_.spin() * path_a_.spin() * a_.reach +
           path_b_.spin() * path_b_.spin() * b_.reach;
  }

  /// Witnesses here and below are world axes relative to a's origin at that instant: what both have in common
  /// rounds nothing.
  Gap partGapAt(int i, int j, Real t) const {
    return partGap(placed(a_.parts[i], near_a_.at(t)), placed(b_.parts[j], near_b_.at(t)));
  }

  /// Distance of all parts (0 when one lies inside the other), every pair looked at unless its spheres are
  /// farther.
  NearestParts nearest(Real t) const {
    const Frame fa = near_a_.at(t), fb = near_b_.at(t);
    std::vector<Part> pa, pb;
    for (const Part& p : a_.parts) pa.push_back(placed(p, fa));
    for (const Part& p : b_.parts) pb.push_back(placed(p, fb));
    struct Candidate {
      Real bound;
      int i, j;
    };
    std::vector<Candidate> order;
    order.reserve(pa.size() * pb.size());
    for (std::size_t i = 0; i < pa.size(); ++i) {
      for (std::size_t j = 0; j < pb.size(); ++j) {
        order.push_back({norm(pb[j].centre - pa[i].centre) - pa[i].bound - pb[j].bound, static_cast<int>(i),
                         static_cast<int>(j)});
      }
    }
    std::sort(order.begin(), order.end(),
              [](const Candidate& x, const Candidate& y) { return x.bound < y.bound; });
    NearestParts best;
    for (const Candidate& c : order) {
      if (c.bound >= best.gap.upper || best.gap.upper == 0) break;
      const Gap gap = partGap(pa[c.i], pb[c.j]);
      if (gap.upper < best.gap.upper) best.gap = gap, best.part_a = c.i, best.part_b = c.j;
    }
    if (best.gap.upper > 0 && (anyInside(a_, fa, b_, fb) || anyInside(b_, fb, a_, fa))) {
      best.inside = true;
      best.gap.lower = best.gap.upper = 0;
    }
    return best;
  }

  /// The gaps of all pairs of parts that are at most `limit` apart at t.
  std::vector<NearestParts> within(Real t, Real limit) const {
    const Frame fa = near_a_.at(t), fb = near_b_.at(t);
    std::vector<NearestParts> out;
    for (std::size_t i = 0; i < a_.parts.size(); ++i) {
      const Part a = placed(a_.parts[i], fa);
      for (std::size_t j = 0; j < b_.parts.size(); ++j) {
        const Part b = placed(b_.parts[j], fb);
        if (norm(b.centre - a.centre) - a.bound - b.bound > limit) continue;
        const Gap gap = partGap(a, b);
        if (gap.upper <= limit) out.push_back({gap, static_cast<int>(i), static_cast<int>(j), false});
      }
    }
    return out;
  }

  Real distance(Real t) const { return nearest(t).gap.upper; }
  /// The proved part of it; the two differ for two cylinders only.
  Real provedDistance(Real t) const { return nearest(t).gap.lower; }
  bool touching(Real t) const { return distance(t) <= touchDistance(); }

  /// First instant of [from, to] at which the distance comes down to `margin` (0: touches). Every pair of
  /// parts is carried forward by its distance over its speed bound, always the one that is least far in time.
  FirstTouch firstTouch(Real from, Real to, Real margin = 0, std::int64_t max_steps = 2000000) const {
    FirstTouch out;
    const NearestParts start = nearest(from);
    if (start.inside || start.gap.upper <= margin + marchEnd()) {
      out.found = true, out.lo = out.hi = from, out.part_a = start.part_a, out.part_b = start.part_b;
      out.verified = start.inside || start.gap.upper <= touchDistance();
      if (!out.verified && margin == 0) verify(out, to);
      return out;
    }
    struct Clock {
      Real t;
      int i, j;
    };
    const auto later = [](const Clock& x, const Clock& y) {
      return std::tie(x.t, x.i, x.j) > std::tie(y.t, y.i, y.j);
    };
    std::priority_queue<Clock, std::vector<Clock>, decltype(later)> queue(later);
    for (std::size_t i = 0; i < a_.parts.size(); ++i) {
      for (std::size_t j = 0; j < b_.parts.size(); ++j) {
        queue.push({from, static_cast<int>(i), static_cast<int>(j)});
      }
    }
    for (std::int64_t step = 0; !queue.empty(); ++step) {
      Clock clock = queue.top();
      queue.pop();
      if (step == max_steps) {
        out.gave_up = true, out.lo = clock.t;
        return out;
      }
      const Part &a = a_.parts[clock.i], &b = b_.parts[clock.j];
      const Frame fa = near_a_.at(clock.t), fb = near_b_.at(clock.t);
      const Real spheres = norm(fb.place(b.centre) - fa.place(a.centre)) - a.bound - b.bound;
      Real free = spheres - margin;
      if (free < 0.5L * (a.bound + b.bound) || free < 1e-3L * scale_) {
        const Gap gap = partGap(placed(a, fa), placed(b, fb), 0.1L);
        free = gap.lower - margin;
        if (free <= marchEnd() || (gap.upper <= 1e-12L * scale_ && free < 0.01L * gap.upper)) {
          out.found = true, out.lo = out.hi = clock.t, out.part_a = clock.i, out.part_b = clock.j;
          if (margin == 0) verify(out, to);
          return out;
        }
      }
      // At its own speed; or, whatever the parts' turning does to them about their origins, at the origins'.
      const Real v = speed(a, b);
      const Real clear = norm(fb.position - fa.position) - a.reach - b.reach - margin - 4e-18L * scale_;
      const Real own = (free - 4e-18L * scale_) / v;
      const Real origins = origin_speed_ > 0 ? clear / origin_speed_ : clear > 0 ? 2 * (to - from) : 0;
      if (!(v > 0)) continue;  // both rest: the distance is for ever
      clock.t += std::max(own, origins);
      if (clock.t <= to) queue.push(clock);
    }
    return out;
  }

  /// Whether a part of `inner` lies inside a closed surface of `outer`; their surfaces must be apart.
  static bool anyInside(const Model& outer, const Frame& outer_frame, const Model& inner,
                        const Frame& inner_frame) {
    for (const V3& representative : inner.representatives) {
      const V3 world = inner_frame.place(representative) - outer_frame.position;
      const M3& r = outer_frame.rotation;
      const V3 local{dot(r.column[0], world), dot(r.column[1], world), dot(r.column[2], world)};
      for (const auto& surface : outer.closed) {
        if (insideOf(surface, local)) return true;
      }
    }
    return false;
  }

 private:
  static bool hasCylinder(const Model& m) {
    return std::any_of(m.parts.begin(), m.parts.end(), [](const Part& p) { return p.count == 0; });
  }

  /// Looks for a touching instant just behind out.lo and narrows it down. Leaves `verified` false where none
  /// shows.
  void verify(FirstTouch& out, Real to) const {
    const auto gap = [&](Real t) { return partGapAt(out.part_a, out.part_b, t).upper; };
    const Real limit = touchDistance();
    if (gap(out.lo) <= limit) {
      out.verified = true;
      return;
    }
    Real before = out.lo, last = gap(out.lo);
    Real step = std::max(last, marchEnd()) / std::max(maxSpeed(), 1e-300L);
    for (int i = 0; i < 60 && out.lo + step <= to; ++i, step *= 2) {
      const Real t = out.lo + step, now = gap(t);
      if (now <= limit) return narrow(out, before, t, gap);
      if (now > last) {  // a crossing between two samples, or a near miss: look at the lowest point
        Real l = std::max(out.lo, out.lo + step / 4), r = t;
        if (i < 2) l = out.lo;
        for (int k = 0; k < 200; ++k) {
          const Real m1 = l + 0.382L * (r - l), m2 = r - 0.382L * (r - l);
          (gap(m1) <= gap(m2) ? r : l) = gap(m1) <= gap(m2) ? m2 : m1;
        }
        if (gap(l) <= limit) return narrow(out, out.lo, l, gap);
        if (gap(r) <= limit) return narrow(out, out.lo, r, gap);
        if (step * maxSpeed() > 1e-6L * scale_) return;
      }
      before = t, last = now;
      if (touching(t)) {
        out.verified = true, out.hi = t;
        return;
      }
    }
  }

  template <class GapAt>
  void narrow(FirstTouch& out, Real apart, Real touching_at, const GapAt& gap) const {
    for (int k = 0; k < 80; ++k) {
      const Real mid = (apart + touching_at) / 2;
      (gap(mid) <= touchDistance() ? touching_at : apart) = mid;
    }
    out.verified = true, out.hi = touching_at;
  }

  Model a_, b_;
  Path path_a_, path_b_;
  Path near_a_, near_b_;  ///< both without what a's origin does
  Real duration_, origin_speed_ = 0, size_ = 0, scale_ = 0, turn_ = 0;
};

/// Both objects on one piece. A's first position is the common origin.
/// Touching at a contact distance is touching of both grown by half of it.
inline Pair makePair(const std::vector<collision_node::geometry::PlacedShape>& a,
                     const std::vector<collision_node::geometry::PlacedShape>& b, const RigidMotion& motion_a,
                     const RigidMotion& motion_b, Nanoseconds start_ns, Nanoseconds end_ns,
                     Real contact_distance = 0) {
  const V3 origin = exact(motion_a.c[0]);
  return Pair(grown(makeModel(a), contact_distance / 2), grown(makeModel(b), contact_distance / 2),
              Path(motion_a, start_ns, origin), Path(motion_b, start_ns, origin),
              static_cast<Real>(end_ns - start_ns) / 1e9L);
}

}  // namespace oracle

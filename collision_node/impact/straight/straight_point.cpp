/// What a point on a straight path passes through first.
///
/// Guarantee: straight_path.h's. Sources: S. Woop, C. Benthin, I. Wald 2013 (sheared edges); the times, and
/// the proof of a passage between triangles, are derived in docs/solver.md, "Straight paths".
#include <algorithm>
#include <cmath>
#include <limits>

#include "collision_node/impact/straight/path_collector.h"
#include "collision_node/impact/straight/straight_path.h"

namespace collision_node::impact {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double sumOf(const Vec3& v) { return std::abs(v.x()) + std::abs(v.y()) + std::abs(v.z()); }
double leastOf(const double x[3]) { return std::min(x[0], std::min(x[1], x[2])); }
double mostOf(const double x[3]) { return std::max(x[0], std::max(x[1], x[2])); }

}  // namespace

/// Finds through which triangles the path passes, and when.
class StraightPath::PointVisitor final : public PathCollector {
 public:
  PointVisitor(const StraightPath& path, double from, double to, PathContact& contact, const PathWalk& walk,
               double limit, bool shrinks)
      : PathCollector(contact, walk, limit, shrinks), path_(path), from_(from), to_(to) {}

  float visit(const WideLeaf& leaf, const SeenLeaf& seen, int lane, float, float limit) override {
    Met met = metOf(leaf, lane);
    double depth[3];
    for (int k = 0; k < 3; ++k) {
      met.side[k] = seen.side[k][lane];
      depth[k] = seen.depth[k][lane];
    }
    met.error = seen.error[lane];
    met.sure = leastOf(met.side) > met.error || mostOf(met.side) < -met.error;

    const Vec3* vertices = path_.bvh_->vertices();
    const Vec3 &a = vertices[met.vertex[0]], &b = vertices[met.vertex[1]], &c = vertices[met.vertex[2]];
    // Where the path crosses the plane, n . (x(t) - a) = 0, with all that this may be off.
    const Vec3 e1 = b - a, e2 = c - a, n = e1.cross(e2);
    const double n_error = 8.0 * kUnit * sumOf(e1) * sumOf(e2);
    // At least |n|: the squares of what is very small are lost.
    const double length = std::sqrt(n.squaredNorm() + std::numeric_limits<double>::min());
    const double rate = n.dot(path_.v_);
    const double slowest = std::abs(rate) - (n_error + 8.0 * kUnit * length) * path_.speed_;
    // In any case between the first and the last vertex along the path.
    const double one_end = (leastOf(depth) - path_.frame_.error) * path_.frame_.per_rate,
                 other_end = (mostOf(depth) + path_.frame_.error) * path_.frame_.per_rate;
    met.lower = std::min(one_end, other_end);
    met.upper = std::max(one_end, other_end);
    if (slowest > 0.0) {
      const double t0 = n.dot(a - path_.p_) / rate;
      const Vec3 arm = path_.at(t0) - a;
      const double offset = arm.norm();
      const double slack = std::abs(n.dot(arm)) + n_error * offset +
                           length * (path_.error_ + 8.0 * kUnit * (offset + path_.size_));
      const double dt = slack / slowest * (1.0 + 16.0 * kUnit);
      met.lower = std::max(met.lower, t0 - dt);
      met.upper = std::min(met.upper, t0 + dt);
    } else {
      met.sure = false;
    }
    if (met.lower > met.upper || met.upper <= from_ || met.lower > to_) return limit;
    return add(met, limit);
  }

 private:
  const StraightPath& path_;
  double from_, to_;
};

void StraightPath::firstOfPoint(double from, double to, double width, PathContact& contact,
                                Lanes lanes) const {
  const PathWalk walk(*bvh_, frame_, p_, v_, from, to, 0.0, error_, 0.0, size_, lanes);
  if (walk.misses) return;
  constexpr int kMostWalks = 4;
  double limit = to;
  for (int walks = 0; walks < kMostWalks; ++walks) {
    PointVisitor visitor(*this, from, to, contact, walk, limit, walks == 0);
    contact.tests += walkPath(*bvh_, walk, walk.parameterUp(limit), visitor);
    contact.kind = PathContact::Kind::kCannotTell;
    contact.lower = contact.upper = from;
    if (visitor.overflowed()) return;
    if (contact.count == 0) {
      contact.kind = PathContact::Kind::kClear;
      return;
    }
    // Whatever overlaps the earliest, and what overlaps that, is one contact.
    double lower = kInfinity, end = -kInfinity;
    for (int i = 0; i < contact.count; ++i) lower = std::min(lower, contact.met[i].lower);
    for (double last = lower; last != end;) {
      end = last;
      for (int i = 0; i < contact.count; ++i) {
        if (contact.met[i].lower <= end) last = std::max(last, contact.met[i].upper);
      }
    }
    if (end > visitor.limit() && end <= to) {  // what overlaps it has not all been seen
      limit = end;
      continue;
    }
    contact.lower = std::max(lower, from);
    if (lower < from || end > to) return;
    contact.keepUntil(end);
    contact.showEarliest();
    const PathContact::Met& shown = contact.met[0];
    if (end - lower > std::max(width, 8.0 * (shown.upper - shown.lower))) return;
    if (!shown.sure && !provesPassage(contact)) return;
    contact.upper = end;
    contact.kind = PathContact::Kind::kContact;
    return;
  }
}

/// The triangles' border, seen along the path, winds around it: it passes through one of them. Edges that two
/// of them share cancel, whatever the sign of what was computed for them.
bool StraightPath::provesPassage(const PathContact& contact) const {
  struct Edge {
    std::int32_t from, to;
    double side, error;
  };
  for (const int wound : {0, 1, -1}) {  // each turned towards the path; all as loaded; all the other way
    Edge border[3 * PathContact::kMost];
    int count = 0;
    for (int i = 0; i < contact.count; ++i) {
      const PathContact::Met& met = contact.met[i];
      const double turn = met.side[0] + met.side[1] + met.side[2];
      const bool turned = wound == 0 ? turn < 0.0 : wound < 0;
      for (int k = 0; k < 3; ++k) {
        Edge edge{met.vertex[(k + 1) % 3], met.vertex[(k + 2) % 3], met.side[k], met.error};
        if (turned) {
          std::swap(edge.from, edge.to);
          edge.side = -edge.side;
        }
        const auto opposite = std::find_if(
            border, border + count, [&](const Edge& e) { return e.from == edge.to && e.to == edge.from; });
        if (opposite != border + count) {
          *opposite = border[--count];
        } else {
          border[count++] = edge;
        }
      }
    }
    if (count > 0 && std::all_of(border, border + count, [](const Edge& e) { return e.side > e.error; }))
      return true;
  }
  return false;
}

}  // namespace collision_node::impact

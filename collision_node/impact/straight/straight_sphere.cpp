/// What a sphere on a straight path touches first.
///
/// Guarantee: straight_path.h's. The distance to a convex set is convex along a line: steps to where a plane
/// across the closest vector is reached never pass the contact (docs/solver.md, "Straight paths").
#include <algorithm>
#include <cmath>
#include <limits>

#include "collision_node/impact/straight/closest_on_triangle.h"
#include "collision_node/impact/straight/path_collector.h"
#include "collision_node/impact/straight/straight_path.h"

namespace collision_node::impact {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

/// Finds when the sphere comes within reach of each triangle.
class StraightPath::SphereVisitor final : public PathCollector {
 public:
  SphereVisitor(const StraightPath& path, double from, double to, PathContact& contact, const PathWalk& walk)
      : PathCollector(contact, walk, to, true), path_(path), from_(from), to_(to) {}

  /// The distance to a convex set is convex along the path: steps to where the plane across the closest
  /// vector is reached never pass the contact, and each is a proof of what lies before it.
  float visit(const WideLeaf& leaf, const SeenLeaf&, int lane, float entered, float limit) override {
    constexpr int kMostSteps = 48;
    Met met = metOf(leaf, lane);
    const Vec3* vertices = path_.bvh_->vertices();
    const Vec3 &a = vertices[met.vertex[0]], &b = vertices[met.vertex[1]], &c = vertices[met.vertex[2]];
    const double error = path_.error_ + 16.0 * kUnit * path_.size_;
    double t = std::max(from_, walk_.timeDown(entered)), rate = 0.0;
    for (int step = 0; step < kMostSteps; ++step) {
      const Vec3 x = path_.at(t), w = x - closestOnTriangle(x, a, b, c);
      const double distance = w.norm();
      if (!(distance > 0.0)) break;
      const Vec3 n = w / distance;
      rate = n.dot(path_.v_);
      const double gap = std::min({n.dot(x - a), n.dot(x - b), n.dot(x - c)}) - path_.radius_ - error;
      if (!(gap > 0.0)) break;
      if (rate >= 0.0) return limit;
      const double next = t - gap / rate;
      if (next > limit_) return limit;
      if (!(next > t)) break;
      t = next;
      if (gap < 0.5 * error) break;
    }
    met.lower = t;
    met.upper = kInfinity;
    met.sure = false;
    double wait = 4.0 * error;
    for (int look = 0; look < 4 && rate < 0.0; ++look, wait *= 4.0) {
      const double later = t - wait / rate;
      const Vec3 x = path_.at(later);
      if (!(later <= to_)) break;
      if ((x - closestOnTriangle(x, a, b, c)).norm() > path_.radius_ - error) continue;
      met.sure = true;
      met.upper = later;
      break;
    }
    return add(met, limit);
  }

 private:
  const StraightPath& path_;
  double from_, to_;
};

void StraightPath::firstOfSphere(double from, double to, double width, PathContact& contact,
                                 Lanes lanes) const {
  const double error = 2.0 * error_ + 32.0 * kUnit * size_;
  const double sheared = (radius_ + error) *
                         std::sqrt(1.0 + frame_.shear_x * frame_.shear_x + frame_.shear_y * frame_.shear_y) *
                         (1.0 + 1e-12);
  const PathWalk walk(*bvh_, frame_, p_, v_, from, to, radius_, error, sheared, size_, lanes);
  SphereVisitor visitor(*this, from, to, contact, walk);
  contact.tests += walkPath(*bvh_, walk, walk.parameterUp(to), visitor);
  contact.keepUntil(visitor.limit());
  contact.showEarliest();
  if (contact.count == 0 && !visitor.overflowed()) return;
  contact.kind = PathContact::Kind::kCannotTell;
  contact.lower = contact.upper = from;
  if (visitor.overflowed() || !contact.met[0].sure) return;
  contact.lower = contact.upper = contact.met[0].upper;
  for (int i = 0; i < contact.count; ++i) {
    contact.lower = std::min(contact.lower, contact.met[i].lower);
    contact.upper = std::min(contact.upper, contact.met[i].upper);
  }
  const double own = contact.met[0].upper - contact.met[0].lower;
  if (contact.upper - contact.lower <= std::max(width, 8.0 * own)) contact.kind = PathContact::Kind::kContact;
}

}  // namespace collision_node::impact

#include "collision_node/impact/convex/contact_view.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

namespace collision_node::impact {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Directions round a cylinder's axis, from the one nearest to the support: fine where the rim touches.
struct Turn {
  double cosine, sine;
};
constexpr Turn kNearTurns[] = {{1.0, 0.0},
                               {0.99999999500000000417, 9.9999999833333333417e-05},
                               {0.99999999500000000417, -9.9999999833333333417e-05},
                               {0.99995000041666527778, 0.0099998333341666646825},
                               {0.99995000041666527778, -0.0099998333341666646825},
                               {0.95533648912560601964, 0.29552020666133957511},
                               {0.95533648912560601964, -0.29552020666133957511}};
constexpr Turn kFarTurns[] = {{0.070737201667702910088, 0.99749498660405443094},
                              {0.070737201667702910088, -0.99749498660405443094},
                              {-0.98999249660044545727, 0.14112000805986722210}};

/// The unit vector across a cylinder's axis that leans towards `up`, and by how much `up` does. Of what is
/// left of `up` nearly along the axis rounding may make one along the axis: there it leans to no side.
Vec3 sideways(const Vec3& axis, const Vec3& up, double* radial) {
  constexpr double kAlong = 1e-9;
  Vec3 side = up - up.dot(axis) * axis;
  *radial = side.norm();
  if (*radial < kAlong) {
    *radial = 0.0;
    return axis.unitOrthogonal();
  }
  side /= *radial;
  return (side - side.dot(axis) * axis).normalized();
}

}  // namespace

ContactView::SeenCore::SeenCore(const PosedCore& core, const Vec3& up_w, const Vec3& e1, const Vec3& e2)
    : element(*core.element), up(core.rotation->transpose() * up_w) {
  turn.row(0) = up.transpose();
  turn.row(1) = e1.transpose() * *core.rotation;
  turn.row(2) = e2.transpose() * *core.rotation;
  origin = Vec3(up_w.dot(core.origin), e1.dot(core.origin), e2.dot(core.origin));
}

ContactView::ContactView(const Cores& cores, const Vec3& n, ViewBuffers& buffers)
    : buffers_(buffers),
      n_(n),
      e1_(n.unitOrthogonal()),
      e2_(n.cross(e1_)),
      a_(cores.a, n, e1_, e2_),
      b_(cores.b, -n, e1_, e2_),
      top_a_(see(a_, buffers.a)),
      low_b_(-see(b_, buffers.b)) {}

/// All vertices, or corners and rim points of a cylinder; those least deep first. Returns the highest of the
/// core.
double ContactView::see(const SeenCore& core, std::vector<SeenPoint>& points) {
  const Element& e = core.element;
  points.clear();
  const auto add = [&](const Vec3& seen) { points.push_back({seen[0], seen.tail<2>()}); };
  double top = -kInfinity;
  if (e.vertices != nullptr) {
    for (int i = 0; i < e.count; ++i) add(core.see(e.vertices[i]));
  } else {
    top = core.see(supportOf(e, core.up))[0];
    const double along = core.up.dot(e.axis);
    double radial = 0.0;
    const Vec3 side = sideways(e.axis, core.up, &radial);
    const Vec3 middle = core.see(e.centre), end = core.turn * (std::copysign(e.half_length, along) * e.axis);
    const Vec3 x = core.turn * (e.rim_radius * side), y = core.turn * (e.rim_radius * e.axis.cross(side));
    const auto at = [&](const Vec3& centre, const Turn& turn) {
      add(centre + (turn.cosine * x + turn.sine * y));
    };
    // Of the far end, of which little is ever asked, the point opposite to the support; of either, all around
    // where it is nearly as deep as the other's points.
    constexpr double kFlat = 0.1;
    for (const Turn& turn : kNearTurns) at(middle + end, turn);
    at(middle - end, kNearTurns[0]);
    if (std::abs(along) < kFlat) {
      for (std::size_t i = 1; i < std::size(kNearTurns); ++i) at(middle - end, kNearTurns[i]);
    }
    if (std::abs(along) > 1.0 - 0.5 * kFlat * kFlat) {
      for (const Turn& turn : kFarTurns) at(middle + end, turn);
    }
  }
  for (const SeenPoint& p : points) top = std::max(top, p.depth);
  for (SeenPoint& p : points) p.depth = top - p.depth;
  std::sort(points.begin(), points.end(),
            [](const SeenPoint& x, const SeenPoint& y) { return x.depth < y.depth; });
  return top;
}

double ContactView::normalCone(double moved, double known) const {
  const std::vector<SeenPoint>&a = buffers_.a, &b = buffers_.b;
  Polygon& used = buffers_.points;
  // No hull of differences holds a larger disc.
  double spread_a = 0.0, spread_b = 0.0;
  for (const SeenPoint& p : a) spread_a = std::max(spread_a, (p.across - a[0].across).squaredNorm());
  for (const SeenPoint& p : b) spread_b = std::max(spread_b, (p.across - b[0].across).squaredNorm());
  const double widest = (b[0].across - a[0].across).norm() + std::sqrt(spread_a) + std::sqrt(spread_b);
  constexpr double kLevel = 1.2;  // heights this close are one level: a hull for each would tell little more
  constexpr std::size_t kEnough = 64, kMost = 4096;  // points: hulls of more cost more than they sharpen
  const double known_sine = known < M_PI_2 ? std::sin(known) : 1.0;
  double best_sine = known_sine, done = -1.0;  // every difference up to this height is used
  used.clear();
  Vec2 low = Vec2::Constant(kInfinity), high = -low;  // of what is used
  // Behind the edge that was in the last disc's way, nothing larger fits before a point lies beyond it.
  Vec2 blocked = Vec2::Zero();
  double beyond = kInfinity;
  while (used.size() <= kEnough) {
    double next = kInfinity;
    for (const SeenPoint& p : a) {
      if (!(p.depth + b[0].depth < next)) break;
      for (const SeenPoint& q : b) {
        if (!(p.depth + q.depth > done)) continue;
        next = std::min(next, p.depth + q.depth);
        break;
      }
    }
    if (!(moved + next < best_sine * widest)) break;
    const double level = std::max(next, (moved + next) * kLevel - moved);
    double highest = next;
    for (const SeenPoint& p : a) {
      if (!(p.depth + b[0].depth <= level)) break;
      for (const SeenPoint& q : b) {
        const double height = p.depth + q.depth;
        if (!(height <= level)) break;
        if (!(height > done)) continue;
        highest = std::max(highest, height);
        const Vec2 x = q.across - p.across;
        low = low.cwiseMin(x);
        high = high.cwiseMax(x);
        beyond = std::max(beyond, blocked.dot(x));
        used.push_back(x);
      }
      if (used.size() > kMost) break;
    }
    done = level;
    if (used.size() < 3) continue;
    const double most =
        std::min({(-low).minCoeff(), high.minCoeff(), beyond});  // of the disc about the origin
    if (!(moved + highest < best_sine * most)) continue;
    const double l = discInHull(used, buffers_.scratch, &blocked);
    beyond = blocked.isZero(0.0) ? kInfinity : l;
    if (l > moved + highest) best_sine = std::min(best_sine, (moved + highest) / l);
  }
  return best_sine < known_sine ? std::asin(best_sine) * (1.0 + 64.0 * kUnit) : known;
}

/// Corner points of a set that holds every point of the core within `depth` of its support plane.
void ContactView::cap(const SeenCore& core, const std::vector<SeenPoint>& points, double depth, double tilt,
                      Polygon& cap) {
  const Element& e = core.element;
  cap.clear();
  if (e.vertices != nullptr) {
    std::size_t kept = 0;
    while (kept < points.size() && points[kept].depth <= depth) ++kept;
    for (std::size_t i = 0; i < kept; ++i) {
      const SeenPoint& p = points[i];
      cap.push_back(p.across);
      for (std::size_t j = kept; j < points.size(); ++j) {
        const SeenPoint& q = points[j];
        cap.push_back(p.across + (q.across - p.across) * ((depth - p.depth) / (q.depth - p.depth)));
      }
    }
    return;
  }
  const double along = core.up.dot(e.axis);
  double radial = 0.0;
  const Vec3 side = sideways(e.axis, core.up, &radial);
  const Vec3 other = e.axis.cross(side);
  const double r = e.rim_radius;
  const double z_low =
      std::abs(along) > 0.0 ? std::max(-1.0, 1.0 - depth / (std::abs(along) * e.half_length)) : -1.0;
  const double x_low = radial > 0.0 ? std::max(-r, r - depth / radial) : -r;
  double reach = x_low > 0.0 ? std::sqrt(std::max(0.0, (r - x_low) * (r + x_low))) : r;
  if (radial > 0.0 && tilt < 0.5 * radial) reach = std::min(reach, r * std::sin(2.0 * tilt / radial));
  const Vec3 middle = core.see(e.centre);
  const Vec3 end = core.turn * ((along >= 0.0 ? e.half_length : -e.half_length) * e.axis);
  const Vec3 to_side = core.turn * side, to_other = core.turn * (reach * other);
  for (const double z : {z_low, 1.0}) {
    for (const double x : {x_low, r}) {
      const Vec3 between = middle + z * end + x * to_side;
      cap.push_back((between - to_other).tail<2>());
      cap.push_back((between + to_other).tail<2>());
    }
  }
}

void ContactView::commonDisc(double depth, double tilt_a, double tilt_b, double moved_a, double moved_b,
                             Vec2* centre, double* radius) const {
  // One side's cap alone often is a point, as far as anybody can tell: nothing is gained by the other's.
  constexpr double kPoint = 8.0, kThin = 1e-6;
  Polygon &cap_a = buffers_.points, &cap_b = buffers_.points_b;
  cap(a_, buffers_.a, depth, tilt_a, cap_a);
  enclosingDisc(cap_a, centre, radius);
  if (cap_a.empty()) return;  // lost where squares overflow
  const bool point_a = *radius <= kPoint * moved_a;
  *radius += moved_a;
  if (cap_a.size() == 1 && moved_a <= moved_b) return;  // nothing of B's can be smaller
  cap(b_, buffers_.b, depth, tilt_b, cap_b);
  if (cap_b.empty()) return;
  Vec2 centre_b;
  double radius_b = 0.0;
  enclosingDisc(cap_b, &centre_b, &radius_b);
  const bool point_b = radius_b <= kPoint * moved_b;
  radius_b += moved_b;
  if (!point_a && !point_b) {
    const Strip a = stripOf(cap_a), b = stripOf(cap_b);
    const auto thin = [](const Strip& s) { return (s.high - s.low) * (s.high - s.low) < kThin * s.length2; };
    Vec2 centre_both;
    double both = 0.0;
    if (thin(a) && thin(b) && crossing(a, moved_a, b, moved_b, &centre_both, &both) &&
        both < 0.5 * std::min(*radius, radius_b)) {
      *centre = centre_both;
      *radius = both;
      return;
    }
    // Beside a cap as wide as this all of the other most often lies.
    constexpr double kWide = 20.0;
    const bool wide_a = !thin(a) && *radius > kWide * radius_b,
               wide_b = !thin(b) && radius_b > kWide * *radius;
    if (wide_b) return;
    if (wide_a) {
      *centre = centre_b;
      *radius = radius_b;
      return;
    }
    convexHull(cap_a, buffers_.hull_a);
    convexHull(cap_b, buffers_.hull_b);
    grownIntersection(buffers_.hull_a, moved_a, buffers_.hull_b, moved_b, buffers_.both, buffers_.scratch);
    if (!buffers_.both.empty()) {
      enclosingDisc(buffers_.both, centre, radius);
      return;
    }
  }
  if (radius_b < *radius) {
    *centre = centre_b;
    *radius = radius_b;
  }
}

}  // namespace collision_node::impact

#include "collision_node/impact/facts/contact_facts.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "collision_node/impact/facts/contact_normal.h"

namespace collision_node::impact {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// `seen`: the core's points, least deep first.
Feature featureOf(const PosedCore& core, const std::vector<SeenPoint>& seen, const Vec3& n,
                  double tolerance) {
  const Element& e = *core.element;
  if (e.radius > 0.0) return Feature::kSmooth;
  if (e.vertices == nullptr) {
    const Vec3 local = core.rotation->transpose() * n;
    return std::abs(local.dot(e.axis)) > 1.0 - 1e-12 ? Feature::kFace : Feature::kSmooth;
  }
  std::size_t held = 0;
  while (held < seen.size() && seen[held].depth <= tolerance) ++held;
  return held == 1 ? Feature::kVertex : held == 2 ? Feature::kEdge : Feature::kFace;
}

/// Does a direction that parted the cores a moment ago show as much of a gap now as there can be? One along a
/// cylinder's axis, but for a trace, is the axis.
bool stillParts(const PairPiece& piece, const Cores& cores, const Vec3& direction, Vec3* n) {
  constexpr double kTrace = 1e-9;
  const double least = -2.0 * piece.point_error;
  *n = direction.normalized();
  for (const PosedCore* core : {&cores.a, &cores.b}) {
    if (core->element->vertices != nullptr) continue;
    const Vec3 axis = *core->rotation * core->element->axis;
    const double along = axis.dot(*n);
    if (std::abs(along) > 1.0 - kTrace && cores.gapAlong(std::copysign(1.0, along) * axis) >= least)
      *n = std::copysign(1.0, along) * axis;
  }
  return cores.gapAlong(*n) >= least;
}

/// The side's identity and witness, from a point of the contact in world axes relative to A's origin.
Side sideOf(const PosedCore& core, const Vec3& point, Feature feature) {
  Side side;
  side.shape = core.element->shape;
  side.triangle = core.element->triangle;
  side.feature = feature;
  side.point = core.rotation->transpose() * (point - core.origin);
  return side;
}

void addVelocities(const PairPiece& piece, const Instant& now, ContactFacts& f) {
  const RelativeMotion& m = piece.motion;
  f.relative_velocity = now.d_rate + m.omegaB().cross(f.position - now.d) - m.omegaA().cross(f.position);
  f.closing_speed = -f.relative_velocity.dot(f.normal);
}

/// What the world coordinates of a report add: A's origin is summed from terms of the world's size.
double worldRounding(const PairPiece& piece) {
  return 8.0 * kUnit * (piece.motion.worldScaleA() + piece.motion.maxDistance());
}

}  // namespace

ContactFacts describeContact(const PairPiece& piece, const Instant& now, double span, ElementPair pair,
                             double apart_at, const Earlier& earlier, const Parting* parting,
                             const Closest& start, ViewBuffers& buffers) {
  ContactFacts f;
  const RelativeMotion& m = piece.motion;
  Vec3 buffer_a[3], buffer_b[3];
  const Element ea = piece.a.element(pair.a, buffer_a), eb = piece.b.element(pair.b, buffer_b);
  const Cores cores(now, ea, eb);
  const double radius = ea.radius + eb.radius + piece.contact_distance;
  const double reach_a = coreReach(ea), reach_b = coreReach(eb);

  Closest closest;
  Vec3 n;
  if (radius > 0.0 || parting == nullptr || !stillParts(piece, cores, parting->at(now.t), &n)) {
    closest = closestPoints(cores, start);
    const Axis axis = axisOf(piece, now, closest, false);
    if (axis.valid) n = axis.direction;
    if (!axis.valid && !shallowestNormal(piece, cores, &n)) {
      ContactWitness witness;
      witness.element_a = pair.a;
      witness.element_b = pair.b;
      for (int i = 0; i < closest.count; ++i)
        witness.point += closest.weight[i] * (now.ra * closest.point[i].local_a);
      return describeOverlap(piece, now, witness);
    }
    if (radius == 0.0) n = bestNormal(piece, now, ea, eb, closest, n, apart_at);
    n.normalize();
  }
  const ContactView view(cores, n, buffers);
  const Turned turned{m.spinA() * span + earlier.angle, m.spinB() * span + earlier.angle};
  const double speed =
      m.velocity(now.t).norm() + span * m.maxAcceleration() + m.spinA() * reach_a + m.spinB() * reach_b;
  const double moved = speed * span + earlier.distance + 2.0 * piece.point_error;

  // Where contact falls within the span, the gap between the support planes is at most `moved`.
  const double gap = std::clamp(view.gap(), 0.0, radius + moved);
  const double depth = moved + std::max(0.0, radius - view.gap());

  // At the touch n' . w >= radius for every core difference then, so n' . w >= radius - moved now, while n .
  // w is at most height + radius + moved: sin(lean) l <= height + 2 moved.
  double cone = M_PI;
  if (radius > 0.0 && gap > 2.0 * moved)
    cone = roundedCone(piece, cores, closest, n, view.gap(), gap, moved, turned);
  cone = view.normalCone(2.0 * moved + std::max(0.0, -view.gap()), cone);
  cone = std::min(M_PI, cone + 32.0 * kUnit);
  f.normal = n;
  f.normal_error = cone;

  // The ball, in the plane across n: what is near both supports.
  Vec2 centre;
  double disc = 0.0;
  view.commonDisc(depth, cone, moved, moved + radius * std::sin(std::min(cone, M_PI_2)), &centre, &disc);
  // Along n the contact lies on A's support plane, grown by A's radius.
  const double share = radius > 0.0 ? ea.radius + 0.5 * piece.contact_distance : 0.0;
  const double sunk = radius > 0.0 ? 0.0 : 0.5 * std::max(0.0, -view.gap());
  f.position = view.place(centre, view.topOfA() + share - sunk);
  const double lean = share * 2.0 * std::sin(0.5 * cone);
  // World position at the instant of contact: either body's own motion over the span, the smaller one.
  const double own_a = (m.ownSpeedA() + m.spinA() * (reach_a + ea.radius)) * span;
  const double own_b = (m.ownSpeedB() + m.spinB() * (reach_b + eb.radius)) * span;
  const double own = std::min(own_a, own_b + moved) + earlier.distance;
  f.position_error = std::hypot(disc, depth) + lean + own + 2.0 * piece.point_error + worldRounding(piece);
  f.position_error *= 1.0 + 64.0 * kUnit;

  const double tolerance = moved + 1e-9 * (reach_a + reach_b);
  f.a = sideOf(cores.a, f.position, featureOf(cores.a, buffers.a, n, tolerance));
  f.b = sideOf(cores.b, f.position, featureOf(cores.b, buffers.b, n, tolerance));
  addVelocities(piece, now, f);
  return f;
}

ContactFacts describeUnknown(const PairPiece& piece, const Instant& now, double span) {
  ContactWitness witness;
  witness.point = now.ra * piece.a.centre();
  ContactFacts f = describeOverlap(piece, now, witness);
  f.position_error += span * (piece.any_speed + piece.speed);
  return f;
}

ContactFacts describeOverlap(const PairPiece& piece, const Instant& now, const ContactWitness& witness) {
  ContactFacts f;
  f.position = witness.point;
  f.normal = Vec3::Constant(kNaN);
  f.normal_error = M_PI;
  // Every shared point lies in the smaller bounding sphere.
  const Vec3 centre_a = now.ra * piece.a.centre(), centre_b = now.d + now.rb * piece.b.centre();
  const double from_a = (f.position - centre_a).norm() + piece.a.radius();
  const double from_b = (f.position - centre_b).norm() + piece.b.radius();
  f.position_error =
      std::min(from_a, from_b) + piece.contact_distance + piece.point_error + worldRounding(piece);
  if (witness.element_a >= 0) {
    Vec3 buffer_a[3], buffer_b[3];
    const Element ea = piece.a.element(witness.element_a, buffer_a),
                  eb = piece.b.element(witness.element_b, buffer_b);
    const Cores cores(now, ea, eb);
    f.a = sideOf(cores.a, f.position, Feature::kUnknown);
    f.b = sideOf(cores.b, f.position, Feature::kUnknown);
  } else {
    f.a.point = now.ra.transpose() * f.position;
    f.b.point = now.rb.transpose() * (f.position - now.d);
  }
  addVelocities(piece, now, f);
  f.closing_speed = kNaN;
  return f;
}

}  // namespace collision_node::impact

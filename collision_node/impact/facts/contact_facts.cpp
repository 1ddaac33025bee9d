#include "collision_node/impact/facts/contact_facts.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "collision_node/geometry/any_width.h"
#include "collision_node/impact/convex/closest_points.h"
#include "collision_node/impact/convex/near_support.h"
#include "collision_node/impact/facts/contact_normal.h"

namespace collision_node::impact {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// By how many of the core's vertices are as far along `out`, from the core to the other, as the farthest.
Feature featureOf(const PosedCore& core, const Vec3& out, double tolerance) {
  const Element& e = *core.element;
  if (e.radius > 0.0) return Feature::kSmooth;
  const Vec3 local = core.rotation->transpose() * out;
  if (e.vertices == nullptr)
    return std::abs(local.dot(e.axis)) > 1.0 - 1e-12 ? Feature::kFace : Feature::kSmooth;
  const double least = local.dot(supportOf(e, local)) - tolerance;
  const auto held =
      std::count_if(e.vertices, e.vertices + e.count, [&](const Vec3& v) { return local.dot(v) >= least; });
  return held <= 1 ? Feature::kVertex : held == 2 ? Feature::kEdge : Feature::kFace;
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

/// A direction from A to B along which the contact is to be seen, and closest points where it took them.
/// False where the cores have no volume to tell one.
bool proposeNormal(const PairPiece& piece, const Instant& now, const Cores& cores, double radius,
                   double apart_at, const Parting* parting, const Closest& start, Vec3* n, Closest* closest) {
  const Element &ea = *cores.a.element, &eb = *cores.b.element;
  if (radius > 0.0 && SlidingPoints::fit(ea, eb)) {
    SlidingPoints points(ea, eb);
    points.find(cores);
    *closest = points.closest(cores);
    if (!closest->overlap) {
      *n = points.direction().normalized();
      return true;
    }
  }
  if (radius == 0.0 && parting != nullptr && stillParts(piece, cores, parting->at(now.t), n)) return true;
  *closest = closestPoints(cores, start);
  const Axis axis = axisOf(piece, now, *closest, false);
  if (axis.valid) *n = axis.direction;
  if (!axis.valid && !shallowestNormal(piece, cores, n)) return false;
  if (radius == 0.0) *n = bestNormal(piece, now, ea, eb, *closest, *n, apart_at);
  n->normalize();
  return true;
}

/// A contact seen along a normal.
struct Sight {
  Vec3 n;       ///< unit, from A to B
  double cone;  ///< half angle about n that holds the true normal [rad]
  double gap;   ///< of the cores' support planes across n [m]
  Vec3 place;   ///< on A's support plane: the middle of the disc that holds both cores' share of the contact
  double disc = 0.0;                                                     ///< its radius [m]
  Feature feature_a = Feature::kUnknown, feature_b = Feature::kUnknown;  ///< where they are known
};

/// What may happen while the contact begins.
struct Change {
  double moved;  ///< [m] any point of one core against any of the other, budget included
  Turned turned;
};

/// Of a core that is one point, and another to which its nearest point is a clamp: all in closed form. False
/// where it is not, or where more is known than this tells. Derivation: docs/solver.md, "The ball".
bool seePoint(const PairPiece& piece, const Cores& cores, double radius, const Change& change, Sight* sight) {
  const Element &a = *cores.a.element, &b = *cores.b.element;
  const auto isPoint = [](const Element& e) { return e.vertices != nullptr && e.count == 1; };
  if (!(radius > 0.0) || !(isPoint(a) || isPoint(b)) || !SlidingPoints::fit(a, b)) return false;
  SlidingPoints points(a, b);
  points.find(cores);
  const double distance = points.distance(), moved = change.moved;
  const bool point_is_a = points.curveIsA(), two_points = isPoint(a) && isPoint(b);
  const Turned& both = change.turned;
  // A point's own turn moves nothing.
  const double turned = two_points ? std::min(both.a, both.b) : point_is_a ? both.b : both.a;
  constexpr double kMost = 1e-3;  // with less, nothing else tells more of the normal
  if (!(2.0 * moved < kMost * distance && turned < kMost)) return false;
  if (points.atCorner() && !two_points) return false;  // like a point: nobody's turn moves anything
  if (!point_is_a && points.onRim()) return false;     // A's cap is as small as B's
  const Vec3 n = points.outward() / distance;
  const double top = n.dot(cores.a.place(cores.a.supportLocal(n)));
  const double beyond = n.dot(cores.b.place(cores.b.supportLocal(-n))) - top;
  const double gap = std::min(beyond, radius + moved);
  if (!(2.0 * moved < kMost * gap)) return false;
  double cone = angleOf(2.0 * moved / gap) + 64.0 * piece.point_error / gap;
  // The point's way in the other's frame, which turns.
  if (points.onFace(2.0 * (moved + turned * distance))) {
    const RelativeMotion& m = piece.motion;
    cone = std::min(cone, 2.0 * (point_is_a ? m.rotationErrorB() : m.rotationErrorA()) + 64.0 * kUnit);
  }
  cone += turned + 32.0 * kUnit;
  *sight = {n, cone, beyond, point_is_a ? cores.a.place(a.vertices[0]) : cores.b.place(b.vertices[0]), moved};
  if (!point_is_a) {
    sight->place += n * (top - n.dot(sight->place));
    sight->disc += radius * sineOf(cone);
  }
  return true;
}

/// How deep below the support planes the contact's points lie at most. Where contact falls within the span,
/// the gap between these planes is at most `moved`.
double depthOf(double gap, double radius, double moved) { return moved + std::max(0.0, radius - gap); }

/// Along n in closed form, where the cores are sharp enough there for it; `closest` are about their closest
/// points.
bool seeNear(const PairPiece& piece, const Cores& cores, const Vec3& n, const Closest& closest, double radius,
             const Change& change, double tolerance, Sight* sight) {
  if (cores.a.element->frame == nullptr || cores.b.element->frame == nullptr || closest.count == 0)
    return false;
  const NearPair near(cores, n);
  Vec3 near_a = cores.a.origin, near_b = cores.b.origin;
  for (int i = 0; i < closest.count; ++i) {
    near_a += closest.weight[i] * (*cores.a.rotation * closest.point[i].local_a);
    near_b += closest.weight[i] * (*cores.b.rotation * closest.point[i].local_b);
  }
  const double moved = change.moved, gap = near.gap();
  double cone =
      near.normalCone(2.0 * moved + std::max(0.0, -gap), near_a, near_b, radius > moved && gap > 0.0)
          .value_or(M_PI);
  // The roundness tells at best what the way does over the radius.
  constexpr double kNoBetter = 8.0;
  const double most = std::min(gap, radius + moved);
  if (most > 2.0 * moved && cone * most > kNoBetter * moved)
    cone = std::min(cone, roundedCone(piece, cores, closest, n, gap, most, moved, change.turned));
  sight->n = n;
  sight->cone = cone + 32.0 * kUnit;
  sight->gap = gap;
  constexpr double kMost = 1e-3;
  if (!(sight->cone < kMost)) return false;  // points may tell more
  if (!near.commonDisc(depthOf(gap, radius, moved), sight->cone + change.turned.a,
                       sight->cone + change.turned.b, moved, moved + radius * sineOf(sight->cone),
                       &sight->place, &sight->disc))
    return false;
  if (cores.a.element->radius == 0.0) sight->feature_a = near.a().feature(tolerance);
  if (cores.b.element->radius == 0.0) sight->feature_b = near.b().feature(tolerance);
  return true;
}

/// Of any two cores; `closest` are their closest points where `radius` > 0.
Sight see(const PairPiece& piece, const Cores& cores, const ContactView& view, const Vec3& n,
          const Closest& closest, double radius, const Change& change) {
  const double moved = change.moved, gap = std::clamp(view.gap(), 0.0, radius + moved);
  // At the touch n' . w >= radius for every core difference then, so n' . w >= radius - moved now, while n .
  // w is at most height + radius + moved: sin(lean) l <= height + 2 moved.
  double cone = M_PI;
  if (radius > 0.0 && gap > 2.0 * moved)
    cone = roundedCone(piece, cores, closest, n, view.gap(), gap, moved, change.turned);
  cone = view.normalCone(2.0 * moved + std::max(0.0, -view.gap()), cone);
  cone = std::min(M_PI, cone + 32.0 * kUnit);
  // The ball, in the plane across n: what is near both supports.
  Vec2 centre;
  double disc = 0.0;
  view.commonDisc(depthOf(view.gap(), radius, moved), cone + change.turned.a, cone + change.turned.b, moved,
                  moved + radius * sineOf(cone), &centre, &disc);
  return {n, cone, view.gap(), view.place(centre, view.topOfA()), disc};
}

/// Cores that lie flat in one plane, a point on a triangle, are seen from both sides alike. On which one the
/// other is, only a gap beyond rounding tells, or what parted them before, or how thick they are: of the true
/// normal n' every difference w has w.n' >= -moved, the highest one, too, and near -n no n' has that.
bool tellsNoSide(const PairPiece& piece, const Cores& cores, const Vec3& n, double cone,
                 const Parting* parting, const Instant& now, double moved) {
  const double gap = cores.gapAlong(n);
  if (gap > piece.point_error || (parting != nullptr && parting->at(now.t).dot(n) > 0.0)) return false;
  const Vec3 w = cores.b.place(cores.b.supportLocal(n)) - cores.a.place(cores.a.supportLocal(-n));
  const double height = w.dot(n), across = (w - height * n).norm(), lean = std::min(cone, M_PI - cone);
  return !(std::cos(lean) * height > 2.0 * moved + std::max(0.0, -gap) + std::sin(lean) * across);
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

/// [m] No point of the core, grown by its radius, is farther from `x`, both from A's origin.
double farthestFrom(const PosedCore& core, const Vec3& x) {
  const Element& e = *core.element;
  double farthest = e.vertices == nullptr
                        ? (core.place(e.centre) - x).norm() + std::hypot(e.rim_radius, e.half_length)
                        : 0.0;
  for (int i = 0; i < e.count; ++i) farthest = std::max(farthest, (core.place(e.vertices[i]) - x).norm());
  return farthest + e.radius;
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

/// Across a core that is a triangle, to either side; NaN where neither core has such a direction.
Vec3 eitherSide(const Cores& cores) {
  for (const PosedCore* core : {&cores.a, &cores.b}) {
    const Element& e = *core->element;
    if (e.vertices == nullptr || e.count != 3) continue;
    const Vec3 n = (e.vertices[1] - e.vertices[0]).cross(e.vertices[2] - e.vertices[0]);
    const double length = n.stableNorm();
    if (length > 0.0) return *core->rotation * (n / length);
  }
  return Vec3::Constant(kNaN);
}

/// The side on which the bodies come together at an impact, and part at a separation.
void takeLikelierSide(ContactFacts& f, bool is_impact) {
  if (is_impact != (f.closing_speed < 0.0)) return;
  f.normal = -f.normal;
  f.closing_speed = -f.closing_speed;
}

/// Of cores that lie in one plane, exactly, so that nothing tells on which side: every shared point lies in
/// both, which move by `own_a` and `own_b` [m] while the contact begins.
ContactFacts describeFlush(const PairPiece& piece, const Instant& now, const Cores& cores,
                           const Closest& closest, double own_a, double own_b, const Earlier& earlier,
                           bool is_impact) {
  ContactFacts f;
  for (int i = 0; i < closest.count; ++i)
    f.position += closest.weight[i] * (now.ra * closest.point[i].local_a);
  f.normal = eitherSide(cores);
  f.normal_error = M_PI;
  f.position_error =
      std::min(farthestFrom(cores.a, f.position) + own_a, farthestFrom(cores.b, f.position) + own_b) +
      piece.contact_distance + earlier.distance + 2.0 * piece.point_error + worldRounding(piece);
  f.position_error *= 1.0 + 64.0 * kUnit;
  f.a = sideOf(cores.a, f.position, Feature::kUnknown);
  f.b = sideOf(cores.b, f.position, Feature::kUnknown);
  addVelocities(piece, now, f);
  if (!f.normal.allFinite() && f.relative_velocity.stableNorm() > 0.0) {  // a guess is better than none
    f.normal = -f.relative_velocity.stableNormalized();
    f.closing_speed = -f.relative_velocity.dot(f.normal);
  }
  takeLikelierSide(f, is_impact);
  return f;
}

}  // namespace

COLLISION_NODE_ANY_WIDTH
ContactFacts describeContact(const PairPiece& piece, const Instant& now, ElementPair pair,
                             const Bracketed& when, const Proposal& proposal, ViewBuffers& buffers) {
  ContactFacts f;
  const RelativeMotion& m = piece.motion;
  const ElementView view_a(piece.a, pair.a), view_b(piece.b, pair.b);
  const Element &ea = *view_a, &eb = *view_b;
  const Cores cores(now, ea, eb);
  const double radius = ea.radius + eb.radius + piece.contact_distance;
  const bool is_impact = when.apart_at == 0.0;
  const double span = when.span;
  const Earlier& earlier = when.earlier;
  // What parted them before a contact may have done so from the other side: from within a solid, or in front
  // of a surface that was passed.
  const Parting* parting = proposal.parting;
  if (!is_impact && parting != nullptr &&
      !(cores.gapAlong(parting->at(now.t).normalized()) > piece.point_error))
    parting = nullptr;
  const double reach_a = coreReach(ea), reach_b = coreReach(eb);

  const Turned turned{m.spinA() * span + earlier.angle + m.rotationErrorA(),
                      m.spinB() * span + earlier.angle + m.rotationErrorB()};
  const double speed =
      m.velocity(now.t).norm() + span * m.maxAcceleration() + m.spinA() * reach_a + m.spinB() * reach_b;
  const double moved = speed * span + earlier.distance + 2.0 * piece.point_error;

  const double tolerance = moved + 1e-9 * (reach_a + reach_b);  // of features
  // World position at the instant of contact: either body's own motion over the span, the smaller one.
  const double own_a = (m.ownSpeedA() + m.spinA() * (reach_a + ea.radius)) * span;
  const double own_b = (m.ownSpeedB() + m.spinB() * (reach_b + eb.radius)) * span;
  Sight sight;
  if (!seePoint(piece, cores, radius, {moved, turned}, &sight)) {
    Closest closest;
    Vec3 n;
    if (!proposeNormal(piece, now, cores, radius, when.apart_at, parting, proposal.closest, &n, &closest))
      return describeFlush(piece, now, cores, closest, own_a, own_b, earlier, is_impact);
    const Closest& about = closest.count > 0 ? closest : proposal.closest;
    if (!seeNear(piece, cores, n, about, radius, {moved, turned}, tolerance, &sight))
      sight = see(piece, cores, ContactView(cores, n, buffers), n, closest, radius, {moved, turned});
  }
  const bool no_side = tellsNoSide(piece, cores, sight.n, sight.cone, parting, now, moved);
  if (no_side) sight.cone = M_PI;
  const double cone = sight.cone;
  f.normal = sight.n;
  f.normal_error = cone;

  // Along n the contact lies on A's support plane, grown by A's radius.
  const double share = radius > 0.0 ? ea.radius + 0.5 * piece.contact_distance : 0.0;
  const double sunk = radius > 0.0 ? 0.0 : 0.5 * std::max(0.0, -sight.gap);
  f.position = sight.place + (share - sunk) * sight.n;
  const double lean = share * 2.0 * sineOf(0.5 * cone);
  const double own = std::min(own_a, own_b + moved) + earlier.distance;
  const double depth = depthOf(sight.gap, radius, moved);
  f.position_error = std::sqrt(sight.disc * sight.disc + depth * depth) + lean + own +
                     2.0 * piece.point_error + worldRounding(piece);
  f.position_error *= 1.0 + 64.0 * kUnit;

  if (sight.feature_a == Feature::kUnknown) sight.feature_a = featureOf(cores.a, sight.n, tolerance);
  if (sight.feature_b == Feature::kUnknown) sight.feature_b = featureOf(cores.b, -sight.n, tolerance);
  f.a = sideOf(cores.a, f.position, sight.feature_a);
  f.b = sideOf(cores.b, f.position, sight.feature_b);
  addVelocities(piece, now, f);
  if (no_side) takeLikelierSide(f, is_impact);
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

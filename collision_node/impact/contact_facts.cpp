#include "collision_node/impact/contact_facts.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "collision_node/impact/gap_model.h"
#include "collision_node/impact/polygon.h"

namespace collision_node::impact {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Points of the core that tell its extent: all vertices, or corners and rim points of a cylinder
/// (inscribed).
std::vector<Vec3> samplePoints(const PosedCore& core, const Vec3& n) {
  const Element& e = *core.element;
  std::vector<Vec3> points;
  if (e.vertices != nullptr) {
    for (int i = 0; i < e.count; ++i) points.push_back(core.place(e.vertices[i]));
    return points;
  }
  const Vec3 local = core.rotation->transpose() * n;
  Vec3 across = local - local.dot(e.axis) * e.axis;
  if (across.norm() < 1e-9) across = e.axis.unitOrthogonal();
  across.normalize();
  const Vec3 other = e.axis.cross(across);
  for (const double end : {-e.half_length, e.half_length}) {
    for (const double angle : {0.0, 1e-4, -1e-4, 1e-2, -1e-2, 0.3, -0.3, 1.5, -1.5, 3.0}) {
      points.push_back(core.place(e.centre + end * e.axis +
                                  e.rim_radius * (std::cos(angle) * across + std::sin(angle) * other)));
    }
  }
  return points;
}

/// Corner points of a set that holds every point of the core within `depth` of its support plane along n.
/// `tilt` bounds how far the true support direction may lean from n [rad].
std::vector<Vec3> capPoints(const PosedCore& core, const Vec3& n, double depth, double tilt) {
  const Element& e = *core.element;
  std::vector<Vec3> cap;
  if (e.vertices != nullptr) {
    std::vector<Vec3> points;
    double top = -std::numeric_limits<double>::infinity();
    for (int i = 0; i < e.count; ++i) {
      points.push_back(core.place(e.vertices[i]));
      top = std::max(top, n.dot(points.back()));
    }
    const double floor = top - depth;
    for (const Vec3& p : points) {
      if (n.dot(p) >= floor) cap.push_back(p);
    }
    for (const Vec3& p : points) {
      if (n.dot(p) < floor) continue;
      for (const Vec3& q : points) {
        const double high = n.dot(p), low = n.dot(q);
        if (low < floor) cap.push_back(p + (q - p) * ((high - floor) / (high - low)));
      }
    }
    return cap;
  }
  const Vec3 local = core.rotation->transpose() * n;
  const double along = local.dot(e.axis);
  Vec3 across = local - along * e.axis;
  const double radial = across.norm();
  if (radial > 0.0) {
    across /= radial;
  } else {
    across = e.axis.unitOrthogonal();
  }
  const Vec3 other = e.axis.cross(across);
  const double r = e.rim_radius;
  const double z_low =
      std::abs(along) > 0.0 ? std::max(-1.0, 1.0 - depth / (std::abs(along) * e.half_length)) : -1.0;
  const double x_low = radial > 0.0 ? std::max(-r, r - depth / radial) : -r;
  double side = x_low > 0.0 ? std::sqrt(std::max(0.0, r * r - x_low * x_low)) : r;
  if (radial > 0.0 && tilt < 0.5 * radial) side = std::min(side, r * std::sin(2.0 * tilt / radial));
  const double sign = along >= 0.0 ? 1.0 : -1.0;
  for (const double z : {z_low, 1.0}) {
    for (const double x : {x_low, r}) {
      for (const double y : {-side, side}) {
        cap.push_back(core.place(e.centre + sign * z * e.half_length * e.axis + x * across + y * other));
      }
    }
  }
  return cap;
}

Feature featureOf(const PosedCore& core, const Vec3& n, double tolerance) {
  const Element& e = *core.element;
  if (e.radius > 0.0) return Feature::kSmooth;
  if (e.vertices == nullptr) {
    const Vec3 local = core.rotation->transpose() * n;
    return std::abs(local.dot(e.axis)) > 1.0 - 1e-12 ? Feature::kFace : Feature::kSmooth;
  }
  double top = -std::numeric_limits<double>::infinity();
  for (int i = 0; i < e.count; ++i) top = std::max(top, n.dot(core.place(e.vertices[i])));
  int held = 0;
  for (int i = 0; i < e.count; ++i) held += n.dot(core.place(e.vertices[i])) >= top - tolerance;
  return held == 1 ? Feature::kVertex : held == 2 ? Feature::kEdge : Feature::kFace;
}

/// Half angle of a cone about n that holds every direction n' with n' . (b - a) >= -moved for all sampled
/// points: if the differences that lie within h of the plane surround the origin up to radius l, sin(angle)
/// <= (moved + h)/l.
double normalConeFromPoints(const std::vector<Vec3>& pa, const std::vector<Vec3>& pb, const Vec3& n,
                            const Vec3& e1, const Vec3& e2, double gap, double moved) {
  struct Difference {
    double height;
    Vec2 across;
  };
  if (pa.size() * pb.size() > 4096) return M_PI;
  std::vector<Difference> all;
  for (const Vec3& a : pa) {
    for (const Vec3& b : pb) {
      const Vec3 w = b - a;
      all.push_back({std::max(0.0, n.dot(w) - gap), {e1.dot(w), e2.dot(w)}});
    }
  }
  std::sort(all.begin(), all.end(),
            [](const Difference& x, const Difference& y) { return x.height < y.height; });
  double widest = 0.0;  // no hull holds a larger disc
  for (const Difference& d : all) widest = std::max(widest, d.across.norm());
  constexpr double kLevel = 1.2;  // heights this close are one level: a hull for each would tell little more
  double best_sine = 1.0, level = -1.0;
  Polygon used;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const double sine_low = moved + all[i].height;
    if (!(sine_low < best_sine * widest)) break;
    if (level < 0.0) level = sine_low;
    used.push_back(all[i].across);
    if (i + 1 < all.size() && moved + all[i + 1].height <= level * kLevel) continue;
    level = -1.0;
    if (used.size() < 3) continue;
    const double l = discInHull(used);
    if (l > sine_low) best_sine = std::min(best_sine, sine_low / l);
    if (used.size() > 64) break;
  }
  return best_sine < 1.0 ? std::asin(best_sine) * (1.0 + 64.0 * kUnit) : M_PI;
}

/// How far the computed closest vector may lean from the exact one [rad].
/// Any answer: |v - v*|^2 <= |v|^2 - v . w for the farthest w (the duality gap). Where every vertex outside
/// the simplex lies clearly beyond its plane, the exact closest point is in the simplex too, and a point or
/// segment is well conditioned: the error is of first order.
double directionError(const PairPiece& piece, const Cores& cores, const Closest& closest, double gap) {
  const double length = closest.v.norm();
  const double dual = std::sqrt((std::max(0.0, length - gap) + 8.0 * piece.point_error) / length);
  if (closest.exact) return 64.0 * piece.point_error / gap;
  if (closest.count > 2) return dual;
  const Element &a = *cores.a.element, &b = *cores.b.element;
  if (a.vertices == nullptr || b.vertices == nullptr) return dual;
  for (int i = 0; i < a.count; ++i) {
    for (int j = 0; j < b.count; ++j) {
      const Vec3 w = cores.b.place(b.vertices[j]) - cores.a.place(a.vertices[i]);
      bool in_simplex = false;
      for (int k = 0; k < closest.count; ++k) {
        in_simplex |= closest.point[k].local_a == a.vertices[i] && closest.point[k].local_b == b.vertices[j];
      }
      if (!in_simplex && !(w.dot(closest.v) > length * (length + 16.0 * piece.point_error))) return dual;
    }
  }
  return 64.0 * piece.point_error / gap;
}

/// Is one side's part in the closest points a single vertex, and too far ahead of its other vertices to lose
/// that while everything moves by `moved` and the normal by `lean`? Then that side is as good as a point.
bool staysOneVertex(const Cores& cores, const Closest& closest, bool side_a, const Vec3& n, double gap,
                    double moved, double lean) {
  const PosedCore& core = side_a ? cores.a : cores.b;
  if (core.element->vertices == nullptr) return false;
  const Vec3 held = side_a ? closest.point[0].local_a : closest.point[0].local_b;
  for (int i = 1; i < closest.count; ++i) {
    if ((side_a ? closest.point[i].local_a : closest.point[i].local_b) != held) return false;
  }
  const double sign = side_a ? -1.0 : 1.0;
  for (int i = 0; i < core.element->count; ++i) {
    const Vec3& v = core.element->vertices[i];
    if (v == held) continue;
    const Vec3 e = *core.rotation * (v - held);
    if (!(sign * n.dot(e) > 4.0 * moved + e.norm() * lean + std::max(0.0, closest.v.norm() - gap)))
      return false;
  }
  return true;
}

/// At a contact closest points no longer tell a direction. The best of: the features' own normals, and the
/// axes of instants at which the two were still (or again) well apart, turned on to now.
Vec3 bestNormal(const PairPiece& piece, const Instant& now, const Element& ea, const Element& eb,
                const Closest& closest, const Vec3& first, double apart_at) {
  const Cores cores(now, ea, eb);
  Vec3 best = first;
  double best_gap = cores.gapAlong(first);
  // No axis shows a larger gap than the distance of two points.
  const double most = closest.v.norm();
  if (best_gap > (1.0 - 1e-6) * most - 2.0 * piece.point_error) return best;
  const auto propose = [&](const Vec3& direction) {
    const double length = direction.norm();
    if (!(length > 0.0)) return;
    const double gap = cores.gapAlong(direction / length);
    if (gap > best_gap) {
      best_gap = gap;
      best = direction / length;
    }
  };
  for (const Axis& axis : featureAxes(piece, now, ea, eb)) propose(axis.direction);
  const double whole = apart_at - now.t;
  const double size = std::min(coreReach(ea), coreReach(eb)) + piece.point_error;
  for (double share = 1e-2; share > 1e-9; share *= 0.1) {
    const double step = std::copysign(std::min(std::abs(whole), share * size / piece.speed), whole);
    if (step == 0.0) break;
    const Instant then = piece.at(now.t + step);
    const Axis axis = axisOf(piece, then, closestPoints(Cores(then, ea, eb), Vec3::Zero()), false);
    if (!axis.valid) continue;
    propose(axis.direction - step * axis.rate);
    propose(axis.direction);
  }
  return best;
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
                             double apart_at, const Earlier& earlier) {
  ContactFacts f;
  const RelativeMotion& m = piece.motion;
  Vec3 buffer_a[3], buffer_b[3];
  const Element ea = piece.a.element(pair.a, buffer_a), eb = piece.b.element(pair.b, buffer_b);
  const Cores cores(now, ea, eb);
  const double radius = ea.radius + eb.radius + piece.contact_distance;
  const double reach_a = coreReach(ea), reach_b = coreReach(eb);

  const Closest closest = closestPoints(cores, Vec3::Zero());
  Axis axis = axisOf(piece, now, closest, false);
  if (!axis.valid) {
    Wrap wrap;
    const double size = reach_a + reach_b + piece.point_error;
    buildWrap(cores, 4.0 * size, wrap);  // grows until the nearest face is a face of the difference
    double nearest = std::numeric_limits<double>::infinity();
    for (const auto& face : wrap.faces) {
      const Vec3 &a = wrap.points[face[0]].w, &b = wrap.points[face[1]].w, &c = wrap.points[face[2]].w;
      const Vec3 normal = (b - a).cross(c - a).normalized();
      if (normal.squaredNorm() > 0.5 && normal.dot(a) < nearest) {
        nearest = normal.dot(a);
        axis.direction = -normal;
        axis.valid = true;
      }
    }
  }
  if (!axis.valid) {
    ContactWitness witness;
    witness.element_a = pair.a;
    witness.element_b = pair.b;
    for (int i = 0; i < closest.count; ++i)
      witness.point += closest.weight[i] * (now.ra * closest.point[i].local_a);
    return describeOverlap(piece, now, witness);
  }
  if (radius == 0.0) axis.direction = bestNormal(piece, now, ea, eb, closest, axis.direction, apart_at);
  const Vec3 n = axis.direction.normalized();
  const Vec3 e1 = n.unitOrthogonal(), e2 = n.cross(e1);
  const double turned = (m.spinA() + m.spinB()) * span + earlier.angle;
  const double speed =
      m.velocity(now.t).norm() + span * m.maxAcceleration() + m.spinA() * reach_a + m.spinB() * reach_b;
  const double moved = speed * span + earlier.distance + 2.0 * piece.point_error;

  // Heights of the two support planes; where contact falls within the span, the gap between them is at most
  // `moved`.
  const double top_a = n.dot(cores.a.place(cores.a.supportLocal(n)));
  const double low_b = n.dot(cores.b.place(cores.b.supportLocal(-n)));
  const double gap = std::clamp(low_b - top_a, 0.0, radius + moved);
  const double depth = moved + std::max(0.0, radius - (low_b - top_a));

  // The normal.
  // At the touch n' . w >= radius for every core difference then, so n' . w >= radius - moved now, while n .
  // w is at most height + radius + moved: sin(lean) l <= height + 2 moved.
  double cone = normalConeFromPoints(samplePoints(cores.a, n), samplePoints(cores.b, n), n, e1, e2,
                                     low_b - top_a, 2.0 * moved + std::max(0.0, top_a - low_b));
  if (radius > 0.0 && gap > 2.0 * moved) {
    // A single point's closest vector moves at most twice as far as the point does in the other's frame.
    const double lean =
        std::asin(std::min(1.0, 2.0 * moved / gap)) + directionError(piece, cores, closest, gap);
    const bool single = staysOneVertex(cores, closest, true, n, low_b - top_a, moved, lean + turned) ||
                        staysOneVertex(cores, closest, false, n, low_b - top_a, moved, lean + turned);
    const double any = std::acos((gap - moved) / (closest.v.norm() + moved));
    cone = std::min({cone, single ? lean : M_PI, any});
  }
  cone = std::min(M_PI, cone + turned + 32.0 * kUnit);
  f.normal = n;
  f.normal_error = cone;

  // The ball, in the plane across n: what is near both supports.
  const double tilt = std::min(cone, M_PI);
  const auto project = [&](const std::vector<Vec3>& points) {
    Polygon flat;
    for (const Vec3& p : points) flat.push_back({e1.dot(p), e2.dot(p)});
    return flat;
  };
  const Polygon cap_a = grownHull(project(capPoints(cores.a, n, depth, tilt)), moved);
  const Polygon cap_b = grownHull(project(capPoints(cores.b, -n, depth, tilt)),
                                  moved + radius * std::sin(std::min(tilt, M_PI_2)));
  Polygon region = intersection(cap_a, cap_b);
  if (region.empty()) region = cap_a.size() < cap_b.size() ? cap_a : cap_b;
  Vec2 centre;
  double disc = 0.0;
  enclosingDisc(region, &centre, &disc);
  // Along n the contact lies on A's support plane, grown by A's radius.
  const double share = radius > 0.0 ? (ea.radius + 0.5 * piece.contact_distance) : 0.0;
  f.position = n * (top_a + share - (radius > 0.0 ? 0.0 : 0.5 * std::max(0.0, top_a - low_b))) +
               e1 * centre.x() + e2 * centre.y();
  const double lean = share * 2.0 * std::sin(0.5 * std::min(tilt, M_PI));
  // World position at the instant of contact: either body's own motion over the span, the smaller one.
  const double own_a = (m.ownSpeedA() + m.spinA() * (reach_a + ea.radius)) * span;
  const double own_b = (m.ownSpeedB() + m.spinB() * (reach_b + eb.radius)) * span;
  const double own = std::min(own_a, own_b + moved) + earlier.distance;
  f.position_error = std::hypot(disc, depth) + lean + own + 2.0 * piece.point_error + worldRounding(piece);
  f.position_error *= 1.0 + 64.0 * kUnit;

  const double tolerance = moved + 1e-9 * (reach_a + reach_b);
  f.a = sideOf(cores.a, f.position, featureOf(cores.a, n, tolerance));
  f.b = sideOf(cores.b, f.position, featureOf(cores.b, -n, tolerance));
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

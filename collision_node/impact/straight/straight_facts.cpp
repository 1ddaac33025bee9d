#include "collision_node/impact/straight/straight_facts.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "collision_node/geometry/normal_cone.h"
#include "collision_node/impact/straight/closest_on_triangle.h"

namespace collision_node::impact {
namespace {

using Met = PathContact::Met;

/// At least the arc sine of x in [0, 1]. Where x is small, x^3/6 and all that follows are below 1e-12 x.
double asinUp(double x) { return x < 1e-6 ? x * (1.0 + 1e-12) : std::asin(x) * kUp; }

/// Where one triangle is met, in the triangles' frame.
struct Place {
  Vec3 point, direction;     ///< the contact; unit, from the triangle to the path's point
  double point_error = 0.0;  ///< [m] over the bracket
  double cone = 0.0;         ///< [rad] half angle about the direction
  Feature feature = Feature::kFace;
};

/// A point passes: the place is its own, the direction the face's, against the motion. An exact passage is
/// through the inside of a triangle, whose only common support plane is its own, or through what the listed
/// triangles share.
Place placeOfPoint(const StraightPath& path, const PathContact& contact, const Met& met) {
  const Vec3* vertices = path.triangles().vertices();
  const Vec3 &a = vertices[met.vertex[0]], e1 = vertices[met.vertex[1]] - a, e2 = vertices[met.vertex[2]] - a;
  const Vec3 n = e1.cross(e2);
  // Rounded, and of corners that were placed in the object's frame: an edge is off by twice that.
  const double l1 = e1.lpNorm<1>(), l2 = e2.lpNorm<1>(), off = 2.0 * path.mesh().placingError();
  const double length = n.norm(), error = 16.0 * kUnit * l1 * l2 + off * (l1 + l2 + off);
  Place place;
  place.point = path.at(contact.lower);
  place.direction = n.dot(path.velocity()) > 0.0 ? Vec3(-n / length) : Vec3(n / length);
  place.point_error = path.error();
  place.cone = error < length ? asinUp(error / length) : M_PI;
  return place;
}

/// A sphere touches: the place is the triangle's closest point, which moves no faster than the centre does.
Place placeOfSphere(const StraightPath& path, const PathContact& contact, const Met& met) {
  const double contact_distance = path.contactDistance();
  const Vec3* vertices = path.triangles().vertices();
  const Vec3 x = path.at(contact.lower);
  const Vec3 corner[3] = {vertices[met.vertex[0]], vertices[met.vertex[1]], vertices[met.vertex[2]]};
  const Vec3 closest = closestOnTriangle(x, corner[0], corner[1], corner[2]), away = x - closest;
  const double distance = away.norm(), moved = path.velocity().norm() * (contact.upper - contact.lower) * kUp;
  Place place;
  place.direction = away / distance;
  place.point = closest + 0.5 * contact_distance * place.direction;
  // Nearer points q of the triangle than the computed one have |q - closest|^2 <= 2 away.(q - closest).
  double beyond = 0.0, top = -std::numeric_limits<double>::infinity(), reach = 0.0;
  for (const Vec3& v : corner) {
    beyond = std::max(beyond, place.direction.dot(v - closest));
    top = std::max(top, place.direction.dot(v));
    reach = std::max(reach, (v - closest).norm());
  }
  const double rounding = 16.0 * kUnit * (reach + distance) + 0.1 * path.error();
  place.point_error = moved + path.error() + std::sqrt(2.0 * distance * (beyond + rounding));
  const double turned = moved + path.error() + place.point_error;
  place.cone = turned < distance ? asinUp(turned / distance) : M_PI;
  place.point_error += std::min(place.cone, 2.0) * 0.5 * contact_distance;
  const double tolerance = moved + path.error() + 1e-9 * reach;
  int held = 0;
  for (const Vec3& v : corner) held += place.direction.dot(v) >= top - tolerance;
  place.feature = held == 1 ? Feature::kVertex : held == 2 ? Feature::kEdge : Feature::kFace;
  return place;
}

/// What all the triangles of a passage share.
Feature sharedFeature(const PathContact& contact) {
  if (contact.count == 1) return Feature::kFace;
  int shared = 0;
  for (const std::int32_t v : contact.met[0].vertex) {
    shared += std::all_of(contact.met, contact.met + contact.count, [&](const Met& met) {
      return std::find(met.vertex, met.vertex + 3, v) != met.vertex + 3;
    });
  }
  return shared == 1 ? Feature::kVertex : shared == 2 ? Feature::kEdge : Feature::kFace;
}

Pose poseAt(const motion::RigidMotion& motion, double s) {
  if (!motion.turns()) return {motion.c[0] + s * motion.c[1], motion.q0};
  return motion.at(s);
}

}  // namespace

__attribute__((flatten)) void writeStraight(const Piece& piece, const PairOptions& options,
                                            const StraightPath& path, const PathContact& contact,
                                            PairEvent& event) {
  const auto placeOf = [&](const Met& met) {
    return path.radius() > 0.0 ? placeOfSphere(path, contact, met) : placeOfPoint(path, contact, met);
  };
  Place place = placeOf(contact.met[0]);
  if (path.radius() == 0.0) place.feature = sharedFeature(contact);
  const double same_place = 0.5 * options.distance_precision;
  for (int i = 1; i < contact.count; ++i) {
    const Place other = placeOf(contact.met[i]);
    const double needed = (other.point - place.point).norm() + other.point_error;
    if (needed > std::max(2.0 * place.point_error, same_place)) {
      event.multiple = true;
      continue;
    }
    place.point_error = std::max(place.point_error, needed * kUp);
    place.cone = geometry::coneOfBoth(place.direction, place.cone, other.direction, other.cone);
  }

  const motion::LinearPart& line = path.line();
  const bool point_is_a = path.pointIsA();
  const double t = contact.lower, span = contact.upper - contact.lower;
  event.kind = Kind::kImpact;
  event.certificate = Certificate::kConfirmed;
  event.reason = span > options.time_precision ? Reason::kPrecision : Reason::kNone;
  event.interval_start_ns = piece.start_ns;
  event.interval_end_ns = piece.end_ns;
  event.toi_lower = contact.lower;
  event.toi_upper = contact.upper;
  event.a.pose = poseAt(piece.a, line.offset_a + t);
  event.b.pose = poseAt(piece.b, line.offset_b + t);
  event.a.sample_before_ns = piece.a.start_ns;
  event.a.sample_after_ns = piece.a.end_ns;
  event.b.sample_before_ns = piece.b.start_ns;
  event.b.sample_after_ns = piece.b.end_ns;

  const Vec3 apart = line.d + t * line.rate, in_world = path.inWorld(place.point);
  const Vec3 position = point_is_a ? Vec3(apart + in_world) : in_world;  // relative to A's origin
  event.position = event.a.pose.position + position;
  event.normal = path.inWorld(place.direction);
  if (point_is_a) event.normal = -event.normal;
  event.normal_error = std::min(M_PI, place.cone + 2.0 * StraightPath::kTurnError + 32.0 * kUnit);
  // In the world the place moves with the triangles and over them; a point's, at most as fast as the point.
  const double speed_a = piece.a.c[1].norm() * kUp, speed_b = piece.b.c[1].norm() * kUp;
  const double with_triangles = (point_is_a ? speed_b : speed_a) * span;
  const double with_point = (point_is_a ? speed_a : speed_b) * span;
  const double world = piece.a.c[0].norm() + speed_a * (std::abs(line.offset_a) + line.duration);
  event.position_error =
      path.radius() > 0.0 ? with_triangles : std::min(with_point, with_triangles + path.speed() * span);
  event.position_error += place.point_error + path.pointError() + 8.0 * kUnit * (world + path.maxDistance());
  event.position_error *= kUp;
  event.relative_velocity = line.rate;

  const std::int32_t element = contact.met[0].element;
  const Element& single = path.single().primitive(0);
  Side &triangle_side = point_is_a ? event.b : event.a, &point_side = point_is_a ? event.a : event.b;
  triangle_side.shape = path.mesh().shapeOf(element);
  triangle_side.triangle = path.mesh().triangleOf(element);
  triangle_side.feature = place.feature;
  triangle_side.point = place.point;
  point_side.shape = single.shape;
  if (path.radius() == 0.0) {  // it is the vertex, which its body's spin does not move
    point_side.feature = Feature::kVertex;
    point_side.point = single.vertices[0];
  } else {
    const Vec3 arm = point_is_a ? position : Vec3(position - apart);
    const Vec3 turning = (point_is_a ? piece.a : piece.b).omega.cross(arm);
    event.relative_velocity += point_is_a ? Vec3(-turning) : turning;
    point_side.feature = single.radius > 0.0 ? Feature::kSmooth : Feature::kVertex;
    point_side.point = point_side.pose.orientation.normalized().conjugate() * arm;
  }
  event.closing_speed = -event.relative_velocity.dot(event.normal);
}

PairEvent separationBehind(PairEvent impact) {
  impact.kind = Kind::kSeparation;
  impact.normal = -impact.normal;
  impact.closing_speed = -impact.closing_speed;
  return impact;
}

PairState::Phase phaseBehind(const StraightPath& path, const PathContact& contact) {
  if (path.radius() > 0.0) return PairState::Phase::kTouching;
  bool into_solid = false;
  for (int i = 0; i < contact.count; ++i) {
    const int shape = path.mesh().shapeOf(contact.met[i].element);
    for (const int solid : path.mesh().solids()) into_solid = into_solid || solid == shape;
  }
  if (!into_solid) return PairState::Phase::kApart;
  return contact.count == 1 && contact.met[0].sure ? PairState::Phase::kTouching
                                                   : PairState::Phase::kUndecided;
}

}  // namespace collision_node::impact

#include "collision_node/impact/straight_facts.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace collision_node::impact {
namespace {

using Met = PathContact::Met;

constexpr double kUp = 1.0 + 64.0 * kUnit;

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
  const double length = n.norm(), error = 16.0 * kUnit * e1.lpNorm<1>() * e2.lpNorm<1>();
  Place place;
  place.point = path.at(contact.lower);
  place.direction = n.dot(path.velocity()) > 0.0 ? Vec3(-n / length) : Vec3(n / length);
  place.point_error = path.error();
  place.cone = error < length ? std::asin(error / length) : M_PI;
  return place;
}

/// A sphere touches: the place is the triangle's closest point, which moves no faster than the centre does.
Place placeOfSphere(const StraightPath& path, const PathContact& contact, const Met& met,
                    double contact_distance) {
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
  place.cone = turned < distance ? std::asin(turned / distance) : M_PI;
  place.point_error += std::min(place.cone, 2.0) * 0.5 * contact_distance;
  const double tolerance = moved + path.error() + 1e-9 * reach;
  int held = 0;
  for (const Vec3& v : corner) held += place.direction.dot(v) >= top - tolerance;
  place.feature = held == 1 ? Feature::kVertex : held == 2 ? Feature::kEdge : Feature::kFace;
  return place;
}

/// What all the triangles of a passage share.
Feature sharedFeature(const PathContact& contact) {
  int shared = 0;
  for (const std::int32_t v : contact.met[0].vertex) {
    shared += std::all_of(contact.met, contact.met + contact.count, [&](const Met& met) {
      return std::find(met.vertex, met.vertex + 3, v) != met.vertex + 3;
    });
  }
  return shared == 1 ? Feature::kVertex : shared == 2 ? Feature::kEdge : Feature::kFace;
}

}  // namespace

StraightFacts describeStraight(const PairPiece& piece, const StraightPath& path, const PathContact& contact,
                               double same_place) {
  const auto placeOf = [&](const Met& met) {
    return path.radius() > 0.0 ? placeOfSphere(path, contact, met, piece.contact_distance)
                               : placeOfPoint(path, contact, met);
  };
  StraightFacts result;
  Place place = placeOf(contact.met[0]);
  if (path.radius() == 0.0) place.feature = sharedFeature(contact);
  for (int i = 1; i < contact.count; ++i) {
    const Place other = placeOf(contact.met[i]);
    const double needed = (other.point - place.point).norm() + other.point_error;
    if (needed > std::max(2.0 * place.point_error, same_place)) {
      result.multiple = true;
      continue;
    }
    place.point_error = std::max(place.point_error, needed * kUp);
    const double lean = 2.0 * std::asin(std::min(1.0, 0.5 * (other.direction - place.direction).norm()));
    // Written so that NaN widens to "unknown".
    if (!(lean + other.cone <= place.cone)) place.cone = lean + other.cone < M_PI ? lean + other.cone : M_PI;
  }

  const RelativeMotion& m = piece.motion;
  const Instant now = piece.at(contact.lower);
  const double span = contact.upper - contact.lower;
  const bool point_is_a = path.pointIsA();
  ContactFacts& f = result.facts;
  f.position = point_is_a ? Vec3(now.d + now.rb * place.point) : Vec3(now.ra * place.point);
  f.normal = point_is_a ? Vec3(-(now.rb * place.direction)) : Vec3(now.ra * place.direction);
  f.normal_error = std::min(
      M_PI, place.cone + 2.0 * (point_is_a ? m.rotationErrorB() : m.rotationErrorA()) + 32.0 * kUnit);
  // In the world the place moves with the triangles and over them; a point's, at most as fast as the point.
  const double with_triangles = (point_is_a ? m.ownSpeedB() : m.ownSpeedA()) * span;
  const double with_point = (point_is_a ? m.ownSpeedA() : m.ownSpeedB()) * span;
  const double moved = path.velocity().norm() * span;
  f.position_error = path.radius() > 0.0 ? with_triangles : std::min(with_point, with_triangles + moved);
  f.position_error +=
      place.point_error + piece.point_error + 8.0 * kUnit * (m.worldScaleA() + m.maxDistance());
  f.position_error *= kUp;
  f.relative_velocity = now.d_rate + m.omegaB().cross(f.position - now.d) - m.omegaA().cross(f.position);
  f.closing_speed = -f.relative_velocity.dot(f.normal);

  f.a.point = now.ra.transpose() * f.position;
  f.b.point = now.rb.transpose() * (f.position - now.d);
  Vec3 buffer[3];
  const Element triangle = (point_is_a ? piece.b : piece.a).element(contact.met[0].element, buffer);
  const Element point = (point_is_a ? piece.a : piece.b).element(0, buffer);
  Side &triangle_side = point_is_a ? f.b : f.a, &point_side = point_is_a ? f.a : f.b;
  triangle_side.shape = triangle.shape;
  triangle_side.triangle = triangle.triangle;
  triangle_side.feature = place.feature;
  point_side.shape = point.shape;
  point_side.feature = point.radius > 0.0 ? Feature::kSmooth : Feature::kVertex;
  return result;
}

}  // namespace collision_node::impact

/// A body as the oracle sees it: points, segments, triangles and cylinders, each with a radius, and closed
/// surfaces.
#pragma once

#include <array>
#include <vector>

#include "collision_node/geometry/shape.h"
#include "test/oracle/cylinder_distance.h"
#include "test/oracle/path.h"

namespace oracle {

/// The hull of 1..3 vertices, or a cylinder (count 0), grown by `radius`.
struct Part {
  int count = 0;
  V3 vertex[3];
  Real radius = 0;
  Cylinder cylinder;
  V3 centre;       ///< of a bounding sphere
  Real bound = 0;  ///< its radius
  Real reach = 0;  ///< bound of the distance of any point from the object's origin
  int shape = 0;
};

using Triangle = std::array<V3, 3>;

struct Model {
  std::vector<Part> parts;
  std::vector<std::vector<Triangle>> closed;  ///< outward surfaces of solids
  std::vector<V3> representatives;            ///< one point of each shape (all test shapes are connected)
  bool only_points = true;
  bool has_volume = false;
  Real reach = 0;
};

namespace detail {

inline void addPart(Model& model, Part part) {
  if (part.count == 0) {
    part.centre = part.cylinder.centre;
    part.bound = std::hypot(part.cylinder.radius, part.cylinder.half);
  } else {
    for (int i = 0; i < part.count; ++i) part.centre = part.centre + (1.0L / part.count) * part.vertex[i];
    for (int i = 0; i < part.count; ++i)
      part.bound = std::max(part.bound, norm(part.vertex[i] - part.centre));
    part.bound += part.radius;
  }
  part.bound *= 1 + 1e-15L;
  part.reach = norm(part.centre) + part.bound;
  model.reach = std::max(model.reach, part.reach);
  model.parts.push_back(part);
}

inline void addTriangle(Model& model, int shape, const Triangle& t) {
  Part part;
  part.count = 3, part.shape = shape;
  std::copy(t.begin(), t.end(), part.vertex);
  addPart(model, part);
}

/// Faces of the hull of few points: every triple with all other points on one side, turned outward.
inline std::vector<Triangle> hullTriangles(const std::vector<V3>& points) {
  std::vector<Triangle> faces;
  const std::size_t n = points.size();
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = i + 1; j < n; ++j) {
      for (std::size_t k = j + 1; k < n; ++k) {
        const V3 normal = cross(points[j] - points[i], points[k] - points[i]);
        bool above = false, below = false;
        for (std::size_t m = 0; m < n; ++m) {
          if (m == i || m == j || m == k) continue;
          const Real h = dot(points[m] - points[i], normal);
          above |= h > 0, below |= h < 0;
        }
        if (above && below) continue;
        faces.push_back(above ? Triangle{points[i], points[k], points[j]}
                              : Triangle{points[i], points[j], points[k]});
      }
    }
  }
  return faces;
}

inline std::vector<Triangle> boxTriangles(const V3& half) {
  std::vector<Triangle> faces;
  for (int axis = 0; axis < 3; ++axis) {
    for (int sign : {-1, 1}) {
      const auto corner = [&](int u, int v) {
        const Real c[3] = {axis == 0 ? sign * half.x : (axis == 1 ? v : u) * half.x,
                           axis == 1 ? sign * half.y : (axis == 2 ? v : u) * half.y,
                           axis == 2 ? sign * half.z : (axis == 0 ? v : u) * half.z};
        return V3{c[0], c[1], c[2]};
      };
      V3 q[4] = {corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)};
      if (dot(cross(q[1] - q[0], q[2] - q[0]), q[0]) < 0) std::swap(q[1], q[3]);
      faces.push_back({q[0], q[1], q[2]});
      faces.push_back({q[0], q[2], q[3]});
    }
  }
  return faces;
}

}  // namespace detail

/// Convex shapes must have few vertices in general position (their hull is found by trying all triples).
inline Model makeModel(const std::vector<collision_node::geometry::PlacedShape>& shapes) {
  namespace g = collision_node::geometry;
  Model model;
  for (std::size_t s = 0; s < shapes.size(); ++s) {
    const int id = static_cast<int>(s);
    const M3 turn = rotationOf(shapes[s].origin.orientation);
    const V3 shift = exact(shapes[s].origin.position);
    const auto place = [&](const V3& p) { return turn * p + shift; };
    Part part;
    part.shape = id;
    std::vector<Triangle> surface;
    if (std::holds_alternative<g::Point>(shapes[s].shape)) {
      part.count = 1, part.vertex[0] = place({});
    } else if (const auto* sphere = std::get_if<g::Sphere>(&shapes[s].shape)) {
      part.count = 1, part.vertex[0] = place({}), part.radius = sphere->radius;
    } else if (const auto* capsule = std::get_if<g::Capsule>(&shapes[s].shape)) {
      part.count = 2, part.radius = capsule->radius;
      part.vertex[0] = place({0, 0, -static_cast<Real>(capsule->length) / 2});
      part.vertex[1] = place({0, 0, static_cast<Real>(capsule->length) / 2});
    } else if (const auto* cylinder = std::get_if<g::Cylinder>(&shapes[s].shape)) {
      part.cylinder = {shift, turn.column[2], cylinder->radius, static_cast<Real>(cylinder->length) / 2};
    } else if (const auto* box = std::get_if<g::Box>(&shapes[s].shape)) {
      surface = detail::boxTriangles(0.5L * exact(box->size));
    } else if (const auto* convex = std::get_if<g::Convex>(&shapes[s].shape)) {
      std::vector<V3> points;
      for (const auto& v : convex->mesh->vertices) points.push_back(exact(v));
      surface = detail::hullTriangles(points);
    } else {
      const auto& mesh = *std::get<g::Mesh>(shapes[s].shape).mesh;
      for (const auto& t : mesh.triangles) {
        surface.push_back(
            {exact(mesh.vertices[t[0]]), exact(mesh.vertices[t[1]]), exact(mesh.vertices[t[2]])});
      }
    }
    for (Triangle& t : surface) t = {place(t[0]), place(t[1]), place(t[2])};
    for (const Triangle& t : surface) detail::addTriangle(model, id, t);
    if (surface.empty()) detail::addPart(model, part);

    const auto* mesh = std::get_if<g::Mesh>(&shapes[s].shape);
    const bool solid_surface = !surface.empty() && (!mesh || mesh->mesh->solid);
    if (solid_surface) model.closed.push_back(surface);
    const bool point = std::holds_alternative<g::Point>(shapes[s].shape);
    model.has_volume |= !point && (!mesh || mesh->mesh->solid);
    model.only_points &= point;
    model.representatives.push_back(surface.empty() ? model.parts.back().centre : surface[0][0]);
  }
  return model;
}

/// Every point becomes a ball of this radius [m].
inline Model grown(Model model, Real by) {
  if (!(by > 0)) return model;
  for (Part& part : model.parts) part.radius += by, part.bound += by, part.reach += by;
  model.reach += by;
  model.only_points = false, model.has_volume = true;
  return model;
}

/// Solid angle of a closed surface seen from p, over 4 pi: the winding number. p must not lie on the surface.
inline bool insideOf(const std::vector<Triangle>& surface, const V3& p) {
  Real total = 0;
  for (const Triangle& t : surface) {
    const V3 a = t[0] - p, b = t[1] - p, c = t[2] - p;
    const Real na = norm(a), nb = norm(b), nc = norm(c);
    total +=
        2 * std::atan2(dot(a, cross(b, c)), na * nb * nc + dot(a, b) * nc + dot(b, c) * na + dot(c, a) * nb);
  }
  return std::abs(total) > 6.28318530717958647693L;
}

/// A part moved into the world.
inline Part placed(const Part& part, const Frame& frame) {
  Part out = part;
  out.centre = frame.place(part.centre);
  for (int i = 0; i < part.count; ++i) out.vertex[i] = frame.place(part.vertex[i]);
  if (part.count == 0) {
    out.cylinder.centre = frame.place(part.cylinder.centre);
    out.cylinder.axis = frame.rotation * part.cylinder.axis;
  }
  return out;
}

/// Distance of two placed parts; the witnesses lie on the grown surfaces (on each other when they overlap).
/// `loose` as in convexGap: two cylinders only.
inline Gap partGap(const Part& a, const Part& b, Real loose = 0) {
  Gap gap;
  if (a.count > 0 && b.count > 0) gap = flatGap(a.vertex, a.count, b.vertex, b.count);
  if (a.count > 0 && b.count == 0) gap = flatCylinder(a.vertex, a.count, b.cylinder);
  if (a.count == 0 && b.count > 0) gap = swapped(flatCylinder(b.vertex, b.count, a.cylinder));
  if (a.count == 0 && b.count == 0) gap = cylinderCylinder(a.cylinder, b.cylinder, loose);
  const Real radius = a.radius + b.radius;
  if (radius == 0) return gap;
  const V3 between = gap.b - gap.a;
  const Real length = norm(between);
  if (length > 0) {
    gap.a = gap.a + (a.radius / length) * between;
    gap.b = gap.b - (b.radius / length) * between;
  }
  gap.lower = std::max<Real>(0, gap.lower - radius);
  gap.upper = std::max<Real>(0, gap.upper - radius);
  return gap;
}

}  // namespace oracle

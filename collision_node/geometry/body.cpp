#include "collision_node/geometry/body.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>

#include "collision_node/geometry/convex_hull.h"
#include "collision_node/geometry/rounding.h"

namespace collision_node::geometry {
namespace {

Bounds boundsOf(const Element& e) {
  Bounds b;
  if (e.vertices != nullptr) {
    b.lower = b.upper = e.vertices[0];
    for (int i = 1; i < e.count; ++i) {
      b.lower = b.lower.cwiseMin(e.vertices[i]);
      b.upper = b.upper.cwiseMax(e.vertices[i]);
    }
  } else {
    // A disc of radius r with unit normal n reaches r sqrt(1 - n_k^2) along axis k.
    Vec3 reach;
    for (int k = 0; k < 3; ++k) {
      const double across = std::hypot(e.axis[(k + 1) % 3], e.axis[(k + 2) % 3]);
      reach[k] = (e.half_length * std::abs(e.axis[k]) + e.rim_radius * across) * kUp;
    }
    b.lower = e.centre - reach;
    b.upper = e.centre + reach;
  }
  if (e.vertices != nullptr && e.radius == 0.0) return b;
  // Two roundings of sums of this size.
  const Vec3 scale = b.lower.cwiseAbs().cwiseMax(b.upper.cwiseAbs());
  const Vec3 grow = Vec3::Constant(e.radius * kUp) + 4e-16 * (scale + Vec3::Constant(e.radius));
  b.lower -= grow;
  b.upper += grow;
  return b;
}

/// Which vertices hang together: each points to one before it, the first of all to itself, and one without a
/// triangle nowhere.
class Components {
 public:
  explicit Components(std::size_t vertices) : towards_(vertices, -1) {}

  void join(const std::array<std::int32_t, 3>& triangle) {
    const std::int32_t a = first(triangle[0]), b = first(triangle[1]), c = first(triangle[2]);
    const std::int32_t least = std::min({a, b, c});
    towards(a) = towards(b) = towards(c) = least;
  }
  bool isFirst(std::size_t vertex) const { return towards_[vertex] == static_cast<std::int32_t>(vertex); }

 private:
  std::int32_t& towards(std::int32_t vertex) { return towards_[static_cast<std::size_t>(vertex)]; }
  /// Halves the way there.
  std::int32_t first(std::int32_t vertex) {
    if (towards(vertex) < 0) towards(vertex) = vertex;
    while (towards(vertex) != vertex) vertex = towards(vertex) = towards(towards(vertex));
    return vertex;
  }

  std::vector<std::int32_t> towards_;
};

}  // namespace

Body::Body(std::vector<PlacedShape> shapes) : shapes_(std::move(shapes)) {
  if (shapes_.empty()) throw std::invalid_argument("a body needs at least one shape");
  first_triangle_of_shape_.assign(shapes_.size(), -1);

  for (std::size_t s = 0; s < shapes_.size(); ++s) {
    const Pose& origin = shapes_[s].origin;
    double farthest2 = -1.0;  // of what is placed
    const auto place = [&](const Vec3& p) {
      farthest2 = std::max(farthest2, p.squaredNorm());
      return origin * p;
    };
    const auto addVertices = [&](std::vector<Vec3> points, double radius, const Vec3& half) {
      for (Vec3& p : points) p = place(p);
      Element e;
      e.radius = radius;
      e.shape = static_cast<int>(s);
      addPrimitive(e, {origin.position, half, 0.0, false, origin.orientation.toRotationMatrix()}, points);
    };
    const Shape& shape = shapes_[s].shape;
    if (std::holds_alternative<Point>(shape)) {
      addVertices({Vec3::Zero()}, 0.0, Vec3::Zero());
    } else if (const auto* sphere = std::get_if<Sphere>(&shape)) {
      addVertices({Vec3::Zero()}, sphere->radius, Vec3::Zero());
    } else if (const auto* box = std::get_if<Box>(&shape)) {
      std::vector<Vec3> corners;
      for (int i = 0; i < 8; ++i) {
        corners.push_back(0.5 * Vec3(i & 1 ? box->size.x() : -box->size.x(),
                                     i & 2 ? box->size.y() : -box->size.y(),
                                     i & 4 ? box->size.z() : -box->size.z()));
      }
      addVertices(corners, 0.0, 0.5 * box->size);
    } else if (const auto* capsule = std::get_if<Capsule>(&shape)) {
      const Vec3 half(0, 0, 0.5 * capsule->length);
      addVertices({-half, half}, capsule->radius, half);
    } else if (const auto* cylinder = std::get_if<Cylinder>(&shape)) {
      Element e;
      e.centre = origin.position;
      e.axis = (origin.orientation * Vec3::UnitZ()).normalized();
      e.rim_radius = cylinder->radius;
      e.half_length = 0.5 * cylinder->length;
      e.shape = static_cast<int>(s);
      const Vec3 across = e.axis == Vec3::UnitZ() ? Vec3(Vec3::UnitX()) : e.axis.unitOrthogonal();
      Mat3 axes = Mat3::Zero();
      axes << across, e.axis.cross(across), e.axis;
      addPrimitive(e, {e.centre, Vec3::Zero(), 0.0, false, axes}, {});
    } else if (const auto* convex = std::get_if<Convex>(&shape)) {
      addVertices(hullVertices(convex->mesh->vertices), 0.0, Vec3::Zero());
    } else {
      const TriangleMesh& mesh = *std::get<Mesh>(shape).mesh;
      const auto first_vertex = static_cast<std::int32_t>(vertices_.size());
      vertices_.reserve(vertices_.size() + mesh.vertices.size());
      for (const Vec3& p : mesh.vertices) {
        vertices_.push_back(place(p));
        checkReach(vertices_.back(), static_cast<int>(s));
      }
      first_triangle_of_shape_[s] = static_cast<std::int32_t>(triangles_.size());
      triangles_.reserve(triangles_.size() + mesh.triangles.size());
      Components components(mesh.vertices.size());
      for (const auto& t : mesh.triangles) {
        const auto id = static_cast<std::int32_t>(triangles_.size());
        triangles_.push_back({{first_vertex + t[0], first_vertex + t[1], first_vertex + t[2]}, id});
        components.join(t);
      }
      for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
        if (components.isFirst(v)) representatives_.push_back(vertices_[first_vertex + v]);
      if (mesh.solid) solids_.push_back(static_cast<int>(s));
    }
    // A rotated coordinate and its sum with the origin: under sixteen roundings of terms of this size.
    if (farthest2 >= 0.0) {
      placing_error_ = std::max(placing_error_, 1.8e-15 * (std::sqrt(farthest2) + origin.position.norm()));
    }
  }

  triangle_count_ = static_cast<std::int32_t>(triangles_.size());
  element_count_ = triangle_count_ + static_cast<std::int32_t>(primitives_.size());
  std::vector<Bounds> boxes;
  std::size_t hull = 0;
  for (Primitive& p : primitives_) {
    Element& e = p.element;
    if (e.count > 0)
      e.vertices = e.count > Primitive::kCorners ? hull_vertices_[hull++].data() : p.corners.data();
    if (!std::holds_alternative<Convex>(shapes_[e.shape].shape)) e.frame = &p.frame;
    boxes.push_back(boundsOf(e));
    checkReach(boxes.back().lower, e.shape);
    checkReach(boxes.back().upper, e.shape);
  }
  if (triangles_.empty() && boxes.empty())
    throw std::invalid_argument("a body needs at least one triangle or primitive");
  std::vector<std::int32_t> order;
  bvh_ = Bvh(vertices_, triangles_, boxes, order);
  storeInOrderOfTheTree(order);
  bvh_.addPlates(vertices_, triangles_);
  measure();
}

void Body::checkReach(const Vec3& place, int shape) const {
  if ((place.array().abs() <= kLargestLength).all()) return;
  std::ostringstream text;
  text << shapes_[static_cast<std::size_t>(shape)].source << " reaches " << place.cwiseAbs().maxCoeff()
       << " m from its object's origin; it must stay within " << kLargestLength << " m";
  throw std::invalid_argument(text.str());
}

void Body::addPrimitive(Element element, const CoreFrame& frame, const std::vector<Vec3>& vertices) {
  element.count = static_cast<int>(vertices.size());
  Primitive primitive;
  primitive.element = element;
  primitive.frame = frame;
  primitive.frame.aligned = frame.axes == Mat3::Identity();
  primitive.corners.fill(Vec3::Zero());
  if (element.count > Primitive::kCorners)
    hull_vertices_.push_back(vertices);
  else
    std::copy(vertices.begin(), vertices.end(), primitive.corners.begin());
  primitives_.push_back(primitive);
  representatives_.push_back(vertices.empty() ? element.centre : vertices.back());
}

void Body::resize(const Cylinder& cylinder, const Vec3& centre) {
  shapes_[0].shape = cylinder;
  shapes_[0].origin.position = centre;
  Element& e = primitives_[0].element;
  CoreFrame& frame = primitives_[0].frame;
  e.centre = representatives_[0] = frame.centre = centre;
  e.rim_radius = cylinder.radius;
  e.half_length = 0.5 * cylinder.length;
  bvh_.replaceOnly(boundsOf(e));
  measure();
}

void Body::measure() {
  // The sphere about the root box's centre; |v - c| of the outermost vertex, not the box's diagonal.
  const Vec3 c = centre();
  double radius2 = 0.0;
  for (const Vec3& v : vertices_) radius2 = std::max(radius2, (v - c).squaredNorm());
  double grown = 0.0, farthest = 0.0, round = 0.0;
  for (Primitive& p : primitives_) {
    const Element& e = p.element;
    grown = std::max(grown, e.radius);
    double core = 0.0;
    if (e.vertices == nullptr) {
      const double half = std::hypot(e.rim_radius, e.half_length);
      round = std::max(round, (e.centre - c).norm() + half);
      core = e.centre.norm() + half;
    }
    for (int i = 0; i < e.count; ++i) {
      radius2 = std::max(radius2, (e.vertices[i] - c).squaredNorm());
      core = std::max(core, e.vertices[i].norm());
    }
    p.frame.reach = core;
    farthest = std::max(farthest, core + e.radius);
  }
  radius_ = (std::max(std::sqrt(radius2), round) + grown) * kUp + 4e-16 * c.norm();
  // Primitives know better than their boxes' corners.
  reach_ = triangle_count_ > 0 ? bvh_[Bvh::kRoot].reach : farthest * kUp;
}

/// Triangles and vertices that are looked at together lie together.
void Body::storeInOrderOfTheTree(const std::vector<std::int32_t>& order) {
  std::vector<std::int32_t> new_vertex(vertices_.size(), -1);
  std::vector<Triangle> triangles;
  std::vector<Vec3> vertices;
  triangles.reserve(triangles_.size());
  vertices.reserve(vertices_.size());
  for (const std::int32_t id : order) {
    Triangle t = triangles_[id];
    for (std::int32_t& v : t.v) {
      if (new_vertex[v] < 0) {
        new_vertex[v] = static_cast<std::int32_t>(vertices.size());
        vertices.push_back(vertices_[v]);
      }
      v = new_vertex[v];
    }
    triangles.push_back(t);
  }
  triangles_ = std::move(triangles);
  vertices.shrink_to_fit();
  vertices_ = std::move(vertices);
}

const WideBvh& Body::buildWide() const {
  std::call_once(wide_built_, [this] {
    wide_ = std::make_unique<const WideBvh>(vertices_, triangle_count_, [this](std::int32_t i) {
      const std::int32_t* v = triangles_[i].v;
      return WideBvh::Corners{v[0], v[1], v[2]};
    });
    wide_ready_.store(wide_.get(), std::memory_order_release);
  });
  return *wide_;
}

int Body::shapeOf(std::int32_t id) const {
  if (id >= triangle_count_) return primitive(id).shape;
  int shape = static_cast<int>(first_triangle_of_shape_.size()) - 1;
  while (first_triangle_of_shape_[shape] < 0 || first_triangle_of_shape_[shape] > triangles_[id].loaded)
    --shape;
  return shape;
}

std::int32_t Body::triangleOf(std::int32_t id) const {
  return triangles_[id].loaded - first_triangle_of_shape_[shapeOf(id)];
}

Element Body::element(std::int32_t id, Vec3* buffer) const {
  if (id >= triangle_count_) return primitive(id);
  const Triangle& t = triangles_[id];
  for (int i = 0; i < 3; ++i) buffer[i] = vertices_[t.v[i]];
  Element e;
  e.vertices = buffer;
  e.count = 3;
  e.shape = shapeOf(id);
  e.triangle = t.loaded - first_triangle_of_shape_[e.shape];
  return e;
}

}  // namespace collision_node::geometry

#include "collision_node/geometry/body.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "collision_node/geometry/convex_hull.h"

namespace collision_node::geometry {
namespace {

constexpr double kUp = 1.0 + 8.0 * std::numeric_limits<double>::epsilon();

struct Bounds {
  Vec3 lower = Vec3::Constant(std::numeric_limits<double>::infinity());
  Vec3 upper = Vec3::Constant(-std::numeric_limits<double>::infinity());

  void add(const Vec3& p) {
    lower = lower.cwiseMin(p);
    upper = upper.cwiseMax(p);
  }
  void add(const Bounds& o) {
    lower = lower.cwiseMin(o.lower);
    upper = upper.cwiseMax(o.upper);
  }
  Vec3 centre() const { return 0.5 * (lower + upper); }
  double halfArea() const {
    const Vec3 e = (upper - lower).cwiseMax(0.0);
    return e.x() * e.y() + e.y() * e.z() + e.z() * e.x();
  }
};

Bounds boundsOf(const Element& e) {
  Bounds b;
  if (e.vertices != nullptr) {
    for (int i = 0; i < e.count; ++i) b.add(e.vertices[i]);
  } else {
    // A disc of radius r with unit normal n reaches r sqrt(1 - n_k^2) along axis k.
    Vec3 reach;
    for (int k = 0; k < 3; ++k) {
      const double across = std::hypot(e.axis[(k + 1) % 3], e.axis[(k + 2) % 3]);
      reach[k] = (e.half_length * std::abs(e.axis[k]) + e.rim_radius * across) * kUp;
    }
    b.add(e.centre - reach);
    b.add(e.centre + reach);
  }
  const Vec3 grow = Vec3::Constant(e.radius * kUp);
  b.lower -= grow;
  b.upper += grow;
  return b;
}

/// Sets box and reach so that they hold `b` in spite of their own rounding.
void setBox(BvhNode& node, const Bounds& b) {
  node.centre = b.centre();
  const Vec3 scale = b.lower.cwiseAbs().cwiseMax(b.upper.cwiseAbs());
  node.half = (b.upper - node.centre).cwiseMax(node.centre - b.lower) + 4e-16 * scale;
  node.reach = std::hypot(scale.x(), scale.y(), scale.z()) * kUp;
}

/// Top-down build with binned surface area heuristic (Wald 2007): split where area * count is smallest.
class Builder {
 public:
  Builder(const std::vector<Bounds>& boxes, std::vector<BvhNode>& nodes) : boxes_(boxes), nodes_(nodes) {
    order_.resize(boxes.size());
    std::iota(order_.begin(), order_.end(), 0);
    nodes_.reserve(2 * boxes.size());
    nodes_.emplace_back();
    build(0, 0, static_cast<int>(boxes.size()));
  }

 private:
  static constexpr int kBins = 16;

  void build(std::int32_t node, int begin, int end) {
    Bounds all, centres;
    for (int i = begin; i < end; ++i) {
      all.add(boxes_[order_[i]]);
      centres.add(boxes_[order_[i]].centre());
    }
    setBox(nodes_[node], all);
    if (end - begin == 1) {
      nodes_[node].element = order_[begin];
      return;
    }
    const int middle = partition(begin, end, centres);
    const auto left = static_cast<std::int32_t>(nodes_.size());
    nodes_[node].left = left;
    nodes_.emplace_back();
    nodes_.emplace_back();
    build(left, begin, middle);
    build(left + 1, middle, end);
  }

  int partition(int begin, int end, const Bounds& centres) {
    int axis = 0;
    const Vec3 extent = centres.upper - centres.lower;
    extent.maxCoeff(&axis);
    const int half = begin + (end - begin) / 2;
    const auto by_centre = [&](int i, int j) {
      const double a = boxes_[i].centre()[axis], b = boxes_[j].centre()[axis];
      return a != b ? a < b : i < j;  // a total order: the same tree everywhere
    };
    if (end - begin <= 4 || !(extent[axis] > 0.0)) {
      std::nth_element(order_.begin() + begin, order_.begin() + half, order_.begin() + end, by_centre);
      return half;
    }
    Bounds bins[kBins];
    int counts[kBins] = {};
    const double scale = kBins / extent[axis];
    const auto binOf = [&](int i) {
      const int bin = static_cast<int>((boxes_[i].centre()[axis] - centres.lower[axis]) * scale);
      return std::clamp(bin, 0, kBins - 1);
    };
    for (int i = begin; i < end; ++i) {
      const int bin = binOf(order_[i]);
      bins[bin].add(boxes_[order_[i]]);
      ++counts[bin];
    }
    double right_cost[kBins] = {};
    Bounds sweep;
    int count = 0;
    for (int b = kBins - 1; b > 0; --b) {
      sweep.add(bins[b]);
      count += counts[b];
      right_cost[b] = count > 0 ? count * sweep.halfArea() : 0.0;
    }
    sweep = Bounds();
    count = 0;
    double best = std::numeric_limits<double>::infinity();
    int best_bin = 0;
    for (int b = 0; b + 1 < kBins; ++b) {
      sweep.add(bins[b]);
      count += counts[b];
      if (count == 0 || count == end - begin) continue;
      const double cost = count * sweep.halfArea() + right_cost[b + 1];
      if (cost < best) {
        best = cost;
        best_bin = b;
      }
    }
    const auto split = std::stable_partition(order_.begin() + begin, order_.begin() + end,
                                             [&](int i) { return binOf(i) <= best_bin; });
    const int middle = static_cast<int>(split - order_.begin());
    if (middle > begin && middle < end) return middle;
    std::nth_element(order_.begin() + begin, order_.begin() + half, order_.begin() + end, by_centre);
    return half;
  }

  const std::vector<Bounds>& boxes_;
  std::vector<BvhNode>& nodes_;
  std::vector<int> order_;
};

/// The root of `i` in a union-find forest, with path halving.
int rootOf(std::vector<int>& parent, int i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

}  // namespace

Body::Body(std::vector<PlacedShape> shapes) : shapes_(std::move(shapes)) {
  if (shapes_.empty()) throw std::invalid_argument("a body needs at least one shape");
  first_triangle_of_shape_.assign(shapes_.size(), -1);

  for (std::size_t s = 0; s < shapes_.size(); ++s) {
    const Pose& origin = shapes_[s].origin;
    // A rotated coordinate and its sum with the origin: under sixteen roundings of terms of this size.
    const auto place = [&](const Vec3& p) {
      placing_error_ = std::max(placing_error_, 1.8e-15 * (p.norm() + origin.position.norm()));
      return origin * p;
    };
    const auto addVertices = [&](const std::vector<Vec3>& points, double radius) {
      Element e;
      e.count = static_cast<int>(points.size());
      e.radius = radius;
      e.shape = static_cast<int>(s);
      primitive_first_vertex_.push_back(static_cast<std::int32_t>(vertices_.size()));
      for (const Vec3& p : points) vertices_.push_back(place(p));
      representatives_.push_back(vertices_.back());
      primitives_.push_back(e);
    };
    const Shape& shape = shapes_[s].shape;
    if (std::holds_alternative<Point>(shape)) {
      addVertices({Vec3::Zero()}, 0.0);
    } else if (const auto* sphere = std::get_if<Sphere>(&shape)) {
      addVertices({Vec3::Zero()}, sphere->radius);
    } else if (const auto* box = std::get_if<Box>(&shape)) {
      std::vector<Vec3> corners;
      for (int i = 0; i < 8; ++i) {
        corners.push_back(0.5 * Vec3(i & 1 ? box->size.x() : -box->size.x(),
                                     i & 2 ? box->size.y() : -box->size.y(),
                                     i & 4 ? box->size.z() : -box->size.z()));
      }
      addVertices(corners, 0.0);
    } else if (const auto* capsule = std::get_if<Capsule>(&shape)) {
      const Vec3 half(0, 0, 0.5 * capsule->length);
      addVertices({-half, half}, capsule->radius);
    } else if (const auto* cylinder = std::get_if<Cylinder>(&shape)) {
      Element e;
      e.centre = origin.position;
      e.axis = (origin.orientation * Vec3::UnitZ()).normalized();
      e.rim_radius = cylinder->radius;
      e.half_length = 0.5 * cylinder->length;
      e.shape = static_cast<int>(s);
      primitive_first_vertex_.push_back(-1);
      representatives_.push_back(e.centre);
      primitives_.push_back(e);
    } else if (const auto* convex = std::get_if<Convex>(&shape)) {
      addVertices(hullVertices(convex->mesh->vertices), 0.0);
    } else {
      const TriangleMesh& mesh = *std::get<Mesh>(shape).mesh;
      const auto first_vertex = static_cast<std::int32_t>(vertices_.size());
      for (const Vec3& p : mesh.vertices) vertices_.push_back(place(p));
      first_triangle_of_shape_[s] = static_cast<std::int32_t>(triangles_.size());
      std::vector<int> parent(mesh.vertices.size());
      std::iota(parent.begin(), parent.end(), 0);
      for (const auto& t : mesh.triangles) {
        triangles_.push_back(
            {{first_vertex + t[0], first_vertex + t[1], first_vertex + t[2]}, static_cast<std::int32_t>(s)});
        const int root = rootOf(parent, t[0]);
        parent[rootOf(parent, t[1])] = root;
        parent[rootOf(parent, t[2])] = rootOf(parent, root);
      }
      std::vector<bool> seen(mesh.vertices.size(), false);
      for (const auto& t : mesh.triangles) {
        const int root = rootOf(parent, t[0]);
        if (!seen[root]) representatives_.push_back(vertices_[first_vertex + t[0]]);
        seen[root] = true;
      }
      if (mesh.solid) {
        solids_.push_back(
            {static_cast<int>(s), first_triangle_of_shape_[s], static_cast<std::int32_t>(triangles_.size())});
      }
    }
  }

  triangle_count_ = static_cast<std::int32_t>(triangles_.size());
  for (std::size_t p = 0; p < primitives_.size(); ++p) {
    if (primitive_first_vertex_[p] >= 0) primitives_[p].vertices = &vertices_[primitive_first_vertex_[p]];
  }
  std::vector<Bounds> boxes;
  boxes.reserve(elementCount());
  Vec3 buffer[3];
  for (std::int32_t id = 0; id < elementCount(); ++id) boxes.push_back(boundsOf(element(id, buffer)));
  if (boxes.empty()) throw std::invalid_argument("a body needs at least one triangle or primitive");
  Builder(boxes, nodes_);

  // The sphere about the root box's centre; |v - c| of the outermost vertex, not the box's diagonal.
  const Vec3 c = centre();
  for (const Vec3& v : vertices_) radius_ = std::max(radius_, (v - c).norm());
  double grown = 0.0;
  for (const Element& e : primitives_) {
    grown = std::max(grown, e.radius);
    if (e.vertices == nullptr) {
      radius_ = std::max(radius_, (e.centre - c).norm() + std::hypot(e.rim_radius, e.half_length));
    }
  }
  radius_ = (radius_ + grown) * kUp + 4e-16 * c.norm();
}

const WideBvh& Body::wideBvh() const {
  std::call_once(wide_built_, [this] {
    wide_ = std::make_unique<WideBvh>(vertices_, triangle_count_, [this](std::int32_t i) {
      const std::int32_t* v = triangles_[i].v;
      return WideBvh::Corners{v[0], v[1], v[2]};
    });
  });
  return *wide_;
}

Element Body::element(std::int32_t id, Vec3* buffer) const {
  if (id >= triangle_count_) return primitives_[id - triangle_count_];
  const Triangle& t = triangles_[id];
  for (int i = 0; i < 3; ++i) buffer[i] = vertices_[t.v[i]];
  Element e;
  e.vertices = buffer;
  e.count = 3;
  e.shape = t.shape;
  e.triangle = id - first_triangle_of_shape_[t.shape];
  return e;
}

}  // namespace collision_node::geometry

#include "collision_node/impact/proof/wrap.h"

#include <bitset>
#include <cmath>
#include <limits>

namespace collision_node::impact {
namespace {

/// A wrap under construction: faces with their planes, and which face owns each directed edge.
class WrapBuilder {
 public:
  WrapBuilder(const Cores& cores, Wrap& wrap) : cores_(cores), wrap_(wrap) { owner_.fill(-1); }

  bool build(double depth);

 private:
  using Face = std::array<std::int16_t, 3>;
  struct Plane {
    Vec3 normal;   ///< unit, outward
    double depth;  ///< signed distance of the origin inside it
  };
  template <typename T>
  using OnePerFace = boost::container::static_vector<T, Wrap::kMostFaces>;

  bool firstTetrahedron();
  bool addPoint(const SupportPair& point, std::size_t seed);
  bool isClosed() const;
  void addFace(int a, int b, int c);
  void removeFace(std::size_t face);
  std::int16_t& owner(int from, int to) {
    return owner_[static_cast<std::size_t>(from) * Wrap::kMostPoints + static_cast<std::size_t>(to)];
  }

  const Cores& cores_;
  Wrap& wrap_;
  OnePerFace<Plane> planes_;
  std::array<std::int16_t, Wrap::kMostPoints * Wrap::kMostPoints> owner_;  ///< -1: no face
};

void WrapBuilder::addFace(int a, int b, int c) {
  const Vec3 &pa = wrap_.points[a].w, &pb = wrap_.points[b].w, &pc = wrap_.points[c].w;
  const Vec3 n = (pb - pa).cross(pc - pa);
  const double length = n.norm();
  const int id = static_cast<int>(wrap_.faces.size());
  wrap_.faces.push_back(
      {static_cast<std::int16_t>(a), static_cast<std::int16_t>(b), static_cast<std::int16_t>(c)});
  planes_.push_back(length > 0.0 ? Plane{n / length, n.dot(pa) / length}
                                 : Plane{Vec3::Zero(), std::numeric_limits<double>::infinity()});
  owner(a, b) = owner(b, c) = owner(c, a) = static_cast<std::int16_t>(id);
}

/// The last face takes its place.
void WrapBuilder::removeFace(std::size_t face) {
  const auto own = [this](const Face& f, std::int16_t id) {
    owner(f[0], f[1]) = owner(f[1], f[2]) = owner(f[2], f[0]) = id;
  };
  own(wrap_.faces[face], -1);
  if (face + 1 < wrap_.faces.size()) {
    wrap_.faces[face] = wrap_.faces.back();
    planes_[face] = planes_.back();
    own(wrap_.faces[face], static_cast<std::int16_t>(face));
  }
  wrap_.faces.pop_back();
  planes_.pop_back();
}

/// Every directed edge once, its reverse once: the premise of the winding argument.
bool WrapBuilder::isClosed() const {
  std::bitset<Wrap::kMostPoints * Wrap::kMostPoints> edges;
  const auto at = [](int from, int to) {
    return static_cast<std::size_t>(from) * Wrap::kMostPoints + static_cast<std::size_t>(to);
  };
  for (const auto& f : wrap_.faces) {
    for (int k = 0; k < 3; ++k) {
      const std::size_t edge = at(f[k], f[(k + 1) % 3]);
      if (edges[edge]) return false;
      edges[edge] = true;
    }
  }
  for (const auto& f : wrap_.faces) {
    for (int k = 0; k < 3; ++k) {
      if (!edges[at(f[(k + 1) % 3], f[k])]) return false;
    }
  }
  return !wrap_.faces.empty();
}

/// A first tetrahedron: farthest points along, across and above one another.
bool WrapBuilder::firstTetrahedron() {
  auto& points = wrap_.points;
  const auto add = [&](const Vec3& direction) {
    points.push_back(cores_.support(direction));
    return points.back().w;
  };
  Vec3 first = add(Vec3(1.0, 0.3, 0.2));
  Vec3 second = add(-first);
  Vec3 edge = second - first;
  if (!(edge.norm() > 0.0)) {
    points.pop_back();
    second = add(Vec3(-1.0, -0.3, -0.2));
    edge = second - first;
  }
  if (!(edge.norm() > 0.0)) return false;
  int axis = 0;
  edge.cwiseAbs().minCoeff(&axis);
  Vec3 side = edge.cross(Vec3::Unit(axis));
  const double size = edge.norm();
  // The side that faces the origin first: the wrap should close around it.
  const Vec3 toward = -(first - edge * (first.dot(edge) / edge.squaredNorm()));
  if (toward.norm() > 1e-9 * size) side = toward;
  Vec3 third = add(side);
  Vec3 normal = edge.cross(third - first);
  if (!(normal.norm() > 1e-12 * size * size)) {
    for (const Vec3& other : {Vec3(-side), Vec3(edge.cross(side)), Vec3(-edge.cross(side))}) {
      points.pop_back();
      third = add(other);
      normal = edge.cross(third - first);
      if (normal.norm() > 1e-12 * size * size) break;
    }
  }
  if (!(normal.norm() > 0.0)) return false;
  if (normal.dot(first) > 0.0) normal = -normal;  // toward the origin
  Vec3 fourth = add(normal);
  double height = normal.normalized().dot(fourth - first);
  if (!(std::abs(height) > 0.0)) {
    points.pop_back();
    fourth = add(-normal);
    height = normal.normalized().dot(fourth - first);
  }
  if (!(std::abs(height) > 0.0)) return false;
  const bool flip = det(second - first, third - first, fourth - first) > 0.0;
  if (flip) std::swap(points[1], points[2]);
  addFace(0, 1, 2);
  addFace(0, 3, 1);
  addFace(1, 3, 2);
  addFace(2, 3, 0);
  return true;
}

/// Replaces the faces that see `point` by a cone over their horizon.
bool WrapBuilder::addPoint(const SupportPair& point, std::size_t seed) {
  std::bitset<Wrap::kMostFaces> seen;
  OnePerFace<std::size_t> stack = {seed};
  seen[seed] = true;
  while (!stack.empty()) {
    const Face f = wrap_.faces[stack.back()];
    stack.pop_back();
    for (int k = 0; k < 3; ++k) {
      const std::int16_t across = owner(f[(k + 1) % 3], f[k]);
      if (across < 0) return false;
      const auto other = static_cast<std::size_t>(across);
      if (seen[other]) continue;
      if (planes_[other].normal.dot(point.w - wrap_.points[wrap_.faces[other][0]].w) > 0.0) {
        seen[other] = true;
        stack.push_back(other);
      }
    }
  }
  boost::container::static_vector<std::array<std::int16_t, 2>, 3 * Wrap::kMostFaces / 2> horizon;
  for (std::size_t g = 0; g < wrap_.faces.size(); ++g) {
    if (!seen[g]) continue;
    for (int k = 0; k < 3; ++k) {
      const std::int16_t from = wrap_.faces[g][k], to = wrap_.faces[g][(k + 1) % 3];
      if (!seen[static_cast<std::size_t>(owner(to, from))]) horizon.push_back({from, to});
    }
  }
  for (std::size_t g = wrap_.faces.size(); g-- > 0;) {
    if (seen[g]) removeFace(g);
  }
  const int id = static_cast<int>(wrap_.points.size());
  wrap_.points.push_back(point);
  if (wrap_.faces.size() + horizon.size() > Wrap::kMostFaces) return false;  // no sphere any more
  for (const auto& edge : horizon) addFace(edge[0], edge[1], id);
  return true;
}

bool WrapBuilder::build(double depth) {
  wrap_.points.clear();
  wrap_.faces.clear();
  if (!firstTetrahedron()) return false;
  while (wrap_.points.size() < Wrap::kMostPoints) {
    std::size_t worst = 0;
    for (std::size_t f = 1; f < planes_.size(); ++f) {
      if (planes_[f].depth < planes_[worst].depth) worst = f;
    }
    const Plane nearest = planes_[worst];
    if (nearest.depth >= depth) return isClosed();
    const SupportPair next = cores_.support(nearest.normal);
    const double reach = nearest.normal.dot(next.w);
    // The support plane bounds the depth of the whole difference from above.
    if (reach < depth || !(reach > nearest.depth)) return false;
    if (!addPoint(next, worst)) return false;
  }
  return false;
}

}  // namespace

bool buildWrap(const Cores& cores, double depth, Wrap& wrap) { return WrapBuilder(cores, wrap).build(depth); }

/// The closed surface of the tetrahedron of an overlap, outward.
bool wrapTetrahedron(const Closest& closest, Wrap& wrap) {
  if (!closest.overlap || closest.count != 4) return false;
  wrap.points.assign(closest.point, closest.point + 4);
  auto& p = wrap.points;
  if (det(p[1].w - p[0].w, p[2].w - p[0].w, p[3].w - p[0].w) > 0.0) std::swap(p[1], p[2]);
  wrap.faces.assign({{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}});
  return true;
}

}  // namespace collision_node::impact

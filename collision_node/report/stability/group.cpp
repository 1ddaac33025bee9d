#include "collision_node/report/stability/group.h"

#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>

#include "collision_node/report/methods/peer_models.h"
#include "collision_node/report/scenes/building.h"

namespace collision_node::report {
namespace {

template <typename T>
void addEdges(Surface<T>& surface) {
  std::set<std::array<int, 2>> edges;
  for (const auto& f : surface.faces) {
    for (int i = 0; i < 3; ++i) {
      const int p = f[i], q = f[(i + 1) % 3];
      if (p != q) edges.insert({std::min(p, q), std::max(p, q)});
    }
  }
  surface.edges.assign(edges.begin(), edges.end());
}

/// Half lengths of a box are exact: the halves of doubles.
template <typename T>
void addBox(Surface<T>& surface, const geometry::Vec3& size) {
  for (int i = 0; i < 8; ++i) {
    const geometry::Vec3 corner((i & 1 ? 0.5 : -0.5) * size.x(), (i & 2 ? 0.5 : -0.5) * size.y(),
                                (i & 4 ? 0.5 : -0.5) * size.z());
    surface.vertices.push_back(lift<T>(corner));
  }
  surface.faces = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                   {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
}

}  // namespace

double toDouble(const Exact& x) { return x.convert_to<double>(); }

void Group::addContact(const impact::Piece& piece, const Exact& toi, const Vec<Exact>* point,
                       double closing_speed) {
  Truth truth;
  truth.verdict = Verdict::kHit;
  truth.toi = toDouble(toi);
  truth.toi_error = std::abs(truth.toi) * 0x1p-52;
  if (point != nullptr) {
    truth.point = {toDouble(point->x()), toDouble(point->y()), toDouble(point->z())};
    truth.point_error = truth.point.norm() * 0x1p-52;
  }
  trials.set.queries.push_back({0, 1, piece});
  trials.truths.push_back(truth);
  nearest.push_back(std::numeric_limits<double>::quiet_NaN());
  closing.push_back(closing_speed);
}

void Group::addApart(const impact::Piece& piece, double nearest_gap) {
  Truth truth;
  truth.verdict = Verdict::kClear;
  trials.set.queries.push_back({0, 1, piece});
  trials.truths.push_back(truth);
  nearest.push_back(nearest_gap);
  closing.push_back(std::numeric_limits<double>::quiet_NaN());
}

Group makeGroup(const std::string& name, geometry::Shape a, geometry::Shape b) {
  Group group;
  group.trials.name = name;
  addBody(group.trials.set, std::move(a));
  addBody(group.trials.set, std::move(b));
  return group;
}

template <typename T>
Surface<T> surfaceOf(const geometry::Body& body, const geometry::Quat& q) {
  Surface<T> surface;
  if (const auto* mesh = only<geometry::Mesh>(body)) {
    for (const auto& v : mesh->mesh->vertices) surface.vertices.push_back(lift<T>(v));
    for (const auto& t : mesh->mesh->triangles) surface.faces.push_back({t[0], t[1], t[2]});
  } else if (const auto* box = only<geometry::Box>(body)) {
    addBox(surface, box->size);
  } else if (const auto* ball = only<geometry::Sphere>(body)) {
    surface.vertices.push_back(Vec<T>::Zero());
    surface.radius = T(ball->radius);
  } else if (only<geometry::Point>(body)) {
    surface.vertices.push_back(Vec<T>::Zero());
  } else {
    throw std::logic_error("no surface of triangles, sphere or point");
  }
  for (auto& v : surface.vertices) v = turned(q, v);
  addEdges(surface);
  return surface;
}

template Surface<double> surfaceOf(const geometry::Body&, const geometry::Quat&);
template Surface<Exact> surfaceOf(const geometry::Body&, const geometry::Quat&);

}  // namespace collision_node::report

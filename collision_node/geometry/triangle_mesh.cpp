#include "collision_node/geometry/triangle_mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <stdexcept>
#include <utility>

namespace collision_node::geometry {
namespace {

using Corners = std::array<std::int32_t, 3>;

/// x + y as (sum, error), exactly.
std::pair<double, double> exactSum(double x, double y) {
  const double sum = x + y;
  const double y_part = sum - x;
  return {sum, (x - (sum - y_part)) + (y - y_part)};
}

/// A number held as an unevaluated sum of doubles, each term exact.
class Expansion {
 public:
  void add(double term) {
    for (double& kept : terms_) {
      const auto [sum, error] = exactSum(term, kept);
      kept = error;
      term = sum;
    }
    terms_.push_back(term);
  }
  void addProduct(double x, double y) {
    const double product = x * y;
    add(std::fma(x, y, -product));
    add(product);
  }
  /// The terms do not overlap, so the number is zero only when each of them is.
  bool isZero() const {
    return std::all_of(terms_.begin(), terms_.end(), [](double term) { return term == 0.0; });
  }

 private:
  std::vector<double> terms_;
};

/// Whether (ax-cx)(by-cy) - (ay-cy)(bx-cx) is zero in exact arithmetic. Exact while products of coordinate
/// differences neither overflow nor fall under 1e-290: beyond any length in metres.
bool crossIsZero(double ax, double ay, double bx, double by, double cx, double cy) {
  const double left = (ax - cx) * (by - cy);
  const double right = (ay - cy) * (bx - cx);
  // Each product carries three roundings and the difference one more: 4 units of 2^-53 of the sum, doubled.
  const double filter = 8.0 * 0x1p-53 * (std::abs(left) + std::abs(right));
  if (std::abs(left - right) > filter) return false;
  const auto u = exactSum(ax, -cx), v = exactSum(by, -cy), s = exactSum(ay, -cy), t = exactSum(bx, -cx);
  Expansion determinant;
  for (double x : {u.first, u.second}) {
    for (double y : {v.first, v.second}) determinant.addProduct(x, y);
  }
  for (double x : {s.first, s.second}) {
    for (double y : {t.first, t.second}) determinant.addProduct(-x, y);
  }
  return determinant.isZero();
}

/// The cross product's three components are the signed areas of the projections.
bool isDegenerate(const Vec3& a, const Vec3& b, const Vec3& c) {
  return crossIsZero(a.x(), a.y(), b.x(), b.y(), c.x(), c.y()) &&
         crossIsZero(a.y(), a.z(), b.y(), b.z(), c.y(), c.z()) &&
         crossIsZero(a.z(), a.x(), b.z(), b.x(), c.z(), c.x());
}

bool isCollapsed(const Corners& corners) {
  return corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0];
}

void checkInput(const std::vector<Vec3>& vertices, const std::vector<Corners>& triangles,
                const std::string& source) {
  if (triangles.empty()) throw std::invalid_argument(source + ": no triangle; a mesh needs at least one");
  if (vertices.size() > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max()) ||
      triangles.size() > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max())) {
    throw std::invalid_argument(source + ": " + std::to_string(vertices.size()) + " vertices and " +
                                std::to_string(triangles.size()) +
                                " triangles; each may be at most 2147483647");
  }
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    if (!vertices[i].allFinite()) {
      throw std::invalid_argument(
          source + ": vertex " + std::to_string(i) +
          " has a coordinate that is not finite (NaN or infinite); every coordinate must be "
          "a finite number");
    }
  }
  const auto count = static_cast<std::int32_t>(vertices.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    for (const std::int32_t corner : triangles[i]) {
      if (corner < 0 || corner >= count) {
        throw std::invalid_argument(source + ": triangle " + std::to_string(i) + " names vertex " +
                                    std::to_string(corner) + "; there are " + std::to_string(count));
      }
    }
  }
}

/// Gives equal positions one index, in order of first use, and drops vertices that no triangle names.
void weld(TriangleMesh& mesh) {
  for (Vec3& vertex : mesh.vertices) vertex += Vec3::Zero();  // -0 becomes 0
  std::vector<std::int32_t> order(mesh.vertices.size());
  std::iota(order.begin(), order.end(), 0);
  const auto position = [&](std::int32_t i) {
    const Vec3& v = mesh.vertices[i];
    return std::make_tuple(v.x(), v.y(), v.z());
  };
  std::sort(order.begin(), order.end(), [&](std::int32_t i, std::int32_t j) {
    return std::make_pair(position(i), i) < std::make_pair(position(j), j);
  });
  std::vector<std::int32_t> first_equal(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) {
    const bool same = k > 0 && position(order[k]) == position(order[k - 1]);
    first_equal[order[k]] = same ? first_equal[order[k - 1]] : order[k];
  }
  std::vector<std::int32_t> new_index(order.size(), -1);
  std::vector<Vec3> kept;
  for (Corners& corners : mesh.triangles) {
    for (std::int32_t& corner : corners) {
      std::int32_t& index = new_index[first_equal[corner]];
      if (index < 0) {
        index = static_cast<std::int32_t>(kept.size());
        kept.push_back(mesh.vertices[corner]);
      }
      corner = index;
    }
  }
  mesh.vertices = std::move(kept);
}

std::size_t countDuplicates(const std::vector<Corners>& triangles) {
  std::vector<Corners> sorted = triangles;
  for (Corners& corners : sorted) std::sort(corners.begin(), corners.end());
  std::sort(sorted.begin(), sorted.end());
  std::size_t duplicates = 0;
  for (std::size_t i = 1; i < sorted.size(); ++i) duplicates += sorted[i] == sorted[i - 1];
  return duplicates;
}

/// A triangle whose corners weld together has no boundary (its edges cancel), so it cannot open or close a
/// surface: the pole rows of many exported spheres are such triangles.
void countEdges(TriangleMesh& mesh) {
  struct Use {
    std::int32_t from, to;  // from < to
    bool forward;
  };
  std::vector<Use> uses;
  uses.reserve(3 * mesh.triangles.size());
  for (const Corners& corners : mesh.triangles) {
    if (isCollapsed(corners)) continue;
    for (int i = 0; i < 3; ++i) {
      const std::int32_t from = corners[i], to = corners[(i + 1) % 3];
      uses.push_back({std::min(from, to), std::max(from, to), from < to});
    }
  }
  std::sort(uses.begin(), uses.end(), [](const Use& a, const Use& b) {
    return std::make_pair(a.from, a.to) < std::make_pair(b.from, b.to);
  });
  for (std::size_t begin = 0, end = 0; begin < uses.size(); begin = end) {
    int forward = 0, backward = 0;
    for (end = begin;
         end < uses.size() && uses[end].from == uses[begin].from && uses[end].to == uses[begin].to; ++end) {
      ++(uses[end].forward ? forward : backward);
    }
    if (forward + backward == 1)
      ++mesh.report.open_edges;
    else if (forward != 1 || backward != 1)
      ++mesh.report.odd_edges;
  }
  mesh.report.closed = !uses.empty() && mesh.report.open_edges == 0 && mesh.report.odd_edges == 0;
}

}  // namespace

TriangleMesh makeTriangleMesh(std::vector<Vec3> vertices, std::vector<Corners> triangles, SolidChoice solid,
                              const std::string& source) {
  checkInput(vertices, triangles, source);
  TriangleMesh mesh;
  mesh.vertices = std::move(vertices);
  mesh.triangles = std::move(triangles);
  weld(mesh);

  MeshReport& report = mesh.report;
  report.source = source;
  report.vertices = mesh.vertices.size();
  report.triangles = mesh.triangles.size();
  report.lower = report.upper = mesh.vertices.front();
  for (const Vec3& vertex : mesh.vertices) {
    report.lower = report.lower.cwiseMin(vertex);
    report.upper = report.upper.cwiseMax(vertex);
  }
  for (const Corners& corners : mesh.triangles) {
    report.degenerate_triangles +=
        isCollapsed(corners) ||
        isDegenerate(mesh.vertices[corners[0]], mesh.vertices[corners[1]], mesh.vertices[corners[2]]);
  }
  report.duplicate_triangles = countDuplicates(mesh.triangles);
  countEdges(mesh);

  if (solid == SolidChoice::kYes && !report.closed) {
    throw std::invalid_argument(
        source + ": solid: yes, but the mesh is not closed: " + std::to_string(report.open_edges) +
        " open edges and " + std::to_string(report.odd_edges) +
        " odd ones (both must be 0: every edge shared by exactly two oppositely directed "
        "triangles); close the mesh, or say solid: auto or no to use it as a surface");
  }
  mesh.solid = solid != SolidChoice::kNo && report.closed;
  return mesh;
}

}  // namespace collision_node::geometry

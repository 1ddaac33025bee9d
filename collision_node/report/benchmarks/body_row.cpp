#include <algorithm>
#include <cmath>

#include "collision_node/report/benchmarks/other_rows.h"
#include "collision_node/report/made_meshes.h"

namespace collision_node::report {
namespace {

constexpr double kBytesWanted = 100.0;  // a triangle, at most
constexpr double kSortsWanted = 5.0;    // times the sort, at most

std::vector<geometry::PlacedShape> shapesOf(const MeshPtr& mesh) {
  return {{geometry::Mesh{mesh}, geometry::Pose(), "made"}};
}

/// Every third bit of a key is one coordinate's, 21 bits each.
std::uint64_t mortonKey(const geometry::Vec3& share) {
  std::uint64_t key = 0;
  for (int k = 0; k < 3; ++k) {
    const auto cell = static_cast<std::uint64_t>(share[k] * 0x1p21);
    for (int bit = 0; bit < 21; ++bit) key |= (cell >> bit & 1) << (3 * bit + k);
  }
  return key;
}

std::vector<std::uint64_t> centroidKeys(const geometry::TriangleMesh& mesh) {
  const geometry::Vec3 lower = mesh.report.lower;
  const geometry::Vec3 size = 1.000001 * (mesh.report.upper - lower);
  std::vector<std::uint64_t> keys;
  for (const auto& t : mesh.triangles) {
    const geometry::Vec3 middle = (mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]) / 3.0;
    keys.push_back(mortonKey((middle - lower).cwiseQuotient(size)));
  }
  return keys;
}

void addLines(const std::string& name, const MeshPtr& mesh, bool only_ours, std::vector<Line>& lines) {
  const double triangles = static_cast<double>(mesh->triangles.size());
  const std::size_t before = liveBytes();
  const auto body = std::make_unique<geometry::Body>(shapesOf(mesh));
  const double bytes = static_cast<double>(liveBytes() - before) / triangles;
  Line memory;
  memory.row = "memory of a body, " + name;
  memory.ours = std::to_string(std::lround(bytes)) + " B/triangle";
  memory.reference = std::to_string(std::lround(kBytesWanted)) + " B";
  memory.reference_name = "the bound";
  memory.ratio = kBytesWanted / bytes;
  memory.reach = 1.0;
  memory.quality = "- | - | - | -";
  lines.push_back(memory);

  const std::vector<std::uint64_t> keys = centroidKeys(*mesh);
  std::vector<std::uint64_t> sorted;
  std::vector<std::function<void()>> calls = {[&] { geometry::Body built(shapesOf(mesh)); }};
  if (!only_ours) {
    calls.push_back([&] {
      sorted = keys;
      std::sort(sorted.begin(), sorted.end());
    });
  }
  const std::vector<double> seconds = timeByTurns(calls);
  Line build;
  build.row = "building a body, " + name;
  build.ours = readable(seconds[0]);
  build.reach = 1.0 / kSortsWanted;
  build.quality = "- | - | - | -";
  if (!only_ours) {
    build.reference = readable(seconds[1]);
    build.reference_name = "std::sort of Morton keys";
    build.ratio = seconds[1] / seconds[0];
  }
  lines.push_back(build);
}

}  // namespace

std::vector<Line> bodyLines(bool only_ours) {
  std::vector<Line> lines;
  addLines("vehicle", vehicle(), only_ours, lines);
  addLines("100k ball", noisySphere(112, 11), only_ours, lines);
  return lines;
}

}  // namespace collision_node::report

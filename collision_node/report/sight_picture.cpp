#include "collision_node/report/sight_picture.h"

#include <limits>
#include <ostream>

#include "collision_node/report/methods/own_methods.h"
#include "collision_node/report/methods/peer_models.h"
#include "collision_node/report/results_file.h"
#include "collision_node/report/scenes/building.h"
#include "collision_node/report/truth/marched_truth.h"
#include "test/oracle/flat_distance.h"

namespace collision_node::report {
namespace {

using geometry::Pose;
using geometry::Quat;
using geometry::Vec3;

/// The part whose triangle is nearest to a point on the surface.
std::string partAt(const Tank& tank, const Vec3& point) {
  int best = -1;
  oracle::Real nearest = std::numeric_limits<oracle::Real>::infinity();
  const auto& mesh = *tank.mesh;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    oracle::V3 corners[3];
    for (int k = 0; k < 3; ++k) corners[k] = oracle::exact(mesh.vertices[mesh.triangles[i][k]]);
    const oracle::Real gap = oracle::pointTriangle(oracle::exact(point), corners).upper;
    if (gap < nearest) nearest = gap, best = static_cast<int>(i);
  }
  return partOf(tank, best, point);
}

}  // namespace

std::vector<SightedShot> sightedShots(const Tank& tank) {
  constexpr double kDrive = 15.0, kSpeed = 2053.0;  // [m/s]
  const Vec3 launcher(-0.8, 128.0, 77.0);           // seen from the tank at the shot
  const motion::Nanoseconds flight_time = kSecond / 10;
  const Vec3 goals[] = {{-0.8, 0.9, 1.9}, {-0.2, 0.7, 2.1},  {-1.0, 0.3, 2.2}, {0.4, 0.8, 1.8},
                        {1.6, 0.5, 1.2},  {2.4, 1.2, 0.9},   {-2.3, 1.2, 1.0}, {-2.0, 0.2, 1.9},
                        {0.1, 1.4, 0.8},  {-1.5, 1.45, 0.7}, {2.9, 0.0, 1.91}, {-2.9, 0.4, 1.3}};
  QuerySet set;
  addBody(set, geometry::Mesh{tank.mesh});
  addBody(set, geometry::Sphere{0.05});
  for (const Vec3& goal : goals) {
    // Where the shot and the tank meet: |goal + drive t - launcher| = speed t, by a few turns of the fixed
    // point.
    double seconds = 0.07;
    for (int i = 0; i < 20; ++i) seconds = (goal + Vec3(kDrive * seconds, 0, 0) - launcher).norm() / kSpeed;
    const Vec3 velocity = (goal + Vec3(kDrive * seconds, 0, 0) - launcher) / seconds;
    set.queries.push_back(query(0, 1, flight(Pose(), Vec3(kDrive, 0, 0), flight_time),
                                flight({launcher, Quat::Identity()}, velocity, flight_time), flight_time));
  }
  const std::vector<Truth> truths = marchedTruths(set);
  const ContestantPtr sight = makeLineOfSight(set);
  std::vector<SightedShot> shots;
  for (std::size_t i = 0; i < truths.size(); ++i) {
    if (truths[i].verdict != Verdict::kHit) continue;
    SightedShot shot;
    shot.truth = set.queries[i].piece.a.at(truths[i].toi).inverse() * truths[i].point;
    shot.true_part = partAt(tank, shot.truth);
    const Answer seen = sight->answer(set.queries[i]);
    shot.sight = seen.point;  // the tank stands at the origin at the stamp
    if (seen.verdict == Verdict::kHit) shot.sighted_part = partAt(tank, shot.sight);
    shots.push_back(shot);
  }
  return shots;
}

void writeShots(std::ostream& out, const std::vector<SightedShot>& shots) {
  out << "true_part,sighted_part,true_x,true_y,true_z,sighted_x,sighted_y,sighted_z\n";
  for (const SightedShot& shot : shots) {
    out << shot.true_part << ',' << shot.sighted_part;
    for (const Vec3* point : {&shot.truth, &shot.sight}) {
      for (int k = 0; k < 3; ++k) out << ',' << cell((*point)[k]);
    }
    out << '\n';
  }
}

void writeTriangles(std::ostream& out, const Tank& tank) {
  out << "link,x0,y0,z0,x1,y1,z1,x2,y2,z2\n";
  for (std::size_t i = 0; i < tank.mesh->triangles.size(); ++i) {
    out << tank.object->links[tank.link_of_triangle[i]].name;
    for (const std::int32_t corner : tank.mesh->triangles[i]) {
      for (int k = 0; k < 3; ++k) out << ',' << cell(tank.mesh->vertices[corner][k]);
    }
    out << '\n';
  }
}

}  // namespace collision_node::report

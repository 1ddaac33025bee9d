#include "collision_node/report/scenes/tank.h"

#include <filesystem>
#include <stdexcept>

#include "collision_node/impact/paper_methods.h"
#include "collision_node/messages/resources.h"
#include "collision_node/report/scenes/building.h"
#include "collision_node/report/scenes/scenes.h"
#include "collision_node/report/truth/marched_truth.h"
#include "collision_node/scene/zones.h"

namespace collision_node::report {
namespace {

using geometry::Pose;
using geometry::Quat;
using geometry::Vec3;

}  // namespace

Tank loadTank() {
  // The checkout that this program was built in, else the package path.
  const scene::Resources here =
      messages::makeResources(std::filesystem::canonical("/proc/self/exe").string());
  const std::string package = here.package_path("collision_node");
  if (package.empty()) {
    throw std::runtime_error("the package collision_node is not in ROS_PACKAGE_PATH: source its setup.bash");
  }
  const std::string file = package + "/config/efp_tank/scene.yaml";
  Tank tank;
  tank.demo = scene::loadScene(file, messages::makeResources(file));
  for (const scene::Object& object : tank.demo->objects) {
    if (object.name == "tank") tank.object = &object;
  }
  if (tank.object == nullptr) throw std::runtime_error(file + ": has no object 'tank'");

  std::vector<Vec3> corners;
  std::vector<std::array<std::int32_t, 3>> triangles;
  const auto add = [&](const Vec3& p, const Vec3& q, const Vec3& r, std::size_t link) {
    const auto first = static_cast<std::int32_t>(corners.size());
    corners.insert(corners.end(), {p, q, r});
    triangles.push_back({first, first + 1, first + 2});
    tank.link_of_triangle.push_back(static_cast<int>(link));
  };
  for (std::size_t i = 0; i < tank.object->links.size(); ++i) {
    const geometry::Body& body = *tank.object->links[i].body;
    for (const geometry::PlacedShape& placed : body.shapes()) {
      const auto* shape = std::get_if<geometry::Mesh>(&placed.shape);
      if (shape == nullptr) continue;
      const auto& v = shape->mesh->vertices;
      for (const auto& t : shape->mesh->triangles) {
        add(placed.origin * v[t[0]], placed.origin * v[t[1]], placed.origin * v[t[2]], i);
      }
    }
    for (const auto& t : impact::tessellatePrimitives(body)) {
      // Convex, so outward is away from the middle; a solid needs all its triangles to face outward.
      const Vec3 &p = t.corners[0], &q = t.corners[1], &r = t.corners[2];
      const bool outward = (q - p).cross(r - p).dot(p - body.shapes()[t.shape].origin.position) > 0.0;
      add(p, outward ? q : r, outward ? r : q, i);
    }
  }
  tank.mesh = std::make_shared<geometry::TriangleMesh>(geometry::makeTriangleMesh(
      std::move(corners), std::move(triangles), geometry::SolidChoice::kAuto, "tank"));
  if (!tank.mesh->solid) throw std::runtime_error(file + ": the tank as one mesh is not closed");
  return tank;
}

std::string partOf(const Tank& tank, int triangle, const Vec3& point) {
  const scene::Link& link = tank.object->links[tank.link_of_triangle[triangle]];
  const Vec3 local = link.T_o_l.inverse() * point;
  const std::string zone = scene::findZone(*tank.object, link.name, local, local, 0.0).name;
  return zone.empty() ? link.name : link.name + "/" + zone;
}

Trials tankShots(std::size_t count, double radius) {
  const bool points = radius == 0.0;
  Trials trials{points ? "efp_point" : "efp_sphere",
                std::string(points ? "points" : "spheres of 5 cm") +
                    " at 2000 to 2400 m/s, the demo's tank at 15 m/s, 30 Hz",
                {},
                {}};
  const Tank tank = loadTank();
  addBody(trials.set, geometry::Mesh{tank.mesh});
  addBody(trials.set,
          points ? geometry::Shape(geometry::Point{}) : geometry::Shape(geometry::Sphere{radius}));
  const Vec3 lower = tank.mesh->report.lower, upper = tank.mesh->report.upper;
  Random random(8001);
  for (std::size_t i = 0; i < count; ++i) {
    // Aimed, from above, at where the tank will be when the shot arrives.
    const double yaw = random.in(-3.14, 3.14), speed = random.in(2000.0, 2400.0),
                 arrives = random.in(0.15, 0.85);
    const Quat turned(Eigen::AngleAxisd(yaw, Vec3::UnitZ()));
    const Vec3 drive = turned * Vec3(15.0, 0.0, 0.0), place = random.inBox({-20, -20, 0}, {20, 20, 0});
    const Vec3 goal = 0.5 * (lower + upper) + 0.55 * random.inBox(lower - upper, upper - lower);
    Vec3 from = random.direction();
    from.z() = 0.5 * std::abs(from.z()) + 0.1;
    const double seconds = arrives * 1e-9 * static_cast<double>(kFrame);
    const Vec3 target = place + turned * goal + seconds * drive;
    const Vec3 velocity = -speed * from.normalized();
    trials.set.queries.push_back(
        query(0, 1, flight({place, turned}, drive, kFrame),
              flight({target - seconds * velocity, Quat::Identity()}, velocity, kFrame), kFrame));
  }
  trials.truths = marchedTruths(trials.set);
  return trials;
}

}  // namespace collision_node::report

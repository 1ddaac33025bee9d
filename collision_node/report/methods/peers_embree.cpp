#include "collision_node/report/methods/peers.h"

#ifdef COLLISION_NODE_HAS_EMBREE

#include <embree3/rtcore.h>

#include "collision_node/report/methods/peer_models.h"

namespace collision_node::report {
namespace {

class EmbreeRays : public Contestant {
 public:
  explicit EmbreeRays(const QuerySet& set)
      : device_(rtcNewDevice("threads=1")),
        scene_(rtcNewScene(device_)),
        time_rounding_(set.queries.empty() ? 0.0 : 1e-6 * durationOf(set.queries[0].piece)) {
    const geometry::TriangleMesh& mesh = *only<geometry::Mesh>(*set.bodies[0])->mesh;
    const RTCGeometry triangles = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* points = static_cast<float*>(rtcSetNewGeometryBuffer(
        triangles, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), mesh.vertices.size()));
    for (const auto& v : mesh.vertices) {
      for (int k = 0; k < 3; ++k) *points++ = static_cast<float>(v[k]);
    }
    auto* corners = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
        triangles, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), mesh.triangles.size()));
    for (const auto& t : mesh.triangles) {
      for (int k = 0; k < 3; ++k) *corners++ = static_cast<unsigned>(t[k]);
    }
    rtcCommitGeometry(triangles);
    rtcAttachGeometry(scene_, triangles);
    rtcReleaseGeometry(triangles);
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_HIGH);
    rtcCommitScene(scene_);
  }
  ~EmbreeRays() override {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  EmbreeRays(const EmbreeRays&) = delete;
  EmbreeRays& operator=(const EmbreeRays&) = delete;

  std::string name() const override { return "Embree, robust"; }
  double timeRounding() const override { return time_rounding_; }

  Answer answer(const Query& query) override {
    const Path path = relativePath(query.piece);
    const geometry::Vec3 travel = path.end - path.start;
    RTCRayHit ray;
    ray.ray.org_x = static_cast<float>(path.start.x());
    ray.ray.org_y = static_cast<float>(path.start.y());
    ray.ray.org_z = static_cast<float>(path.start.z());
    ray.ray.dir_x = static_cast<float>(travel.x());
    ray.ray.dir_y = static_cast<float>(travel.y());
    ray.ray.dir_z = static_cast<float>(travel.z());
    ray.ray.tnear = 0.0f;
    ray.ray.tfar = 1.0f;
    ray.ray.time = 0.0f;
    ray.ray.mask = ~0u;
    ray.ray.flags = 0;
    ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene_, &context, &ray);
    if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return clear();
    const double share = static_cast<double>(ray.ray.tfar);
    Answer answer = hitAt(durationOf(query.piece) * share);
    answer.point = query.piece.a.c[0] + placeA(query.piece, answer.toi_lower) * (path.start + share * travel);
    return answer;
  }

 private:
  RTCDevice device_;
  RTCScene scene_;
  double time_rounding_;
};

}  // namespace

ContestantPtr makeEmbreeRays(const QuerySet& set) {
  if (set.bodies.size() != 2 || !only<geometry::Mesh>(*set.bodies[0]) ||
      !only<geometry::Point>(*set.bodies[1]) || !translates(set)) {
    return nullptr;
  }
  return std::make_unique<EmbreeRays>(set);
}

}  // namespace collision_node::report

#else

namespace collision_node::report {
ContestantPtr makeEmbreeRays(const QuerySet&) { return nullptr; }
}  // namespace collision_node::report

#endif

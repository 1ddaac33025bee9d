#ifdef COLLISION_NODE_HAS_EMBREE

#include "collision_node/report/methods/embree_scene.h"

namespace collision_node::report {

EmbreeScene::EmbreeScene(const std::vector<geometry::Vec3>& vertices,
                         const std::vector<std::array<std::int32_t, 3>>& triangles)
    : device_(rtcNewDevice("threads=1")), scene_(rtcNewScene(device_)) {
  const RTCGeometry mesh = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* points = static_cast<float*>(rtcSetNewGeometryBuffer(
      mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), vertices.size()));
  for (const geometry::Vec3& v : vertices)
    for (int k = 0; k < 3; ++k) *points++ = static_cast<float>(v[k]);
  auto* corners = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
      mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), triangles.size()));
  for (const auto& t : triangles)
    for (const std::int32_t corner : t) *corners++ = static_cast<unsigned>(corner);
  rtcCommitGeometry(mesh);
  rtcAttachGeometry(scene_, mesh);
  rtcReleaseGeometry(mesh);
  rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
  rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_HIGH);
  rtcCommitScene(scene_);
}

EmbreeScene::~EmbreeScene() {
  rtcReleaseScene(scene_);
  rtcReleaseDevice(device_);
}

std::optional<double> EmbreeScene::firstHit(const geometry::Vec3& from, const geometry::Vec3& way) const {
  RTCRayHit ray;
  ray.ray.org_x = static_cast<float>(from.x());
  ray.ray.org_y = static_cast<float>(from.y());
  ray.ray.org_z = static_cast<float>(from.z());
  ray.ray.dir_x = static_cast<float>(way.x());
  ray.ray.dir_y = static_cast<float>(way.y());
  ray.ray.dir_z = static_cast<float>(way.z());
  ray.ray.tnear = 0.0F;
  ray.ray.tfar = 1.0F;
  ray.ray.time = 0.0F;
  ray.ray.mask = ~0U;
  ray.ray.flags = 0;
  ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(scene_, &context, &ray);
  if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  return static_cast<double>(ray.ray.tfar);
}

}  // namespace collision_node::report

#endif

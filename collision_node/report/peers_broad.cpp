#include "collision_node/report/peers_broad.h"

#ifdef COLLISION_NODE_HAS_BULLET
#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <btBulletCollisionCommon.h>
#endif
#ifdef COLLISION_NODE_HAS_EMBREE
#include <embree3/rtcore.h>
#endif

namespace collision_node::report {

#ifdef COLLISION_NODE_HAS_BULLET

namespace {

btVector3 bullet(const geometry::Vec3& v) {
  return {static_cast<btScalar>(v.x()), static_cast<btScalar>(v.y()), static_cast<btScalar>(v.z())};
}

class BulletBroadPhase : public BroadPeer {
 public:
  explicit BulletBroadPhase(const std::vector<geometry::Bounds>& boxes) {
    // Every proxy needs an owner whose address differs.
    owners_.resize(boxes.size());
    for (std::size_t i = 0; i < boxes.size(); ++i)
      proxies_.push_back(broad_.createProxy(bullet(boxes[i].lower), bullet(boxes[i].upper), 0, &owners_[i],
                                            btBroadphaseProxy::DefaultFilter, btBroadphaseProxy::AllFilter,
                                            nullptr));
  }
  ~BulletBroadPhase() override {
    for (btBroadphaseProxy* proxy : proxies_) broad_.destroyProxy(proxy, nullptr);
  }

  std::size_t pairs(const std::vector<geometry::Bounds>& boxes) override {
    for (std::size_t i = 0; i < boxes.size(); ++i)
      broad_.setAabb(proxies_[i], bullet(boxes[i].lower), bullet(boxes[i].upper), nullptr);
    broad_.calculateOverlappingPairs(nullptr);
    return static_cast<std::size_t>(broad_.getOverlappingPairCache()->getNumOverlappingPairs());
  }

 private:
  btDbvtBroadphase broad_;
  std::vector<char> owners_;
  std::vector<btBroadphaseProxy*> proxies_;
};

}  // namespace

std::unique_ptr<BroadPeer> makeBulletBroadPhase(const std::vector<geometry::Bounds>& boxes) {
  return std::make_unique<BulletBroadPhase>(boxes);
}

#else

std::unique_ptr<BroadPeer> makeBulletBroadPhase(const std::vector<geometry::Bounds>&) { return nullptr; }

#endif

#ifdef COLLISION_NODE_HAS_EMBREE

namespace {

class EmbreeBoxes : public RayPeer {
 public:
  explicit EmbreeBoxes(const std::vector<geometry::Bounds>& boxes)
      : device_(rtcNewDevice("threads=1")), scene_(rtcNewScene(device_)) {
    constexpr unsigned kSides[12][3] = {{0, 1, 3}, {0, 3, 2}, {4, 6, 7}, {4, 7, 5}, {0, 4, 5}, {0, 5, 1},
                                        {2, 3, 7}, {2, 7, 6}, {0, 2, 6}, {0, 6, 4}, {1, 5, 7}, {1, 7, 3}};
    const RTCGeometry triangles = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* points = static_cast<float*>(rtcSetNewGeometryBuffer(
        triangles, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), 8 * boxes.size()));
    auto* corners = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
        triangles, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), 12 * boxes.size()));
    unsigned first = 0;
    for (const geometry::Bounds& box : boxes) {
      for (int corner = 0; corner < 8; ++corner)
        for (int k = 0; k < 3; ++k)
          *points++ = static_cast<float>((corner >> k) % 2 == 0 ? box.lower[k] : box.upper[k]);
      for (const auto& side : kSides)
        for (const unsigned corner : side) *corners++ = first + corner;
      first += 8;
    }
    rtcCommitGeometry(triangles);
    rtcAttachGeometry(scene_, triangles);
    rtcReleaseGeometry(triangles);
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_HIGH);
    rtcCommitScene(scene_);
  }
  ~EmbreeBoxes() override {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  EmbreeBoxes(const EmbreeBoxes&) = delete;
  EmbreeBoxes& operator=(const EmbreeBoxes&) = delete;

  bool hits(const geometry::Vec3& from, const geometry::Vec3& to) override {
    RTCRayHit ray = {};
    ray.ray.org_x = static_cast<float>(from.x());
    ray.ray.org_y = static_cast<float>(from.y());
    ray.ray.org_z = static_cast<float>(from.z());
    ray.ray.dir_x = static_cast<float>(to.x() - from.x());
    ray.ray.dir_y = static_cast<float>(to.y() - from.y());
    ray.ray.dir_z = static_cast<float>(to.z() - from.z());
    ray.ray.tfar = 1.0F;
    ray.ray.mask = ~0U;
    ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene_, &context, &ray);
    return ray.hit.geomID != RTC_INVALID_GEOMETRY_ID;
  }

 private:
  RTCDevice device_;
  RTCScene scene_;
};

}  // namespace

std::unique_ptr<RayPeer> makeEmbreeBoxes(const std::vector<geometry::Bounds>& boxes) {
  return std::make_unique<EmbreeBoxes>(boxes);
}

#else

std::unique_ptr<RayPeer> makeEmbreeBoxes(const std::vector<geometry::Bounds>&) { return nullptr; }

#endif

}  // namespace collision_node::report

#include "collision_node/report/peers_broad.h"

#ifdef COLLISION_NODE_HAS_BULLET
#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <btBulletCollisionCommon.h>
#endif
#ifdef COLLISION_NODE_HAS_EMBREE
#include "collision_node/report/methods/embree_scene.h"
#endif
#ifdef COLLISION_NODE_HAS_FCL
#include <fcl/broadphase/broadphase_SSaP.h>
#include <fcl/geometry/shape/sphere.h>
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

#ifdef COLLISION_NODE_HAS_FCL

namespace {

/// Any box: who asks for it is not told what shape or pose would give it.
class FclBox : public fcl::CollisionObjectd {
 public:
  FclBox(const std::shared_ptr<fcl::CollisionGeometryd>& shape, const geometry::Bounds& box)
      : CollisionObject(shape) {
    set(box);
  }
  void set(const geometry::Bounds& box) { aabb = fcl::AABBd(box.lower, box.upper); }
};

class FclBroadPhase : public BroadPeer {
 public:
  explicit FclBroadPhase(const std::vector<geometry::Bounds>& boxes) {
    const auto shape = std::make_shared<fcl::Sphered>(1.0);
    objects_.reserve(boxes.size());
    for (const geometry::Bounds& box : boxes) {
      objects_.push_back(std::make_unique<FclBox>(shape, box));
      manager_.registerObject(objects_.back().get());
    }
    manager_.setup();
  }

  std::size_t pairs(const std::vector<geometry::Bounds>& boxes) override {
    for (std::size_t i = 0; i < boxes.size(); ++i) objects_[i]->set(boxes[i]);
    manager_.update();
    std::size_t count = 0;
    manager_.collide(&count, [](fcl::CollisionObjectd*, fcl::CollisionObjectd*, void* data) {
      ++*static_cast<std::size_t*>(data);
      return false;
    });
    return count;
  }

 private:
  std::vector<std::unique_ptr<FclBox>> objects_;
  fcl::SSaPCollisionManagerd manager_;
};

}  // namespace

std::unique_ptr<BroadPeer> makeFclBroadPhase(const std::vector<geometry::Bounds>& boxes) {
  return std::make_unique<FclBroadPhase>(boxes);
}

#else

std::unique_ptr<BroadPeer> makeFclBroadPhase(const std::vector<geometry::Bounds>&) { return nullptr; }

#endif

#ifdef COLLISION_NODE_HAS_EMBREE

namespace {

class EmbreeBoxes : public RayPeer {
 public:
  EmbreeBoxes(const std::vector<geometry::Vec3>& corners,
              const std::vector<std::array<std::int32_t, 3>>& triangles)
      : embree_(corners, triangles) {}
  bool hits(const geometry::Vec3& from, const geometry::Vec3& to) override {
    return embree_.firstHit(from, to - from).has_value();
  }

 private:
  EmbreeScene embree_;
};

}  // namespace

std::unique_ptr<RayPeer> makeEmbreeBoxes(const std::vector<geometry::Bounds>& boxes) {
  constexpr std::int32_t kSides[12][3] = {{0, 1, 3}, {0, 3, 2}, {4, 6, 7}, {4, 7, 5}, {0, 4, 5}, {0, 5, 1},
                                          {2, 3, 7}, {2, 7, 6}, {0, 2, 6}, {0, 6, 4}, {1, 5, 7}, {1, 7, 3}};
  std::vector<geometry::Vec3> corners;
  std::vector<std::array<std::int32_t, 3>> triangles;
  for (const geometry::Bounds& box : boxes) {
    const std::int32_t first = static_cast<std::int32_t>(corners.size());
    for (const auto& side : kSides) triangles.push_back({first + side[0], first + side[1], first + side[2]});
    for (int corner = 0; corner < 8; ++corner) {
      corners.push_back(box.lower);
      for (int k = 0; k < 3; ++k)
        if ((corner >> k) % 2 == 1) corners.back()[k] = box.upper[k];
    }
  }
  return std::make_unique<EmbreeBoxes>(corners, triangles);
}

#else

std::unique_ptr<RayPeer> makeEmbreeBoxes(const std::vector<geometry::Bounds>&) { return nullptr; }

#endif

}  // namespace collision_node::report

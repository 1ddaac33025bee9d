#include "collision_node/report/peers.h"

#ifdef COLLISION_NODE_HAS_BULLET

#include <btBulletCollisionCommon.h>

#include <limits>

#include "collision_node/report/peer_models.h"

namespace collision_node::report {
namespace {

btVector3 bullet(const geometry::Vec3& v) {
  return {static_cast<btScalar>(v.x()), static_cast<btScalar>(v.y()), static_cast<btScalar>(v.z())};
}

class BulletSweep : public Contestant {
 public:
  explicit BulletSweep(const QuerySet& set)
      : ball_(static_cast<btScalar>(only<geometry::Sphere>(*set.bodies[1])->radius)) {
    const geometry::TriangleMesh& mesh = *only<geometry::Mesh>(*set.bodies[0])->mesh;
    for (const auto& t : mesh.triangles) {
      triangles_.addTriangle(bullet(mesh.vertices[t[0]]), bullet(mesh.vertices[t[1]]),
                             bullet(mesh.vertices[t[2]]));
    }
    shape_ = std::make_unique<btBvhTriangleMeshShape>(&triangles_, true);
    object_.setCollisionShape(shape_.get());
  }

  std::string name() const override { return "Bullet sphere sweep"; }
  double timeRounding() const override { return std::numeric_limits<double>::infinity(); }

  Answer answer(const Query& query) override {
    const Path path = pathBesideRest(query.piece);
    const btTransform from(btQuaternion::getIdentity(), bullet(path.start));
    const btTransform to(btQuaternion::getIdentity(), bullet(path.end));
    btCollisionWorld::ClosestConvexResultCallback closest(from.getOrigin(), to.getOrigin());
    btCollisionWorld::objectQuerySingle(&ball_, from, to, &object_, shape_.get(), object_.getWorldTransform(),
                                        closest, 0);
    if (!closest.hasHit()) return {Verdict::kClear, 0.0, 0.0, 0.0};
    const double t = durationOf(query.piece) * static_cast<double>(closest.m_closestHitFraction);
    return {Verdict::kHit, t, t, 0.0};
  }

 private:
  btTriangleMesh triangles_;
  std::unique_ptr<btBvhTriangleMeshShape> shape_;
  btSphereShape ball_;
  btCollisionObject object_;
};

}  // namespace

ContestantPtr makeBulletSweep(const QuerySet& set) {
  if (set.bodies.size() != 2 || !only<geometry::Mesh>(*set.bodies[0]) ||
      !only<geometry::Sphere>(*set.bodies[1])) {
    return nullptr;
  }
  return std::make_unique<BulletSweep>(set);
}

}  // namespace collision_node::report

#else

namespace collision_node::report {
ContestantPtr makeBulletSweep(const QuerySet&) { return nullptr; }
}  // namespace collision_node::report

#endif

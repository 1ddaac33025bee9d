#include "collision_node/report/methods/peers.h"

#ifdef COLLISION_NODE_HAS_BULLET

#include <BulletCollision/NarrowPhaseCollision/btContinuousConvexCollision.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkEpaPenetrationDepthSolver.h>
#include <btBulletCollisionCommon.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "collision_node/report/methods/peer_models.h"

namespace collision_node::report {
namespace {

btVector3 bullet(const geometry::Vec3& v) {
  return {static_cast<btScalar>(v.x()), static_cast<btScalar>(v.y()), static_cast<btScalar>(v.z())};
}

/// A primitive as Bullet has it; null for others. Cylinders and capsules lie along z there too, by these
/// classes.
std::unique_ptr<btConvexShape> primitive(const geometry::Body& body) {
  const auto scalar = [](double value) { return static_cast<btScalar>(value); };
  if (const auto* ball = only<geometry::Sphere>(body))
    return std::make_unique<btSphereShape>(scalar(ball->radius));
  if (const auto* box = only<geometry::Box>(body))
    return std::make_unique<btBoxShape>(bullet(0.5 * box->size));
  if (const auto* pill = only<geometry::Capsule>(body)) {
    return std::make_unique<btCapsuleShapeZ>(scalar(pill->radius), scalar(pill->length));
  }
  if (const auto* can = only<geometry::Cylinder>(body)) {
    return std::make_unique<btCylinderShapeZ>(bullet({can->radius, can->radius, 0.5 * can->length}));
  }
  return nullptr;
}

/// B's sphere against A, a mesh or a sphere, in A's frame.
class BulletSweep : public Contestant {
 public:
  explicit BulletSweep(const QuerySet& set)
      : ball_(primitive(*set.bodies[1])), target_(primitive(*set.bodies[0])) {
    if (!target_) {
      const geometry::TriangleMesh& mesh = *only<geometry::Mesh>(*set.bodies[0])->mesh;
      for (const auto& t : mesh.triangles) {
        triangles_.addTriangle(bullet(mesh.vertices[t[0]]), bullet(mesh.vertices[t[1]]),
                               bullet(mesh.vertices[t[2]]));
      }
      target_ = std::make_unique<btBvhTriangleMeshShape>(&triangles_, true);
    }
    object_.setCollisionShape(target_.get());
  }

  std::string name() const override { return "Bullet sphere sweep"; }
  double timeRounding() const override { return std::numeric_limits<double>::infinity(); }

  Answer answer(const Query& query) override {
    const Path path = relativePath(query.piece);
    const btTransform from(btQuaternion::getIdentity(), bullet(path.start));
    const btTransform to(btQuaternion::getIdentity(), bullet(path.end));
    btCollisionWorld::ClosestConvexResultCallback closest(from.getOrigin(), to.getOrigin());
    btCollisionWorld::objectQuerySingle(ball_.get(), from, to, &object_, target_.get(),
                                        object_.getWorldTransform(), closest, 0);
    if (!closest.hasHit()) return clear();
    Answer answer = hitAt(durationOf(query.piece) * static_cast<double>(closest.m_closestHitFraction));
    const btVector3& p = closest.m_hitPointWorld;
    const geometry::Vec3 point(p.x(), p.y(), p.z());
    answer.point = query.piece.a.c[0] + placeA(query.piece, answer.toi_lower) * point;
    return answer;
  }

 private:
  btTriangleMesh triangles_;
  std::unique_ptr<btConvexShape> ball_;
  std::unique_ptr<btCollisionShape> target_;
  btCollisionObject object_;
};

class BulletContinuous : public Contestant {
 public:
  explicit BulletContinuous(const QuerySet& set) {
    for (const auto& body : set.bodies) {
      shapes_.push_back(primitive(*body));
      if (shapes_.back() && !only<geometry::Sphere>(*body) && !only<geometry::Capsule>(*body)) {
        shapes_.back()->setMargin(btScalar(1e-4));
      }
    }
  }
  bool complete() const {
    return std::all_of(shapes_.begin(), shapes_.end(), [](const auto& shape) { return shape != nullptr; });
  }

  std::string name() const override { return "btContinuousConvexCollision"; }
  double timeRounding() const override { return std::numeric_limits<double>::infinity(); }

  Answer answer(const Query& query) override {
    const impact::Piece& piece = query.piece;
    const double duration = durationOf(piece);
    const double turn = duration * std::max(piece.a.omega.norm(), piece.b.omega.norm());
    const int parts = std::max(1, static_cast<int>(std::ceil(turn / kMostTurn)));
    for (int i = 0; i < parts; ++i) {
      const double from = duration * i / parts, to = duration * (i + 1) / parts;
      btVoronoiSimplexSolver simplex;
      btGjkEpaPenetrationDepthSolver depth;
      btContinuousConvexCollision cast(shapes_[query.a].get(), shapes_[query.b].get(), &simplex, &depth);
      btConvexCast::CastResult result;
      if (cast.calcTimeOfImpact(transform(placeA(piece, from)), transform(placeA(piece, to)),
                                transform(placeB(piece, from)), transform(placeB(piece, to)), result)) {
        Answer answer = hitAt(from + (to - from) * static_cast<double>(result.m_fraction));
        answer.point = piece.a.c[0] +
                       geometry::Vec3(result.m_hitPoint.x(), result.m_hitPoint.y(), result.m_hitPoint.z());
        return answer;
      }
    }
    return clear();
  }

 private:
  static constexpr double kMostTurn = 0.78;  // [rad] below pi/4, to which Bullet clamps a turn

  static btTransform transform(const geometry::Pose& pose) {
    const geometry::Quat& q = pose.orientation;
    return btTransform(btQuaternion(static_cast<btScalar>(q.x()), static_cast<btScalar>(q.y()),
                                    static_cast<btScalar>(q.z()), static_cast<btScalar>(q.w())),
                       bullet(pose.position));
  }

  std::vector<std::unique_ptr<btConvexShape>> shapes_;
};

}  // namespace

ContestantPtr makeBulletSweep(const QuerySet& set) {
  if (set.bodies.size() != 2 || !translates(set) || !only<geometry::Sphere>(*set.bodies[1]) ||
      (!only<geometry::Mesh>(*set.bodies[0]) && !only<geometry::Sphere>(*set.bodies[0]))) {
    return nullptr;
  }
  return std::make_unique<BulletSweep>(set);
}

ContestantPtr makeBulletContinuous(const QuerySet& set) {
  auto contestant = std::make_unique<BulletContinuous>(set);
  if (!isStraight(set) || !contestant->complete()) return nullptr;
  return contestant;
}

}  // namespace collision_node::report

#else

namespace collision_node::report {
ContestantPtr makeBulletSweep(const QuerySet&) { return nullptr; }
ContestantPtr makeBulletContinuous(const QuerySet&) { return nullptr; }
}  // namespace collision_node::report

#endif

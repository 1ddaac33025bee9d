#include "collision_node/report/peers.h"

#ifdef COLLISION_NODE_HAS_FCL

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/math/motion/interp_motion.h>
#include <fcl/narrowphase/continuous_collision.h>
#include <fcl/narrowphase/distance.h>

#include <limits>
#include <vector>

#include "collision_node/report/peer_models.h"

namespace collision_node::report {
namespace {

using geometry::Vec3;
using GeometryPtr = std::shared_ptr<fcl::CollisionGeometryd>;

template <typename Box>
GeometryPtr meshModel(const geometry::Body& body) {
  const auto* shape = only<geometry::Mesh>(body);
  if (shape == nullptr) return nullptr;
  std::vector<fcl::Triangle> triangles;
  for (const auto& t : shape->mesh->triangles) triangles.emplace_back(t[0], t[1], t[2]);
  auto model = std::make_shared<fcl::BVHModel<Box>>();
  model->beginModel(static_cast<int>(triangles.size()), static_cast<int>(shape->mesh->vertices.size()));
  model->addSubModel(shape->mesh->vertices, triangles);
  model->endModel();
  return model;
}

GeometryPtr primitiveModel(const geometry::Body& body) {
  if (const auto* box = only<geometry::Box>(body)) return std::make_shared<fcl::Boxd>(box->size);
  if (const auto* ball = only<geometry::Sphere>(body)) return std::make_shared<fcl::Sphered>(ball->radius);
  if (const auto* can = only<geometry::Cylinder>(body)) {
    return std::make_shared<fcl::Cylinderd>(can->radius, can->length);
  }
  if (const auto* pill = only<geometry::Capsule>(body)) {
    return std::make_shared<fcl::Capsuled>(pill->radius, pill->length);
  }
  return nullptr;
}

fcl::Transform3d transform(const geometry::Pose& pose) {
  fcl::Transform3d result = fcl::Transform3d::Identity();
  result.linear() = pose.orientation.toRotationMatrix();
  result.translation() = pose.position;
  return result;
}

/// Only the constructor that names the turning point sets every member and the velocities (FCL 0.7).
fcl::InterpMotion<double> motionOf(const motion::RigidMotion& motion, double duration) {
  const fcl::Transform3d from = transform(motion.at(0.0)), to = transform(motion.at(duration));
  fcl::InterpMotion<double> result(from.linear(), from.translation(), to.linear(), to.translation(),
                                   Vec3::Zero());
  result.integrate(0.0);
  return result;
}

class FclModels : public Contestant {
 public:
  FclModels(const QuerySet& set, GeometryPtr (*model)(const geometry::Body&)) : set_(set) {
    for (const auto& body : set.bodies) models_.push_back(model(*body));
  }
  bool complete() const {
    for (const auto& model : models_) {
      if (!model) return false;
    }
    return true;
  }

 protected:
  const QuerySet& set_;
  std::vector<GeometryPtr> models_;
};

class FclAdvancement : public FclModels {
 public:
  explicit FclAdvancement(const QuerySet& set) : FclModels(set, meshModel<fcl::RSSd>) {}

  std::string name() const override { return "fcl::distance advancement"; }
  double stopsAtGap() const override { return kGap; }

  Answer answer(const Query& query) override {
    const impact::Piece& piece = query.piece;
    const double end = durationOf(piece);
    const double speed = (piece.b.c[1] - piece.a.c[1]).norm() +
                         piece.a.omega.norm() * set_.bodies[query.a]->reach() +
                         piece.b.omega.norm() * set_.bodies[query.b]->reach();
    for (double t = 0.0; t <= end;) {
      fcl::DistanceResultd result;
      const double gap = fcl::distance(models_[query.a].get(), transform(piece.a.at(t)),
                                       models_[query.b].get(), transform(piece.b.at(t)), request_, result);
      if (gap <= kGap) return {Verdict::kHit, t, t, 0.0};
      if (speed == 0.0) break;
      t += gap / speed;
    }
    return {Verdict::kClear, 0.0, 0.0, 0.0};
  }

 private:
  static constexpr double kGap = 1e-5;  // [m]
  fcl::DistanceRequestd request_{false};
};

/// FCL's continuousCollide with one of its solvers.
class FclContinuous : public FclModels {
 public:
  FclContinuous(const QuerySet& set, GeometryPtr (*model)(const geometry::Body&), fcl::CCDSolverType solver,
                double time_rounding)
      : FclModels(set, model),
        request_(1000, 1e-3, fcl::CCDM_LINEAR, fcl::GST_LIBCCD, solver),
        time_rounding_(time_rounding) {}

  std::string name() const override {
    return request_.ccd_solver_type == fcl::CCDC_NAIVE ? "FCL, 1000 samples" : "FCL advancement";
  }
  double timeRounding() const override { return time_rounding_; }

  Answer answer(const Query& query) override {
    const double end = durationOf(query.piece);
    const fcl::InterpMotion<double> a = motionOf(query.piece.a, end), b = motionOf(query.piece.b, end);
    fcl::ContinuousCollisionResultd result;
    fcl::continuousCollide(models_[query.a].get(), &a, models_[query.b].get(), &b, request_, result);
    if (!result.is_collide) return {Verdict::kClear, 0.0, 0.0, 0.0};
    const double t = end * result.time_of_contact;
    return {Verdict::kHit, t, t, 0.0};
  }

 private:
  fcl::ContinuousCollisionRequestd request_;
  double time_rounding_;
};

template <typename T, typename... Arguments>
ContestantPtr make(Arguments&&... arguments) {
  auto contestant = std::make_unique<T>(std::forward<Arguments>(arguments)...);
  if (!contestant->complete()) return nullptr;
  return contestant;
}

}  // namespace

ContestantPtr makeFclAdvancement(const QuerySet& set) { return make<FclAdvancement>(set); }

ContestantPtr makeFclSampling(const QuerySet& set) {
  return make<FclContinuous>(set, meshModel<fcl::OBBRSSd>, fcl::CCDC_NAIVE, 0.0);
}

ContestantPtr makeFclPrimitives(const QuerySet& set) {
  return make<FclContinuous>(set, primitiveModel, fcl::CCDC_CONSERVATIVE_ADVANCEMENT,
                             std::numeric_limits<double>::infinity());
}

}  // namespace collision_node::report

#else

namespace collision_node::report {
ContestantPtr makeFclAdvancement(const QuerySet&) { return nullptr; }
ContestantPtr makeFclSampling(const QuerySet&) { return nullptr; }
ContestantPtr makeFclPrimitives(const QuerySet&) { return nullptr; }
}  // namespace collision_node::report

#endif

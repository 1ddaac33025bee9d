#include "collision_node/report/methods/peers.h"

#ifdef COLLISION_NODE_HAS_FCL

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/math/motion/interp_motion.h>
#include <fcl/narrowphase/continuous_collision.h>
#include <fcl/narrowphase/distance.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "collision_node/report/methods/peer_models.h"

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

/// A mesh or a primitive.
template <typename Box>
GeometryPtr anyModel(const geometry::Body& body) {
  const GeometryPtr model = primitiveModel(body);
  return model ? model : meshModel<Box>(body);
}

/// Only the constructor that names the turning point sets every member and the velocities (FCL 0.7).
fcl::InterpMotion<double> motionOf(const fcl::Transform3d& from, const fcl::Transform3d& to) {
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
  FclAdvancement(const QuerySet& set, GeometryPtr (*model)(const geometry::Body&), double gap)
      : FclModels(set, model), gap_(gap), request_(false) {
    request_.distance_tolerance = std::min(request_.distance_tolerance, 0.1 * gap);
  }

  std::string name() const override { return "fcl::distance advancement"; }
  double stopsAtGap() const override { return gap_; }

  Answer answer(const Query& query) override {
    const impact::Piece& piece = query.piece;
    const double end = durationOf(piece);
    const double speed = originSpeed(piece, end) + piece.a.omega.norm() * set_.bodies[query.a]->reach() +
                         piece.b.omega.norm() * set_.bodies[query.b]->reach();
    double t = 0.0;
    for (int step = 0; t <= end; ++step) {
      if (step == kMostSteps) return Answer();
      fcl::DistanceResultd result;
      const double gap = fcl::distance(models_[query.a].get(), transform(placeA(piece, t)),
                                       models_[query.b].get(), transform(placeB(piece, t)), request_, result);
      if (gap <= gap_) return hitAt(t);
      if (speed == 0.0) break;
      t += gap / speed;
    }
    return clear();
  }

 private:
  static constexpr int kMostSteps = 20000;  // then it has no answer

  /// Bound of the relative speed of the origins on the piece.
  static double originSpeed(const impact::Piece& piece, double end) {
    const double a = leadOf(piece.a, piece), b = leadOf(piece.b, piece);
    return (piece.b.velocity(b) - piece.a.velocity(a)).norm() +
           end * (bend(piece.a, a + end) + bend(piece.b, b + end));
  }
  /// Bound of the acceleration until then.
  static double bend(const motion::RigidMotion& motion, double s) {
    return motion.isStraight() ? 0.0 : 2.0 * motion.c[2].norm() + 6.0 * s * motion.c[3].norm();
  }

  double gap_;  // [m]
  fcl::DistanceRequestd request_;
};

/// fcl::collide at equal steps: what CCDC_NAIVE does, for any motion.
class FclSamples : public FclModels {
 public:
  FclSamples(const QuerySet& set, int steps) : FclModels(set, anyModel<fcl::OBBRSSd>), steps_(steps) {}

  std::string name() const override { return "FCL naive " + std::to_string(steps_); }

  Answer answer(const Query& query) override {
    const double end = durationOf(query.piece);
    for (int i = 0; i <= steps_; ++i) {
      const double t = end * i / steps_;
      fcl::CollisionResultd result;
      if (fcl::collide(models_[query.a].get(), transform(placeA(query.piece, t)), models_[query.b].get(),
                       transform(placeB(query.piece, t)), request_, result) > 0) {
        return hitAt(t);
      }
    }
    return clear();
  }

 private:
  int steps_;
  fcl::CollisionRequestd request_;
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
    const impact::Piece& piece = query.piece;
    const double end = durationOf(piece);
    const double turn = end * std::max(piece.a.omega.norm(), piece.b.omega.norm());
    const int parts = std::max(1, static_cast<int>(std::ceil(turn / kMostTurn)));
    for (int i = 0; i < parts; ++i) {
      const double from = end * i / parts, to = end * (i + 1) / parts;
      const fcl::InterpMotion<double> a =
          motionOf(transform(placeA(piece, from)), transform(placeA(piece, to)));
      const fcl::InterpMotion<double> b =
          motionOf(transform(placeB(piece, from)), transform(placeB(piece, to)));
      fcl::ContinuousCollisionResultd result;
      fcl::continuousCollide(models_[query.a].get(), &a, models_[query.b].get(), &b, request_, result);
      if (result.is_collide) return hitAt(from + (to - from) * result.time_of_contact);
    }
    return clear();
  }

 private:
  static constexpr double kMostTurn =
      3.14159;  // [rad] below half a turn: its motions take the shorter way round
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

ContestantPtr makeFclAdvancement(const QuerySet& set, double gap) {
  ContestantPtr meshes = make<FclAdvancement>(set, meshModel<fcl::RSSd>, gap);
  return meshes ? std::move(meshes) : make<FclAdvancement>(set, anyModel<fcl::RSSd>, gap);
}

ContestantPtr makeFclSamples(const QuerySet& set, int steps) { return make<FclSamples>(set, steps); }

ContestantPtr makeFclSampling(const QuerySet& set) {
  if (!isStraight(set)) return nullptr;
  return make<FclContinuous>(set, meshModel<fcl::OBBRSSd>, fcl::CCDC_NAIVE, 0.0);
}

ContestantPtr makeFclPrimitives(const QuerySet& set) {
  if (!isStraight(set)) return nullptr;
  return make<FclContinuous>(set, primitiveModel, fcl::CCDC_CONSERVATIVE_ADVANCEMENT,
                             std::numeric_limits<double>::infinity());
}

}  // namespace collision_node::report

#else

namespace collision_node::report {
ContestantPtr makeFclAdvancement(const QuerySet&, double) { return nullptr; }
ContestantPtr makeFclSamples(const QuerySet&, int) { return nullptr; }
ContestantPtr makeFclSampling(const QuerySet&) { return nullptr; }
ContestantPtr makeFclPrimitives(const QuerySet&) { return nullptr; }
}  // namespace collision_node::report

#endif

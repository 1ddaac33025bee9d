#include "collision_node/report/methods/peers.h"

#ifdef COLLISION_NODE_HAS_EMBREE

#include "collision_node/report/methods/embree_scene.h"
#include "collision_node/report/methods/peer_models.h"

namespace collision_node::report {
namespace {

class EmbreeRays : public Contestant {
 public:
  explicit EmbreeRays(const QuerySet& set)
      : EmbreeRays(*only<geometry::Mesh>(*set.bodies[0])->mesh,
                   set.queries.empty() ? 0.0 : 1e-6 * durationOf(set.queries[0].piece)) {}

  std::string name() const override { return "Embree, robust"; }
  double timeRounding() const override { return time_rounding_; }

  Answer answer(const Query& query) override {
    const Path path = relativePath(query.piece);
    const geometry::Vec3 travel = path.end - path.start;
    const std::optional<double> share = embree_.firstHit(path.start, travel);
    if (!share) return clear();
    Answer answer = hitAt(durationOf(query.piece) * *share);
    answer.point =
        query.piece.a.c[0] + placeA(query.piece, answer.toi_lower) * (path.start + *share * travel);
    return answer;
  }

 private:
  EmbreeRays(const geometry::TriangleMesh& mesh, double time_rounding)
      : embree_(mesh.vertices, mesh.triangles), time_rounding_(time_rounding) {}

  EmbreeScene embree_;
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

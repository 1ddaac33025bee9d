#include "collision_node/report/benchmarks/rows.h"

#include "collision_node/report/methods/peers.h"

namespace collision_node::report {
namespace {

QuerySet meshes1k(std::size_t count) { return tumblingMeshes(1000, count); }
QuerySet meshes10k(std::size_t count) { return tumblingMeshes(10000, count); }
QuerySet meshes100k(std::size_t count) { return tumblingMeshes(100000, count); }
QuerySet spinning(std::size_t count) { return splinterShots(count, 1e5); }

/// Ours on the same queries with B's spin taken away.
class WithoutSpin : public Contestant {
 public:
  explicit WithoutSpin(const QuerySet& set) : ours_(makeOurs(set)) {}
  std::string name() const override { return "without spin"; }
  Answer answer(const Query& query) override {
    Query still = query;
    still.piece.b.omega.setZero();
    return ours_->answer(still);
  }

 private:
  ContestantPtr ours_;
};

ContestantPtr withoutSpin(const QuerySet& set) { return std::make_unique<WithoutSpin>(set); }
ContestantPtr advancement(const QuerySet& set) { return makeFclAdvancement(set); }

}  // namespace

const std::vector<Row>& rows() {
  static const std::vector<Row> all = {
      {"mesh_1k", 200, meshes1k, advancement, 60.0},
      {"mesh_10k", 200, meshes10k, advancement, 100.0},
      {"mesh_100k", 100, meshes100k, advancement, 120.0},
      {"sampled_1k", 200, meshes1k, makeFclSampling, 20.0},
      {"sampled_10k", 200, meshes10k, makeFclSampling, 10.0},
      {"sampled_100k", 100, meshes100k, makeFclSampling, 8.0},
      {"particle", 10000, particleShots, makeEmbreeRays, 1.0 / 1.2},
      {"sphere", 5000, sphereShots, makeBulletSweep, 50.0},
      {"primitives", 2000, tumblingPrimitives, makeFclPrimitives, 12.0},
      {"spin", 100, spinning, withoutSpin, 1.0 / 12.0, false},
  };
  return all;
}

}  // namespace collision_node::report

#include "collision_node/report/methods/own_methods.h"
#include "collision_node/report/methods/peer_models.h"
#include "collision_node/report/methods/static_test.h"

namespace collision_node::report {
namespace {

class Sampled : public Contestant {
 public:
  Sampled(const QuerySet& set, int steps) : test_(set), steps_(steps) {}

  std::string name() const override { return "subdivision " + std::to_string(steps_); }

  Answer answer(const Query& query) override {
    const double duration = durationOf(query.piece);
    for (int i = 0; i <= steps_; ++i) {
      const double t = duration * i / steps_;
      if (test_.touching(query, t)) return hitAt(t);
    }
    return clear();
  }

 private:
  StaticTest test_;
  int steps_;
};

}  // namespace

ContestantPtr makeStamps(const QuerySet& set) { return std::make_unique<Sampled>(set, 1); }

ContestantPtr makeSubdivision(const QuerySet& set, int steps) {
  return std::make_unique<Sampled>(set, steps);
}

}  // namespace collision_node::report

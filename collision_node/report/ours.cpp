#include "collision_node/impact/solve.h"
#include "collision_node/report/contestant.h"

namespace collision_node::report {
namespace {

class Ours : public Contestant {
 public:
  explicit Ours(const QuerySet& set) : set_(set) {
    options_.time_precision = kPrecision;
    options_.scope = impact::Scope::kFirstContact;
  }

  std::string name() const override { return "ours"; }

  Answer answer(const Query& query) override {
    impact::solve(*set_.bodies[query.a], *set_.bodies[query.b], query.piece, options_, workspace_, solution_);
    Answer answer;
    if (solution_.events.empty()) {
      const bool apart =
          solution_.verdict == impact::Answer::kClear || solution_.verdict == impact::Answer::kCulled;
      answer.verdict = apart ? Verdict::kClear : Verdict::kUndecided;
      return answer;
    }
    const impact::PairEvent& first = solution_.events.front();
    answer.verdict =
        first.certificate == impact::Certificate::kConfirmed ? Verdict::kHit : Verdict::kUndecided;
    answer.toi_lower = first.toi_lower;
    answer.toi_upper = first.toi_upper;
    answer.closing_speed = first.closing_speed;
    return answer;
  }

 private:
  const QuerySet& set_;
  impact::PairOptions options_;
  impact::Workspace workspace_;
  impact::Solution solution_;
};

}  // namespace

ContestantPtr makeOurs(const QuerySet& set) { return std::make_unique<Ours>(set); }

}  // namespace collision_node::report

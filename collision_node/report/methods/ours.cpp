#include "collision_node/impact/solve.h"
#include "collision_node/report/contestant.h"

namespace collision_node::report {
namespace {

class Ours : public Contestant {
 public:
  Ours(const QuerySet& set, const impact::PairOptions& options) : set_(set), options_(options) {
    options_.scope = impact::Scope::kFirstContact;
  }

  std::string name() const override { return "ours"; }

  Answer answer(const Query& query) override {
    impact::solve(*set_.bodies[query.a], *set_.bodies[query.b], query.piece, options_, workspace_, solution_);
    Answer answer;
    answer.certified = true;
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
    answer.point = first.position;
    answer.position_error = first.position_error;
    return answer;
  }

 private:
  const QuerySet& set_;
  impact::PairOptions options_;
  impact::Workspace workspace_;
  impact::Solution solution_;
};

}  // namespace

ContestantPtr makeOurs(const QuerySet& set, const impact::PairOptions& options) {
  return std::make_unique<Ours>(set, options);
}

ContestantPtr makeOurs(const QuerySet& set) {
  impact::PairOptions options;
  options.time_precision = kPrecision;
  return makeOurs(set, options);
}

}  // namespace collision_node::report

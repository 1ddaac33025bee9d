#include "collision_node/report/benchmarks/other_rows.h"
#include "collision_node/report/linear_queries.h"

namespace collision_node::report {
namespace {

constexpr double kReach = 1.0 / 80.0;  // exact answers may cost this many of the reference's

struct Kind {
  const char* name;
  bool edges, made_by_hand;
};
constexpr Kind kKinds[] = {{"linear, simulation, edge-edge", true, false},
                           {"linear, simulation, vertex-face", false, false},
                           {"linear, by hand, edge-edge", true, true},
                           {"linear, by hand, vertex-face", false, true}};

/// Against the published truth, so neither side is late or early.
struct Score {
  std::size_t missed = 0, false_hits = 0, undecided = 0;

  std::string text() const {
    return std::to_string(missed) + "/" + std::to_string(false_hits) + "/-/" + std::to_string(undecided);
  }
};

impact::LinearVerdict ours(const LinearQuery& query) {
  const auto& v = query.vertices;
  return query.edges ? impact::edgeEdgeContact({v[0], v[1]}, {v[2], v[3]}).verdict
                     : impact::vertexFaceContact(v[0], {v[1], v[2], v[3]}).verdict;
}

impact::LinearVerdict fcl(const LinearQuery& query) {
  return fclLinearContact(query).value() ? impact::LinearVerdict::kImpact : impact::LinearVerdict::kClear;
}

template <typename Ask>
void answerAll(const std::vector<LinearQuery>& queries, std::vector<impact::LinearVerdict>& verdicts,
               Ask ask) {
  for (std::size_t i = 0; i < queries.size(); ++i) verdicts[i] = ask(queries[i]);
}

Score scoreOf(const std::vector<LinearQuery>& queries, const std::vector<impact::LinearVerdict>& verdicts) {
  Score score;
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const bool touches = queries[i].touches;
    score.undecided += verdicts[i] == impact::LinearVerdict::kUndecided ? 1 : 0;
    score.missed += touches && verdicts[i] == impact::LinearVerdict::kClear ? 1 : 0;
    score.false_hits += !touches && verdicts[i] == impact::LinearVerdict::kImpact ? 1 : 0;
  }
  return score;
}

Line measured(const Kind& kind, const std::vector<LinearQuery>& queries, bool only_ours) {
  const bool with_fcl = !only_ours && fclLinearContact(queries.front()).has_value();
  std::vector<impact::LinearVerdict> here(queries.size()), there(queries.size());
  std::vector<std::function<void()>> calls = {[&] { answerAll(queries, here, ours); }};
  if (with_fcl) calls.push_back([&] { answerAll(queries, there, fcl); });
  const std::vector<double> seconds = timeByTurns(calls);
  const double size = static_cast<double>(queries.size());
  std::size_t hits = 0;
  for (const impact::LinearVerdict verdict : here) hits += verdict == impact::LinearVerdict::kImpact ? 1 : 0;
  Line line;
  line.row = kind.name;
  line.ours = readable(seconds[0] / size);
  line.reach = kReach;
  line.quality = std::to_string(hits) + " of " + std::to_string(queries.size()) + " | " +
                 scoreOf(queries, here).text() + " | " +
                 (with_fcl ? scoreOf(queries, there).text() : std::string("-")) + " | -";
  if (with_fcl) {
    line.reference = readable(seconds[1] / size);
    line.reference_name = "FCL Intersect, Newton";
    line.ratio = seconds[1] / seconds[0];
  }
  return line;
}

}  // namespace

std::vector<Line> linearLines(const std::string& folder, bool only_ours) {
  const std::vector<LinearQuery> all = readLinearQueries(folder);
  std::vector<Line> lines;
  for (const Kind& kind : kKinds) {
    std::vector<LinearQuery> queries;
    for (const LinearQuery& query : all) {
      if (query.edges == kind.edges && query.made_by_hand == kind.made_by_hand) queries.push_back(query);
    }
    if (!queries.empty()) lines.push_back(measured(kind, queries, only_ours));
  }
  return lines;
}

}  // namespace collision_node::report

#include "collision_node/report/benchmarks/run.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <limits>

namespace collision_node::report {
namespace {

constexpr int kRepeats = 3;
constexpr double kLeastSeconds = 0.05;

class Smallest : public benchmark::BenchmarkReporter {
 public:
  explicit Smallest(std::size_t calls) : seconds_(calls, std::numeric_limits<double>::infinity()) {}

  bool ReportContext(const Context&) override { return true; }
  void ReportRuns(const std::vector<Run>& runs) override {
    for (const Run& run : runs) {
      if (run.run_type != Run::RT_Iteration || run.iterations == 0) continue;
      double& smallest = seconds_[std::stoul(run.run_name.function_name)];
      smallest = std::min(smallest, run.cpu_accumulated_time / static_cast<double>(run.iterations));
    }
  }
  const std::vector<double>& seconds() const { return seconds_; }

 private:
  std::vector<double> seconds_;
};

void answerAll(Contestant& contestant, const QuerySet& set, std::vector<Answer>& answers) {
  for (std::size_t i = 0; i < set.queries.size(); ++i) answers[i] = contestant.answer(set.queries[i]);
}

Outcome outcomeFor(const Contestant& contestant, const QuerySet& set) {
  Outcome outcome;
  outcome.name = contestant.name();
  outcome.answers.resize(set.queries.size());
  outcome.stops_at_gap = contestant.stopsAtGap();
  outcome.time_rounding = contestant.timeRounding();
  return outcome;
}

}  // namespace

std::vector<double> timeByTurns(const std::vector<std::function<void()>>& calls) {
  for (std::size_t i = 0; i < calls.size(); ++i) {
    const auto repeat = [&call = calls[i]](benchmark::State& state) {
      for (auto _ : state) call();
    };
    benchmark::RegisterBenchmark(std::to_string(i).c_str(), repeat)
        ->Repetitions(kRepeats)
        ->MinTime(kLeastSeconds);
  }
  Smallest smallest(calls.size());
  benchmark::RunSpecifiedBenchmarks(&smallest, "all");
  benchmark::ClearRegisteredBenchmarks();
  return smallest.seconds();
}

RowOutcome run(const Row& row, std::size_t count, bool only_ours) {
  const QuerySet set = row.queries(count);
  const ContestantPtr ours = makeOurs(set);
  const ContestantPtr reference = only_ours ? nullptr : row.reference_of(set);
  RowOutcome outcome;
  outcome.ours = outcomeFor(*ours, set);
  if (reference) outcome.reference = outcomeFor(*reference, set);

  std::vector<std::function<void()>> calls = {[&] { answerAll(*ours, set, outcome.ours.answers); }};
  if (reference) calls.push_back([&] { answerAll(*reference, set, outcome.reference->answers); });
  const std::vector<double> seconds = timeByTurns(calls);
  const double size = static_cast<double>(set.queries.size());
  outcome.ours.seconds = seconds[0] / size;
  if (reference) outcome.reference->seconds = seconds[1] / size;
  return outcome;
}

}  // namespace collision_node::report

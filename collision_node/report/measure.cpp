#include "collision_node/report/measure.h"

#include <malloc.h>

#include <algorithm>
#include <cmath>
#include <ctime>

#include "collision_node/report/methods/peer_models.h"

namespace collision_node::report {
namespace {

double cpuSeconds() {
  timespec now;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// What malloc has handed out, or NaN where this C library cannot say.
double bytesInUse() {
#if defined(__GLIBC__) && __GLIBC_PREREQ(2, 33)
  const auto info = mallinfo2();
  return static_cast<double>(info.uordblks + info.hblkhd);
#else
  return std::numeric_limits<double>::quiet_NaN();
#endif
}

struct Timed {
  Answer answer;
  double seconds;
};

Timed ask(Contestant& contestant, const Query& query) {
  constexpr double kLeast = 20e-6, kLong = 2e-3;
  const double start = cpuSeconds();
  Timed timed{contestant.answer(query), 0.0};
  timed.seconds = cpuSeconds() - start;
  const int calls = std::max(1, static_cast<int>(std::ceil(kLeast / std::max(timed.seconds, 1e-8))));
  for (int run = 0; run < 2 && timed.seconds < kLong; ++run) {
    const double from = cpuSeconds();
    for (int call = 0; call < calls; ++call) contestant.answer(query);
    timed.seconds = std::min(timed.seconds, (cpuSeconds() - from) / calls);
  }
  return timed;
}

/// The hierarchies of a set's bodies, which methods that read geometry::Body share; measured by building them
/// again.
double bytesOfBodies(const QuerySet& set) {
  std::vector<std::unique_ptr<geometry::Body>> again;
  const double before = bytesInUse();
  for (const auto& body : set.bodies) {
    again.push_back(std::make_unique<geometry::Body>(body->shapes()));
    const bool shot_at =
        set.bodies.size() == 2 && body == set.bodies[0] && set.bodies[1]->triangleCount() == 0;
    if (shot_at && body->triangleCount() > 0) again.back()->wideBvh();
  }
  return bytesInUse() - before;
}

}  // namespace

Row measure(const Method& method, const Trials& trials, double most_seconds) {
  Row row;
  row.scene = trials.name, row.family = method.family, row.method = method.name;
  row.queries = trials.set.queries.size();
  row.step = durationOf(trials.set.queries.front().piece);
  for (const Truth& truth : trials.truths) {
    if (truth.toi_error > row.truth_error) row.truth_error = truth.toi_error;
  }
  if (!method.installed) {
    row.reason = method.library + " was not found when this was built";
    return row;
  }
  const double before = bytesInUse();
  const ContestantPtr contestant = method.make(trials.set);
  if (!contestant) {
    row.reason = "takes " + method.takes;
    return row;
  }
  row.bytes = bytesInUse() - before + (method.library.empty() ? bytesOfBodies(trials.set) : 0.0);
  std::vector<Answer> answers;
  std::vector<double> seconds;
  const double start = cpuSeconds();
  for (const Query& query : trials.set.queries) {
    if (!answers.empty() && cpuSeconds() - start > most_seconds) break;
    const Timed timed = ask(*contestant, query);
    answers.push_back(timed.answer);
    seconds.push_back(timed.seconds);
  }
  row.score = scoreOf(trials, answers, seconds);
  return row;
}

}  // namespace collision_node::report

#include "collision_node/report/stability/walk.h"

#include <algorithm>
#include <ctime>

namespace collision_node::report {
namespace {

double threadSeconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

void ask(const Walker& walker, const Group& group, double seconds, Cell& cell) {
  const ContestantPtr contestant = walker.method.make(group.trials.set);
  const std::size_t trials = group.trials.truths.size();
  if (!contestant) {
    cell.not_offered += static_cast<int>(trials);
    return;
  }
  const double begin = threadSeconds();
  for (std::size_t i = 0; i < trials; ++i) {
    const double before = threadSeconds();
    if (before - begin > seconds && walker.method.family != "ours") {
      ++cell.not_asked;
      continue;
    }
    const Answer answer = contestant->answer(group.trials.set.queries[i]);
    cell.slowest = std::max(cell.slowest, threadSeconds() - before);
    const Mark mark = markOf(answer, group, i, walker.promise);
    ++cell.marks[static_cast<std::size_t>(mark)];
    if (answer.certified && answer.verdict == Verdict::kHit && mark == Mark::kKept) {
      cell.bracket = std::max(cell.bracket, answer.toi_upper - answer.toi_lower);
    }
  }
}

Walk walk(const Direction& direction, const std::vector<Walker>& walkers, const WalkOptions& options) {
  Walk result;
  result.direction = direction;
  result.cells.assign(walkers.size(), std::vector<Cell>(direction.values.size()));
  for (const Walker& walker : walkers) result.methods.push_back(walker.method.name);
  for (std::size_t rung = 0; rung < direction.values.size(); ++rung) {
    Random random(1000 + rung);
    for (const Group& group : direction.groups(direction.values[rung], options.count, random)) {
      for (std::size_t m = 0; m < walkers.size(); ++m) {
        ask(walkers[m], group, options.seconds, result.cells[m][rung]);
      }
    }
  }
  return result;
}

}  // namespace

int Cell::wrong() const {
  return count(Mark::kMissed) + count(Mark::kFalse) + count(Mark::kLate) + count(Mark::kEarly) +
         count(Mark::kBound);
}

int Cell::asked() const { return wrong() + count(Mark::kKept) + count(Mark::kUndecided); }

Range rangeOf(const Walk& walk, std::size_t method, bool decided) {
  const std::vector<Cell>& cells = walk.cells[method];
  const auto holds = [&](std::size_t rung) {
    const Cell& cell = cells[rung];
    return cell.asked() > 0 && cell.wrong() == 0 && (!decided || cell.count(Mark::kUndecided) == 0);
  };
  Range range;
  range.offered = std::any_of(cells.begin(), cells.end(), [](const Cell& cell) { return cell.asked() > 0; });
  std::size_t first = walk.direction.easy, last = first;
  range.empty = !holds(first);
  if (range.empty) return range;
  while (first > 0 && holds(first - 1)) --first;
  while (last + 1 < cells.size() && holds(last + 1)) ++last;
  range.lower = walk.direction.values[first];
  range.upper = walk.direction.values[last];
  range.whole = first == 0 && last + 1 == cells.size();
  return range;
}

std::vector<Walk> walkAll(const WalkOptions& options) {
  std::vector<Walker> walkers = allWalkers();
  if (options.only_ours) walkers.resize(1);
  std::vector<Walk> walks;
  for (const Direction& direction : allDirections(options.quick)) {
    if (options.begins) options.begins(direction);
    walks.push_back(walk(direction, walkers, options));
  }
  return walks;
}

}  // namespace collision_node::report

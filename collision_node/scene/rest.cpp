#include "collision_node/scene/rest.h"

#include <algorithm>

namespace collision_node::scene {

namespace {

Step restStep(const Track& a, const Track& b, std::size_t index, Nanoseconds start_ns, Nanoseconds end_ns) {
  Step step;
  step.what = Step::What::kPiece;
  step.piece = {start_ns, end_ns, a.restAt(index), b.restAt(index)};
  return step;
}

}  // namespace

std::optional<Step> firstRest(const TimeLine& time_line, int a, int b) {
  const Track& first = time_line.tracks()[a];
  const Track& second = time_line.tracks()[b];
  const std::size_t index = first.firstIndex();
  if (!first.has(index)) return std::nullopt;
  const Nanoseconds start = first.isFixed() ? time_line.firstReleased().value_or(0) : first.stamp(index);
  return restStep(first, second, index, start, start + 1);
}

Step lastRest(const TimeLine& time_line, int a, int b, Nanoseconds start_ns) {
  const Track& first = time_line.tracks()[a];
  std::size_t index = first.firstIndex();
  while (!first.isFixed() && first.has(index + 1)) ++index;
  const Nanoseconds newest = first.isFixed() ? time_line.newestReleased().value_or(start_ns)
                                             : first.lastReleased().value_or(start_ns);
  // As short as the first one: where that was asked must not show.
  const Nanoseconds end = std::max(start_ns, newest);
  return restStep(first, time_line.tracks()[b], index, std::max(start_ns, end - 1), end);
}

}  // namespace collision_node::scene

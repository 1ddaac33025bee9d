#include "collision_node/report/benchmarks/table.h"

#include <cmath>
#include <cstdio>

namespace collision_node::report {
namespace {

template <typename... Values>
std::string format(const char* pattern, Values... values) {
  char text[400];
  std::snprintf(text, sizeof text, pattern, values...);
  return text;
}

std::string faults(const Faults& side, bool late_judged) {
  if (!late_judged) return format("%zu/%zu/-/%zu", side.missed, side.false_hits, side.undecided);
  std::string text = format("%zu/%zu/%zu/%zu", side.missed, side.false_hits, side.late, side.undecided);
  if (side.late > 0) text += " (late by " + readable(side.worst_late) + ")";
  return text;
}

}  // namespace

std::string readable(double seconds) {
  if (seconds < 1e-6) return format("%.3g ns", seconds * 1e9);
  if (seconds < 1e-3) return format("%.3g us", seconds * 1e6);
  if (seconds < 1.0) return format("%.3g ms", seconds * 1e3);
  return format("%.3g s", seconds);
}

Line lineOf(const Row& row, const RowOutcome& outcome) {
  Line line;
  line.row = row.name;
  line.ours = readable(outcome.ours.seconds);
  line.reach = row.reach;
  const bool judged = outcome.reference && row.same_motion;
  const Comparison comparison =
      judged ? compare(outcome.ours.answers, outcome.reference->answers, kPrecision,
                       outcome.reference->stops_at_gap, outcome.reference->time_rounding)
             : compare(outcome.ours.answers, {}, kPrecision, 0.0, 0.0);
  line.quality = format("%zu of %zu | ", comparison.hits, outcome.ours.answers.size());
  line.quality += judged ? faults(comparison.ours, std::isfinite(outcome.reference->time_rounding))
                         : format("-/-/-/%zu", comparison.ours.undecided);
  line.quality += " | " + (judged ? faults(comparison.reference, true) : std::string("-"));
  line.quality += " | " + (judged ? readable(comparison.worst_error) : std::string("-"));
  if (outcome.reference) {
    line.reference_name = outcome.reference->name;
    line.reference = readable(outcome.reference->seconds);
    line.ratio = outcome.reference->seconds / outcome.ours.seconds;
  }
  return line;
}

Line lineOf(const std::string& row, double here, double there, const std::string& name, double reach,
            const std::string& quality) {
  Line line;
  line.row = row;
  line.ours = readable(here);
  line.reference = readable(there);
  line.reference_name = name;
  line.ratio = there / here;
  line.reach = reach;
  line.quality = quality;
  return line;
}

void print(const std::vector<Line>& lines) {
  std::printf(
      "| row | ours | reference | | ratio | reach | reached | hits | ours missed/false/late/undecided | "
      "reference's | worst difference |\n|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const Line& line : lines) {
    const std::string ratio = line.ratio ? format("%.3g", *line.ratio) : "-";
    const bool is_judged = line.ratio && line.reach > 0.0;
    const char* reached = !is_judged ? "-" : *line.ratio >= line.reach ? "yes" : "no";
    const std::string reach = line.reach > 0.0 ? format("%.3g", line.reach) : "-";
    const std::string reference = line.ratio ? line.reference : "absent";
    std::printf("| %s | %s | %s | %s | %s | %s | %s | %s |\n", line.row.c_str(), line.ours.c_str(),
                reference.c_str(), line.reference_name.c_str(), ratio.c_str(), reach.c_str(), reached,
                line.quality.c_str());
  }
}

}  // namespace collision_node::report

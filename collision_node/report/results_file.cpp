#include "collision_node/report/results_file.h"

#include <cmath>
#include <cstdio>
#include <ostream>

namespace collision_node::report {
namespace {

std::string quoted(const std::string& text) { return '"' + text + '"'; }

void writeSpread(std::ostream& out, const Spread& spread) {
  out << ',' << cell(spread.p50) << ',' << cell(spread.p99) << ',' << cell(spread.max);
}

}  // namespace

std::string cell(double value) {
  if (std::isnan(value)) return "";
  char text[32];
  std::snprintf(text, sizeof text, "%.5g", value);
  return text;
}

void writeResults(std::ostream& out, const std::vector<Row>& rows) {
  out << "scene,family,method,reason,queries,step_s,truth_error_s,answered,hits,unjudged,found,missed,false_"
         "hits,"
         "undecided,late,worst_late_s,broken_bounds,bytes";
  for (const char* name : {"time", "toi_error", "point_error", "claimed_time", "claimed_ball"}) {
    const char* unit =
        std::string(name).find("point") == 0 || std::string(name) == "claimed_ball" ? "_m" : "_s";
    for (const char* part : {"p50", "p99", "max"}) out << ',' << name << '_' << part << unit;
  }
  out << '\n';
  for (const Row& row : rows) {
    const Score& s = row.score;
    out << row.scene << ',' << quoted(row.family) << ',' << quoted(row.method) << ',' << quoted(row.reason)
        << ',' << row.queries << ',' << cell(row.step) << ',' << cell(row.truth_error);
    if (!row.reason.empty()) {
      out << std::string(26, ',') << '\n';
      continue;
    }
    for (const std::size_t count :
         {s.asked, s.hits, s.unjudged, s.found, s.missed, s.false_hits, s.undecided, s.late}) {
      out << ',' << count;
    }
    out << ',' << cell(s.worst_late) << ',' << s.broken_bounds << ',' << cell(row.bytes);
    for (const Spread& spread : {s.seconds, s.toi_error, s.point_error, s.claimed_time, s.claimed_ball}) {
      writeSpread(out, spread);
    }
    out << '\n';
  }
}

}  // namespace collision_node::report

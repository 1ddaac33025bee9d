#include "collision_node/report/stability/stability_file.h"

#include <ostream>

#include "collision_node/report/results_file.h"

namespace collision_node::report {
namespace {

std::string between(const Range& range) {
  if (range.empty) return "nowhere";
  if (range.lower == range.upper) return cell(range.lower) + " only";
  return cell(range.lower) + " to " + cell(range.upper);
}

/// Where it is never wrong, and where it decides every trial besides, if that is less.
std::string text(const Walk& walk, std::size_t method) {
  const Range right = rangeOf(walk, method, false), decided = rangeOf(walk, method, true);
  if (!right.offered) return "-";
  const std::string all = right.whole ? "all" : between(right);
  if (right.empty || (decided.lower == right.lower && decided.upper == right.upper && !decided.empty))
    return all;
  return all + "; decided " + between(decided);
}

}  // namespace

void writeCells(std::ostream& out, const std::vector<Walk>& walks) {
  out << "direction,about,unit,value,method,kept,undecided,missed,false,late,early,bound,not_asked,"
         "not_offered,bracket_s,slowest_s\n";
  for (const Walk& walk : walks) {
    for (std::size_t method = 0; method < walk.methods.size(); ++method) {
      for (std::size_t rung = 0; rung < walk.direction.values.size(); ++rung) {
        const Cell& c = walk.cells[method][rung];
        out << walk.direction.name << ",\"" << walk.direction.about << "\"," << walk.direction.unit << ','
            << walk.direction.values[rung] << ",\"" << walk.methods[method] << '"';
        for (const int marks : c.marks) out << ',' << marks;
        out << ',' << c.not_asked << ',' << c.not_offered << ',' << cell(c.bracket) << ',' << cell(c.slowest)
            << '\n';
      }
    }
  }
}

void writeRanges(std::ostream& out, const std::vector<Walk>& walks) {
  out << "The range of each direction, walked from its easy rung both ways, in which a method is never wrong "
         "on "
         "the trials\nthat its interface can state (`-`: none); and in which it decides all of them, where "
         "that "
         "is less.\n\n| direction | walked |";
  for (const std::string& method : walks.front().methods) out << ' ' << method << " |";
  out << "\n|---|---|";
  for (std::size_t i = 0; i < walks.front().methods.size(); ++i) out << "---|";
  out << '\n';
  for (const Walk& walk : walks) {
    const auto& values = walk.direction.values;
    out << "| " << walk.direction.name << " | " << cell(values.front()) << " to " << cell(values.back())
        << ' ' << walk.direction.unit << " |";
    for (std::size_t method = 0; method < walk.methods.size(); ++method) {
      out << ' ' << text(walk, method) << " |";
    }
    out << '\n';
  }
}

}  // namespace collision_node::report

/// collision_node_benchmarks: docs/benchmarks.md says what each row means.
#include <benchmark/benchmark.h>

#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "collision_node/report/benchmarks/other_rows.h"

namespace {

using namespace collision_node::report;

constexpr char kUsage[] =
    "usage: collision_node_benchmarks [--row NAME]... [--count N] [--only-ours] [--list] [--data DIR]\n"
    "  --row NAME   this row only (may be given again); default: all\n"
    "  --count N    queries in each row, instead of the row's own number\n"
    "  --only-ours  no reference runs: for profilers\n"
    "  --list       the names of the rows\n"
    "  --data DIR   the published queries of the row \"linear\"; default: ../shared/data/ccd-queries beside "
    "the sources\n";

constexpr char kLinear[] = "linear";
constexpr struct {
  const char* name;
  std::vector<Line> (*lines)(bool only_ours);
} kOthers[] = {{"body", bodyLines}, {"broad", broadLines}, {"engine", engineLines}};

struct Options {
  std::vector<std::string> names;
  std::size_t count = 0;
  bool only_ours = false, list = false;
  std::string data = SOURCE_DIR "/../shared/data/ccd-queries";
};

bool parse(int argc, char** argv, Options& options) {
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--only-ours") {
      options.only_ours = true;
    } else if (word == "--list") {
      options.list = true;
    } else if (word == "--row" && i + 1 < argc) {
      options.names.push_back(argv[++i]);
    } else if (word == "--data" && i + 1 < argc) {
      options.data = argv[++i];
    } else if (word == "--count" && i + 1 < argc) {
      options.count = std::strtoul(argv[++i], nullptr, 10);
      if (options.count == 0) return false;
    } else {
      return false;
    }
  }
  for (const std::string& name : options.names) {
    bool known = name == kLinear;
    for (const auto& other : kOthers) known = known || name == other.name;
    for (const Row& row : rows()) known = known || row.name == name;
    if (!known) return false;
  }
  return true;
}

bool wanted(const Options& options, const std::string& name) {
  for (const std::string& one : options.names) {
    if (one == name) return true;
  }
  return options.names.empty();
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  if (!parse(argc, argv, options)) {
    std::fputs(kUsage, stderr);
    return 2;
  }
  char program[] = "collision_node_benchmarks", by_turns[] = "--benchmark_enable_random_interleaving=true";
  char* arguments[] = {program, by_turns, nullptr};
  int count = 2;
  benchmark::Initialize(&count, arguments);
  std::vector<Line> lines;
  const auto wantsRun = [&options](const std::string& name) {
    if (!wanted(options, name)) return false;
    std::fprintf(options.list ? stdout : stderr, options.list ? "%s\n" : "%s ...\n", name.c_str());
    return !options.list;
  };
  for (const Row& row : rows()) {
    if (!wantsRun(row.name)) continue;
    lines.push_back(lineOf(row, run(row, options.count ? options.count : row.count, options.only_ours)));
  }
  if (wantsRun(kLinear)) {
    const std::vector<Line> more = linearLines(options.data, options.only_ours);
    if (more.empty()) std::fprintf(stderr, "linear: skipped, no queries in %s\n", options.data.c_str());
    lines.insert(lines.end(), more.begin(), more.end());
  }
  for (const auto& other : kOthers) {
    if (!wantsRun(other.name)) continue;
    const std::vector<Line> more = other.lines(options.only_ours);
    lines.insert(lines.end(), more.begin(), more.end());
  }
  if (!options.list) print(lines);
  return 0;
}

#include "collision_node/replay/options.h"

#include <cmath>
#include <cstdlib>

namespace collision_node::replay {

const char* const kUsage = R"(replay: finds the impacts in recorded poses; needs no master.

  replay scene.yaml in.bag [more.bag ...] [options]
  replay scene.yaml --plan
  replay merge a.jsonl b.jsonl ... [--jsonl FILE]

  --jsonl FILE   one JSON object per event and line; "-" is standard output (then no table is printed)
  --csv FILE     the same as CSV
  --out FILE     a bag (lz4) with impacts, markers, stats and plan under /collision_node/, and the input poses
  --from S       only what the messages received from S seconds after the first one on say
  --to S         only what the messages received before S seconds after the first one say; with either, the JSON
                 lines begin and end with the contacts open there, and `replay merge` joins adjoining windows
  --lead S       read at least so many seconds before --from, to know what counts there (default: what the
                 scene's times ask for, and more where that does not tell; merge says when it was too little)
  --plan         print what the scene becomes: objects, pairs, solvers, what is left out and why
  --method M     certified (default), paper_a or paper_b
  --threads N    how many threads may work; the answers do not depend on it
  --timing       measure: wall time in stats and a line at the end (the stats then differ from run to run)
  --ns NS        namespace of the scene's relative topics (default /)
  --help         this text

Ctrl-C ends the window there: what is decided is written. A second one gives up.
Exit code: 0 done, 2 bad input, 3 some query met its budget (its event says so), 130 interrupted.
)";

namespace {

constexpr double kLongest = 1e9;  // [s], 31 years: the sum with any ROS time stays in 64 bits of nanoseconds

double seconds(const std::string& option, const std::string& text) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != '\0' || !(value >= 0.0 && value <= kLongest))
    throw InputError(option + " '" + text + "': must be a number of seconds from 0 to 1e9");
  return value;
}

/// Standard output by another name; opened a second time it would be written over itself.
std::string fileName(const std::string& text) { return text == "/dev/stdout" ? "-" : text; }

int count(const std::string& option, const std::string& text) {
  char* end = nullptr;
  const long value = std::strtol(text.c_str(), &end, 10);
  if (text.empty() || *end != '\0' || value < 1 || value > 1024)
    throw InputError(option + " '" + text + "': must be a whole number from 1 to 1024");
  return static_cast<int>(value);
}

}  // namespace

Options parseOptions(const std::vector<std::string>& arguments) {
  Options out;
  std::vector<std::string> plain;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    std::string name = arguments[i];
    if (name.size() < 2 || name[0] != '-') {
      plain.push_back(name);
      continue;
    }
    std::optional<std::string> attached;
    if (const auto equals = name.find('='); name.rfind("--", 0) == 0 && equals != std::string::npos) {
      attached = name.substr(equals + 1);
      name.erase(equals);
    }
    const auto value = [&]() -> std::string {
      if (attached) return *attached;
      if (i + 1 == arguments.size()) throw InputError(name + " needs a value; see replay --help");
      return arguments[++i];
    };
    const auto flag = [&] {
      if (attached) throw InputError(name + " takes no value, got '" + *attached + "'");
      return true;
    };
    if (name == "--jsonl") {
      out.jsonl = fileName(value());
    } else if (name == "--csv") {
      out.csv = fileName(value());
    } else if (name == "--out") {
      out.out = fileName(value());
    } else if (name == "--from") {
      out.from = seconds(name, value());
    } else if (name == "--lead") {
      out.lead = seconds(name, value());
    } else if (name == "--to") {
      out.to = seconds(name, value());
    } else if (name == "--method") {
      try {
        out.method = impact::parseMethod(value());
      } catch (const std::invalid_argument& error) {
        throw InputError(name + ": " + error.what());
      }
    } else if (name == "--threads") {
      out.threads = count(name, value());
    } else if (name == "--ns") {
      out.name_space = value();
    } else if (name == "--plan") {
      out.plan = flag();
    } else if (name == "--timing") {
      out.timing = flag();
    } else if (name == "--help" || name == "-h") {
      out.help = flag();
    } else {
      throw InputError("unknown option " + name + "; see replay --help");
    }
  }
  if (out.help) return out;
  if (plain.empty())
    throw InputError("no scene given: replay scene.yaml in.bag [options]; see replay --help");
  out.scene = plain.front();
  out.bags.assign(plain.begin() + 1, plain.end());
  if (out.bags.empty() && !out.plan)
    throw InputError("no bag given: replay " + out.scene + " in.bag [options]");
  if (out.from && out.to && *out.from > *out.to)
    throw InputError("--from " + std::to_string(*out.from) + " lies after --to " + std::to_string(*out.to));
  return out;
}

std::string resolveTopic(const std::string& name_space, const std::string& topic) {
  if (!topic.empty() && topic.front() == '/') return topic;
  std::string prefix = name_space;
  if (prefix.empty() || prefix.front() != '/') prefix = "/" + prefix;
  if (prefix.back() != '/') prefix += '/';
  return prefix + topic;
}

}  // namespace collision_node::replay

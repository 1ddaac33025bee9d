#include "collision_node/report/options.h"

#include <stdexcept>

namespace collision_node::report {

const char kUsage[] =
    "usage: report [--quick] [--out DIR]                        error against run time: methods x scenes\n"
    "       report --stability [--quick] [--out DIR]            each hard direction until it breaks\n"
    "       report --scene F.yaml --bag F.bag... [--out DIR]    the same for your own data\n"
    "       report --from-bag F.bag [--out DIR]                 error against run time of a recorded run\n"
    "Writes CSV, Markdown and, with python3-matplotlib, diagrams (SVG, PNG) into DIR (default: report).\n";

Options parseOptions(const std::vector<std::string>& arguments) {
  Options options;
  bool stability = false, from_bag = false;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const std::string& word = arguments[i];
    const auto value = [&] {
      if (i + 1 == arguments.size()) throw std::invalid_argument(word + " needs a value");
      return arguments[++i];
    };
    if (word == "--quick") {
      options.quick = true;
    } else if (word == "--stability") {
      stability = true;
    } else if (word == "--out") {
      options.out = value();
    } else if (word == "--scene") {
      options.scene = value();
    } else if (word == "--bag") {
      options.bags.push_back(value());
    } else if (word == "--from-bag") {
      from_bag = true;
      options.bags = {value()};
    } else if (word == "--help" || word == "-h") {
      options.mode = Options::Mode::kHelp;
      return options;
    } else {
      throw std::invalid_argument("unknown option '" + word + "'; --help lists them");
    }
  }
  const bool own = !options.scene.empty() || (!from_bag && !options.bags.empty());
  if (stability + from_bag + own > 1) {
    throw std::invalid_argument("only one of --stability, --from-bag and --scene with --bag at a time");
  }
  if (own && (options.scene.empty() || options.bags.empty())) {
    throw std::invalid_argument("--scene and --bag go together: a scene file and the bags with its poses");
  }
  if (stability) options.mode = Options::Mode::kStability;
  if (from_bag) options.mode = Options::Mode::kFromBag;
  if (own) options.mode = Options::Mode::kOwnScene;
  return options;
}

}  // namespace collision_node::report

#include <exception>
#include <iostream>
#include <string>
#include <vector>

#include "collision_node/report/modes.h"

namespace {

using namespace collision_node::report;

int run(const Options& options) {
  switch (options.mode) {
    case Options::Mode::kErrorAgainstTime:
      return runErrorAgainstTime(options, std::cout);
    case Options::Mode::kStability:
      return runStability(options, std::cout);
    case Options::Mode::kOwnScene:
      return runOwnScene(options, std::cout);
    case Options::Mode::kFromBag:
      return runFromBag(options, std::cout);
    case Options::Mode::kHelp:
      break;
  }
  std::cout << kUsage;
  return kDone;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(parseOptions(std::vector<std::string>(argv + 1, argv + argc)));
  } catch (const std::exception& error) {
    std::cerr << "report: " << error.what() << '\n';
    return kBadInput;
  }
}

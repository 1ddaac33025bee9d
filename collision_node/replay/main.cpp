#include <unistd.h>

#include <exception>
#include <iostream>
#include <string>
#include <vector>

#include "collision_node/replay/replay.h"

int main(int argc, char** argv) {
  namespace replay = collision_node::replay;
  try {
    const replay::Options options = replay::parseOptions(std::vector<std::string>(argv + 1, argv + argc));
    return replay::run(options, std::cout, std::cerr, isatty(STDERR_FILENO) == 1);
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return replay::kBadInput;
  }
}

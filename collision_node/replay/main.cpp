#include <unistd.h>

#include <exception>
#include <iostream>
#include <string>
#include <vector>

#include "collision_node/replay/interrupts.h"
#include "collision_node/replay/merge.h"
#include "collision_node/replay/replay.h"

int main(int argc, char** argv) {
  namespace replay = collision_node::replay;
  try {
    const std::vector<std::string> words(argv + 1, argv + argc);
    if (!words.empty() && words[0] == "merge")
      return replay::merge(replay::parseMergeOptions({words.begin() + 1, words.end()}), std::cout);
    const replay::Options options = replay::parseOptions(words);
    replay::countInterrupts();
    return replay::run(options, std::cout, std::cerr, isatty(STDERR_FILENO) == 1);
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return replay::kBadInput;
  }
}

/// The command line of `replay`.
#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "collision_node/impact/pair_method.h"

namespace collision_node::replay {

struct Options {
  std::string scene;
  std::vector<std::string> bags;
  std::string jsonl;  ///< "" none, "-" standard output
  std::string csv;
  std::string out;                 ///< result bag
  std::optional<double> from, to;  ///< [s] of receive time after the first message: the window [from, to)
  double lead = 0.0;               ///< [s] how far before `from` is read at least
  bool plan = false;
  impact::MethodName method = impact::MethodName::kCertified;
  int threads = 1;  ///< a wish; the answers never depend on it
  bool timing = false;
  std::string name_space = "/";  ///< in which relative topics of the scene are resolved
  bool help = false;
};

/// Bad input: what() is one or more whole lines for the user; the program ends with code 2.
struct InputError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Throws InputError that names the argument.
Options parseOptions(const std::vector<std::string>& arguments);

extern const char* const kUsage;

/// "tank/pose" in "/" -> "/tank/pose"; a topic with a leading slash stays.
std::string resolveTopic(const std::string& name_space, const std::string& topic);

}  // namespace collision_node::replay

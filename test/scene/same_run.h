/// What two engines that are given the same must agree in.
#pragma once

#include <algorithm>
#include <sstream>
#include <string>
#include <vector>

#include "test/scene/engine_fixture.h"

namespace collision_node::scene {

inline std::uint64_t allBins(const Stats& s) {
  return s.pairs_culled + s.pairs_clear + s.pairs_impact + s.pairs_undecided + s.pairs_uncovered;
}

/// What must be the same whether pairs rest or not: all but what is culled and what is clear, and the cost.
inline std::string text(const Stats& s) {
  std::ostringstream out;
  out << "epoch " << s.epoch << " at " << s.stamp_ns << " watermark " << s.watermark_ns << " apart "
      << s.pairs_culled + s.pairs_clear << " impact " << s.pairs_impact << " undecided " << s.pairs_undecided
      << " uncovered " << s.pairs_uncovered << " holes " << s.holes << std::hexfloat << " bracket "
      << s.worst_bracket << " ball " << s.worst_position_error;
  for (const std::string& name : s.uncovered_objects) out << ' ' << name;
  return out.str();
}

inline std::vector<std::string> texts(const std::vector<Stats>& beats) {
  std::vector<std::string> out;
  for (const Stats& beat : beats) out.push_back(text(beat));
  return out;
}

/// "" when they are the same.
inline std::string difference(const std::vector<std::string>& got, const std::vector<std::string>& expected) {
  const std::size_t most = std::max(got.size(), expected.size());
  for (std::size_t i = 0; i < most; ++i) {
    const std::string l = i < got.size() ? got[i] : "nothing",
                      r = i < expected.size() ? expected[i] : "nothing";
    if (l != r) return "number " + std::to_string(i) + "\ngot      " + l + "\nexpected " + r;
  }
  return "";
}

}  // namespace collision_node::scene

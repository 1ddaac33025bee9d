/// Which objects a scene needs at all: what is in no watched pair is not read, heard, waited for or drawn.
#pragma once

#include <string>
#include <vector>

namespace collision_node::scene {

struct Scene;

enum class Need : char {
  kNone,      ///< in no watched pair, and nothing that is hangs on it
  kAsParent,  ///< in none either, but joints put parts on it that are: only its poses are needed
  kWatched,   ///< in a watched pair of links
};

/// By object. Costs time in the number of objects and of exceptions, not of pairs.
std::vector<Need> needsOf(const Scene& scene);

/// One line for each object, or part of one, that is not watched: its name, why, and what is not done for it.
std::vector<std::string> leftOut(const Scene& scene);

}  // namespace collision_node::scene

/// The pieces on which the pairs of a scene are solved, from bags.
#pragma once

#include <string>
#include <vector>

#include "collision_node/report/trial.h"
#include "collision_node/scene/scene.h"

namespace collision_node::report {

/// One watched pair of links.
struct RecordedPair {
  std::size_t pieces = 0;  ///< that the bags held
  std::size_t costly = 0;  ///< of these, not apart by their bounds alone
  QuerySet set;            ///< at most `most` of the costly ones, at equal distances
  std::string name;        ///< "object.link - object"; no link where it is the only one
};

/// Reads the bags as replay does (messages/pose_router), with relative topics in /. Throws std::runtime_error
/// with lines for people: a bag that cannot be read, a topic that is in none.
std::vector<RecordedPair> recordPieces(const std::shared_ptr<const scene::Scene>& scene,
                                       const std::vector<std::string>& bags, std::size_t most);

}  // namespace collision_node::report

/// The counts of a heartbeat. Every watched pair of links is in exactly one bin; pairs that nobody has ever
/// looked at are counted by what their objects are, without a list of them.
#pragma once

#include <memory>
#include <vector>

#include "collision_node/scene/coverage.h"
#include "collision_node/scene/object_pair.h"

namespace collision_node::scene {

class PairCounter {
 public:
  explicit PairCounter(const Scene& scene);

  /// `pairs` and `statics`: those that exist. `are_tested`: fixed objects are proved apart or in `statics`.
  void count(const TimeLine& time_line, const Coverage& coverage,
             const std::vector<std::unique_ptr<ObjectPair>>& pairs,
             const std::vector<std::unique_ptr<ObjectPair>>& statics, bool are_tested, Stats& stats) const;

 private:
  /// Two objects whose number of watched pairs is not the product of their links.
  struct Exception {
    int a, b;
    std::int64_t more;
  };

  const Scene& scene_;
  bool watches_rest_;
  std::vector<std::uint64_t> weights_;  ///< by object: links that can touch
  std::vector<Exception> exceptions_;
};

/// Sums up what became of the poses, and names the objects that are missed or had a hole.
void countInputs(const Scene& scene, const TimeLine& time_line, const Coverage& coverage, Stats& stats);

}  // namespace collision_node::scene

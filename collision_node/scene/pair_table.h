/// All pairs of a scene that are more than proved apart at a distance: who is awake, who rests, and what has
/// to be solved when something becomes known.
#pragma once

#include <memory>
#include <optional>
#include <set>
#include <unordered_map>
#include <utility>
#include <vector>

#include "collision_node/scene/alarms.h"
#include "collision_node/scene/broad_phase/broad_phase.h"
#include "collision_node/scene/coverage.h"
#include "collision_node/scene/crew.h"
#include "collision_node/scene/event_queue.h"
#include "collision_node/scene/heartbeat.h"
#include "collision_node/scene/object_pair.h"

namespace collision_node::scene {

class Fingerprint;

class PairTable {
 public:
  PairTable(const Scene& scene, const TimeLine& time_line, const Engine::MethodFactory& make_method,
            const EngineOptions& options);

  void startEpoch();
  /// The track has released something or changed its status.
  void note(int track);
  /// An object has turned out to stand where its track says.
  void fix(int object);

  /// Solves all that has become known. A frozen object's rest is known up to `rest_known_ns`.
  void solve(Nanoseconds rest_known_ns, EventQueue& queue);
  /// Asks the pairs that cannot move against each other, once per epoch.
  void testStatics(EventQueue& queue);
  /// The end, for now: what is undecided is published.
  void finish(EventQueue& queue);
  /// The end of the epoch; all runs are closed and noted.
  void end(EventQueue& queue);

  /// The first instant that is still being searched.
  std::optional<Instant> openSince() const;
  /// The oldest sample of a track that may still be looked at, when everything before `decided_ns` is known.
  std::size_t neededSample(int track, Nanoseconds decided_ns);

  /// All that what the pairs say later depends on (cut.cpp).
  void describe(Fingerprint& to) const;
  /// Nothing any pair says later depends on what was before its first piece.
  bool areSettled() const;

  const Costs& costs() const { return costs_; }
  void count(Stats& stats) const;
  /// A heartbeat has been told.
  void beat();

 private:
  void addAllPairs();
  void beginBroadPhase();
  void meetOnes(int object, const std::vector<int>& others, Nanoseconds proved_ns);
  void makeNear(int a, int b, Nanoseconds proved_ns);
  /// Takes away pairs that rest, and whose stays have nothing to do with each other any more; unless the
  /// heartbeat `is_told`, none that it would miss.
  void retire(bool is_told);
  void addPair(int a, int b);
  void askResting();
  void makeDue(ObjectPair& pair);
  void rouse(ObjectPair& pair);
  void layDown(ObjectPair& pair);
  void setAlarms(ObjectPair& pair);
  void takeAway(ObjectPair& pair, EventQueue& queue);
  std::size_t settled(int track) const;
  Nanoseconds settledUntil(int track) const;
  void goOnBehindProof(ObjectPair& pair, Nanoseconds proved_ns) const;

  PairWorld world_;
  Coverage coverage_;
  PairCounter counter_;
  std::vector<std::unique_ptr<ObjectPair>> pairs_, statics_;
  // Many objects: pairs exist only where two may meet.
  std::unique_ptr<BroadPhase> broad_;
  std::unordered_map<std::uint64_t, ObjectPair*> near_;  ///< of pairs_, by both objects
  struct Meeting {
    int a, b;
    Nanoseconds proved_ns;  ///< as in Asked
  };
  std::vector<Meeting> met_;  ///< since the last solve()
  std::vector<std::unique_ptr<ObjectPair>> spare_;
  std::size_t retire_at_ = 0;  ///< so many pairs are too many
  std::vector<int> fixed_late_;
  Crew crew_;
  std::vector<std::vector<ObjectPair*>> awake_;  ///< by object
  Alarms alarms_;                                ///< for pairs_ that rest
  struct Asked {
    ObjectPair* pair;
    Nanoseconds proved_ns;  ///< nothing is proved of what comes later
  };
  std::vector<Asked> asked_;  ///< whether they may go on resting
  std::vector<ObjectPair*> due_;
  std::vector<int> freezing_;  ///< objects that may freeze
  // By object: samples before it are looked at; and those before it are in every proof of a resting pair.
  std::vector<std::size_t> seen_, settled_;
  std::vector<int> noted_;  ///< since the last solve()
  std::vector<char> is_noted_;
  bool are_fixed_tested_ = false;  ///< pairs of fixed objects have been asked, in this epoch
  bool untested_ = true;           ///< some static pair has not
  std::set<std::pair<Instant, ObjectPair*>> open_;
  Costs costs_;
};

}  // namespace collision_node::scene

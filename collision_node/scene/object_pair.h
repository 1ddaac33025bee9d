/// All watched link pairs of two objects: they share their pieces, and rest together while the objects are
/// far apart.
///
/// Guarantee (docs/broad_phase.md): while a pair rests, its links are proved apart with more to spare than
/// any solver's rounding budget, so not solving them changes no event.
#pragma once

#include <memory>
#include <vector>

#include "collision_node/scene/pair_watch.h"
#include "collision_node/scene/tracks/pieces.h"
#include "collision_node/scene/tracks/time_line.h"
#include "collision_node/scene/traveller.h"

namespace collision_node::scene {

/// What all pairs of a scene look at. Constant while pairs are walked.
struct PairWorld {
  const Scene& scene;
  const TimeLine& time_line;
  Engine::MethodFactory make_method;
  impact::PairOptions options;
  std::vector<std::vector<PairRank>> link_ranks;  ///< by object and link
  std::vector<Traveller> travellers;              ///< by object
  bool may_rest = true;                           ///< else every pair is solved on every piece
  Nanoseconds rest_known_ns = 0;                  ///< how far a frozen object's rest is known

  const Track& track(int object) const { return time_line.tracks()[object]; }
};

class ObjectPair {
 public:
  /// `a` <= `b` in byte order.
  ObjectPair(int a, int b) : a_(a), b_(b) {}

  /// As if new, for other objects: memory of pairs is used again. Alarms for the old pair stay void.
  void become(int a, int b);

  int a() const { return a_; }
  int b() const { return b_; }

  // ---- two objects of which one moves

  /// From the tracks' first samples of the epoch.
  void restart(const PairWorld& world);
  /// The pair is proved apart up to where the segments that begin with these samples have both begun, or has
  /// shared no time before.
  void jumpTo(std::size_t index_a, std::size_t index_b);
  /// Solves everything that is known, until it may rest. Different pairs may walk at the same time.
  void walk(const PairWorld& world);

  /// Rests from here on if the two are proved apart for all that is released.
  bool tryToRest(const PairWorld& world);
  bool isResting() const { return is_resting_; }
  /// How much way both together have left before the proof of a pair that has just gone to rest ends [m]
  double slack() const { return slack_; }
  void wake() { is_resting_ = false; }

  // ---- two objects that cannot move against each other

  /// Asked once per epoch, on the shortest piece there is; nothing happens while there is none.
  void test(const PairWorld& world);
  /// A contact of such a pair lasts to the end of the epoch.
  void endTest(const PairWorld& world);
  bool isTested() const { return is_tested_; }

  // ---- both

  void startOver();
  void finish();
  std::vector<PairWatch>& watches() { return watches_; }
  const std::vector<PairWatch>& watches() const { return watches_; }
  /// The first instant that is still being searched.
  std::optional<Instant> openSince() const;
  PieceCursor& cursor() { return cursor_; }

  // What the last calls said and cost; for the caller to take away.
  Outbox outbox;
  Costs costs;
  std::uint32_t name = 0;  ///< in its table's alarms
  /// What its table notes about it.
  struct Place {
    std::uint64_t last_tests = 0;  ///< what its last walk cost
    bool is_due = false;
    std::optional<Instant> open_since;
  } place;

 private:
  void makeWatches(const PairWorld& world);
  void advance(const PairWorld& world, const Step& step);

  int a_, b_;
  PieceCursor cursor_;
  std::vector<PairWatch> watches_;  ///< made when first needed
  bool is_resting_ = false, is_tested_ = false;
  double slack_ = 0.0;
  Nanoseconds tested_ns_ = 0;
};

}  // namespace collision_node::scene

#include "collision_node/scene/pair_table.h"

#include <algorithm>
#include <limits>

namespace collision_node::scene {

namespace {

constexpr Nanoseconds kForEver = std::numeric_limits<Nanoseconds>::max();

impact::PairOptions optionsOf(const Scene& scene) {
  impact::PairOptions options;
  options.time_precision = scene.time_precision;
  options.distance_precision = scene.distance_precision;
  options.node_budget = scene.node_budget;
  return options;
}

std::vector<std::vector<PairRank>> rankLinks(const std::vector<Object>& objects) {
  std::vector<std::vector<PairRank>> ranks;
  PairRank next = 0;
  for (const Object& object : objects) {
    ranks.emplace_back(object.links.size(), 0);
    for (const int link : linksWithBody(object)) ranks.back()[link] = next++;
  }
  return ranks;
}

std::vector<Traveller> travellersOf(const Scene& scene) {
  const std::vector<double> half_distances = scene.pairs.halfDistances(scene.objects.size());
  std::vector<Traveller> travellers;
  for (std::size_t i = 0; i < scene.objects.size(); ++i)
    travellers.emplace_back(scene.objects[i], half_distances[i], scene.time.max_gap);
  return travellers;
}

}  // namespace

PairTable::PairTable(const Scene& scene, const TimeLine& time_line, const Engine::MethodFactory& make_method,
                     const EngineOptions& options)
    : world_{scene,
             time_line,
             make_method,
             optionsOf(scene),
             rankLinks(scene.objects),
             travellersOf(scene),
             !options.everything},
      coverage_(scene.objects.size()),
      counter_(scene),
      awake_(scene.objects.size()),
      alarms_(scene.objects.size()),
      seen_(scene.objects.size(), 0),
      settled_(scene.objects.size(), 0),
      is_noted_(scene.objects.size(), 0) {
  for (std::size_t i = 0; i < scene.objects.size(); ++i)
    if (scene.objects[i].on_timeout == OnTimeout::kFreeze) freezing_.push_back(static_cast<int>(i));
  addAllPairs();
}

void PairTable::addAllPairs() {
  const int count = static_cast<int>(world_.scene.objects.size());
  if (!world_.scene.pairs.watchesRest()) {
    for (const auto& [key, verdicts] : world_.scene.pairs.exceptions()) addPair(key.first, key.second);
    return;
  }
  for (int a = 0; a < count; ++a)
    for (int b = a; b < count; ++b) addPair(a, b);
}

void PairTable::addPair(int a, int b) {
  if (world_.scene.pairs.countBetween(world_.scene.objects, a, b) == 0) return;
  const bool is_static = a == b || (world_.track(a).isFixed() && world_.track(b).isFixed());
  (is_static ? statics_ : pairs_).push_back(std::make_unique<ObjectPair>(a, b));
}

void PairTable::startEpoch() {
  coverage_.startEpoch();
  are_fixed_tested_ = false;
  untested_ = true;
  due_.clear();
  open_.clear();
  for (std::vector<ObjectPair*>& list : awake_) list.clear();
  for (WakeList& list : alarms_) list.clear();
  for (std::size_t i = 0; i < seen_.size(); ++i)
    seen_[i] = settled_[i] = world_.track(static_cast<int>(i)).firstIndex();
  for (const auto& pair : statics_) pair->startOver();
  for (const auto& pair : pairs_) {
    pair->restart(world_);
    pair->place = {};
    rouse(*pair);
  }
  for (std::size_t i = 0; i < seen_.size(); ++i) note(static_cast<int>(i));
}

void PairTable::note(int object) {
  const Track& track = world_.track(object);
  if (!is_noted_[object]) noted_.push_back(object);
  is_noted_[object] = 1;
  coverage_.look(object, track);
  if (track.isFixed()) return;
  for (std::size_t& index = seen_[object]; track.has(index); ++index) {
    coverage_.take(object, track.sample(index));
    world_.travellers[object].take(track.sample(index));
  }
}

void PairTable::fix(int object) {
  const Track& track = world_.track(object);
  const motion::RigidMotion rest = track.restAt(track.firstIndex());
  world_.travellers[object].standAt({rest.c[0], rest.q0});
  untested_ = true;
  const auto stands = [&](const std::unique_ptr<ObjectPair>& pair) {
    return world_.track(pair->a()).isFixed() && world_.track(pair->b()).isFixed();
  };
  const auto first =
      std::stable_partition(pairs_.begin(), pairs_.end(), [&](const auto& pair) { return !stands(pair); });
  for (auto at = first; at != pairs_.end(); ++at) {
    layDown(**at);
    statics_.push_back(std::move(*at));
  }
  pairs_.erase(first, pairs_.end());
}

// ---- who is awake

void PairTable::rouse(ObjectPair& pair) {
  pair.wake();
  awake_[pair.a()].push_back(&pair);
  awake_[pair.b()].push_back(&pair);
  makeDue(pair);
}

void PairTable::makeDue(ObjectPair& pair) {
  if (pair.place.is_due) return;
  pair.place.is_due = true;
  due_.push_back(&pair);
}

/// A resting pair is asked for again when one of its objects has gone half of what is left.
void PairTable::layDown(ObjectPair& pair) {
  for (const int object : {pair.a(), pair.b()}) {
    std::vector<ObjectPair*>& list = awake_[object];
    const auto at = std::find(list.begin(), list.end(), &pair);
    if (at == list.end()) continue;
    *at = list.back();
    list.pop_back();
  }
  ++pair.place.nap;
  if (!pair.isResting()) return;
  const double share = 0.5 * pair.slack(world_);
  for (const int object : {pair.a(), pair.b()}) {
    const Traveller& traveller = world_.travellers[object];
    if (traveller.isFixed()) continue;
    alarms_[object].tidy([](const WakeList::Alarm& alarm) { return alarm.nap != alarm.pair->place.nap; });
    alarms_[object].add({traveller.spent() + share, &pair, pair.place.nap});
  }
}

/// The newest sample that every proof of a resting pair has taken into account.
std::size_t PairTable::settled(int object) const {
  const std::size_t first = world_.track(object).firstIndex();
  return std::max(first, settled_[object] > 0 ? settled_[object] - 1 : 0);
}

/// ... and how far that sample tells where the object is.
Nanoseconds PairTable::settledUntil(int object) const {
  const Track& track = world_.track(object);
  if (track.isFixed()) return kForEver;
  const std::size_t index = settled(object);
  if (track.sample(index).after == After::kOpen) return track.stamp(index);
  return track.has(index + 1) ? track.stamp(index + 1) : kForEver;
}

void PairTable::wakeUp(int object) {
  WakeList::Alarm alarm;
  while (alarms_[object].take(world_.travellers[object].spent(), alarm)) {
    ObjectPair& pair = *alarm.pair;
    if (alarm.nap != pair.place.nap) continue;
    if (pair.slack(world_) > 0.0) {
      layDown(pair);
      continue;
    }
    const Nanoseconds until = std::min(settledUntil(pair.a()), settledUntil(pair.b()));
    pair.jumpTo(world_.track(pair.a()).indexAt(until, settled(pair.a())),
                world_.track(pair.b()).indexAt(until, settled(pair.b())), until);
    if (pair.tryToRest(world_)) {
      layDown(pair);
    } else {
      ++pair.place.nap;
      rouse(pair);
    }
  }
}

// ---- work

void PairTable::solve(Nanoseconds rest_known_ns, EventQueue& queue) {
  for (const int object : noted_) wakeUp(object);
  for (const int object : noted_)
    for (ObjectPair* pair : awake_[object]) makeDue(*pair);
  if (rest_known_ns != world_.rest_known_ns) {
    world_.rest_known_ns = rest_known_ns;
    for (const int object : freezing_)
      if (world_.track(object).isFrozen())
        for (ObjectPair* pair : awake_[object]) makeDue(*pair);
  }
  for (ObjectPair* pair : due_) pair->walk(world_);
  for (ObjectPair* pair : due_) {
    pair->place.is_due = false;
    takeAway(*pair, queue);
    if (pair->isResting()) layDown(*pair);
  }
  due_.clear();
  for (const int object : noted_) {
    settled_[object] = seen_[object];
    is_noted_[object] = 0;
  }
  noted_.clear();
}

void PairTable::takeAway(ObjectPair& pair, EventQueue& queue) {
  queue.take(pair.outbox);
  costs_.add(pair.costs);
  pair.costs = Costs();
  std::optional<Instant>& known = pair.place.open_since;
  if (known) open_.erase({*known, &pair});
  known = pair.openSince();
  if (known) open_.insert({*known, &pair});
}

void PairTable::testStatics(EventQueue& queue) {
  are_fixed_tested_ = true;
  if (!untested_) return;
  untested_ = false;
  for (const auto& pair : statics_) {
    pair->test(world_);
    takeAway(*pair, queue);
    if (!pair->isTested()) untested_ = true;  // its object has not come yet
  }
}

void PairTable::finish(EventQueue& queue) {
  testStatics(queue);
  for (const auto& pair : pairs_) {
    if (pair->isResting()) continue;
    pair->finish();
    takeAway(*pair, queue);
  }
}

void PairTable::end(EventQueue& queue) {
  solve(kForEver, queue);
  for (const auto& pair : statics_) {
    pair->endTest(world_);
    takeAway(*pair, queue);
  }
}

// ---- what is known

std::optional<Instant> PairTable::openSince() const {
  if (open_.empty()) return std::nullopt;
  return open_.begin()->first;
}

std::size_t PairTable::neededSample(int object, Nanoseconds decided_ns) {
  const Track& track = world_.track(object);
  std::size_t needed = track.indexAt(decided_ns, settled(object));
  for (ObjectPair* pair : awake_[object]) {
    PieceCursor& cursor = pair->cursor();
    cursor.skipTo(world_.track(pair->a()), world_.track(pair->b()), decided_ns);
    needed = std::min(needed, pair->a() == object ? cursor.indexA() : cursor.indexB());
  }
  return needed;
}

void PairTable::count(Stats& stats) const {
  counter_.count(world_.time_line, coverage_, pairs_, statics_, are_fixed_tested_, stats);
  countInputs(world_.scene, world_.time_line, coverage_, stats);
  stats.node_tests = costs_.node_tests;
  stats.subdivisions = costs_.subdivisions;
  stats.budget_met = costs_.budget_met;
}

void PairTable::beat() {
  for (const auto& pair : pairs_)
    for (PairWatch& watch : pair->watches()) watch.clearAnswer();
  for (const auto& pair : statics_)
    for (PairWatch& watch : pair->watches()) watch.clearAnswer();
  coverage_.beat(world_.time_line);
}

}  // namespace collision_node::scene

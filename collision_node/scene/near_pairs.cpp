/// The pair table's share of the broad phase: which pairs exist.
#include <algorithm>
#include <limits>

#include "collision_node/scene/needs.h"
#include "collision_node/scene/pair_table.h"

namespace collision_node::scene {

namespace {

constexpr Nanoseconds kAlways = std::numeric_limits<Nanoseconds>::min();

/// Up to here every pair exists from the start: looking for neighbours would cost more than it saves.
constexpr std::size_t kFewObjects = 48;

/// So many more are not worth a look at all of them.
constexpr std::size_t kFewPairs = 64;

std::uint64_t keyOf(int a, int b) {
  return (static_cast<std::uint64_t>(static_cast<std::uint32_t>(a)) << 32) | static_cast<std::uint32_t>(b);
}

/// By the next heartbeat: a pair that does not exist counts as culled.
bool isMissed(const ObjectPair& pair) {
  const std::vector<PairWatch>& watches = pair.watches();
  return std::any_of(watches.begin(), watches.end(),
                     [](const PairWatch& watch) { return watch.worstAnswer() != impact::Answer::kCulled; });
}

}  // namespace

bool hasBroadPhase(const Scene& scene) {
  if (!scene.pairs.watchesRest() || scene.objects.size() <= kFewObjects) return false;
  const std::vector<Need> needs = needsOf(scene);
  return static_cast<std::size_t>(std::count(needs.begin(), needs.end(), Need::kWatched)) > kFewObjects;
}

void PairTable::beginBroadPhase() {
  const int count = static_cast<int>(world_.scene.objects.size());
  broad_ = std::make_unique<BroadPhase>(world_.scene.objects.size());
  const std::vector<Need> needs = needsOf(world_.scene);
  std::vector<int> standing;
  std::vector<Bounds> boxes;
  for (int object = 0; object < count; ++object) {
    if (needs[object] != Need::kWatched) continue;
    if (world_.scene.pairs.countBetween(world_.scene.objects, object, object) > 0) addPair(object, object);
    if (!world_.track(object).isFixed()) continue;
    standing.push_back(object);
    boxes.push_back(world_.travellers[object].standingBox());
  }
  broad_->stand(standing, boxes);
  for (std::size_t i = 0; i < standing.size(); ++i)
    for (const int other : broad_->standingNear(boxes[i]))
      if (standing[i] < other) addPair(standing[i], other);
}

void PairTable::meetOnes(int object, const std::vector<int>& others, Nanoseconds proved_ns) {
  for (const int other : others)
    met_.push_back({std::min(object, other), std::max(object, other), proved_ns});
}

void PairTable::makeNear(int a, int b, Nanoseconds proved_ns) {
  if (near_.count(keyOf(a, b)) != 0 || world_.scene.pairs.countBetween(world_.scene.objects, a, b) == 0)
    return;
  if (world_.track(a).isFixed() && world_.track(b).isFixed()) return;  // among the statics
  if (spare_.empty()) {
    pairs_.push_back(std::make_unique<ObjectPair>(a, b));
    pairs_.back()->name = alarms_.nameOf(*pairs_.back());
  } else {
    pairs_.push_back(std::move(spare_.back()));
    spare_.pop_back();
    pairs_.back()->become(a, b);
  }
  ObjectPair& pair = *pairs_.back();
  near_[keyOf(a, b)] = &pair;
  asked_.push_back({&pair, proved_ns});
}

void PairTable::retire(bool is_told) {
  if (!broad_) return;
  for (std::size_t i = 0; i < pairs_.size();) {
    ObjectPair& pair = *pairs_[i];
    if (!pair.isResting() || (!is_told && isMissed(pair)) || broad_->mayMeet(pair.a(), pair.b())) {
      ++i;
      continue;
    }
    near_.erase(keyOf(pair.a(), pair.b()));
    alarms_.silence(pair.name);
    spare_.push_back(std::move(pairs_[i]));
    pairs_[i] = std::move(pairs_.back());
    pairs_.pop_back();
  }
  retire_at_ = 2 * pairs_.size() + kFewPairs;
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
  std::vector<std::unique_ptr<ObjectPair>>& pairs = is_static ? statics_ : pairs_;
  pairs.push_back(std::make_unique<ObjectPair>(a, b));
  if (!is_static) pairs.back()->name = alarms_.nameOf(*pairs.back());
}

void PairTable::fix(int object) {
  const Track& track = world_.track(object);
  const motion::RigidMotion rest = track.restAt(track.firstIndex());
  world_.travellers[object].standAt({rest.c[0], rest.q0});
  untested_ = true;
  if (broad_) {
    fixed_late_.push_back(object);
    for (const int other : broad_->stay(object, world_.travellers[object].standingBox(), kAlways)) {
      if (world_.track(other).isFixed()) {
        addPair(std::min(object, other), std::max(object, other));
      } else {
        met_.push_back({std::min(object, other), std::max(object, other), track.stamp(track.firstIndex())});
      }
    }
  }
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

}  // namespace collision_node::scene

#include "collision_node/scene/pair_table.h"

#include <algorithm>
#include <limits>

namespace collision_node::scene {

namespace {

constexpr Nanoseconds kForEver = std::numeric_limits<Nanoseconds>::max();
constexpr Nanoseconds kAlways = std::numeric_limits<Nanoseconds>::min();
/// Resting pairs, about a tenth of a millisecond, too; and how many of them are a part of the work.
constexpr std::size_t kEnoughAsked = 500, kAskedAtOnce = 64;
/// Node tests, about a tenth of a millisecond: less is not worth waking another thread for.
constexpr std::uint64_t kEnoughWork = 4000;
/// What the steps, proofs and facts of a walk cost beside its node tests, in node tests.
constexpr std::uint64_t kTestsOfAnyWalk = 200;

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
  for (std::size_t first = 0; first < objects.size();) {
    // Parts of one object rank together.
    std::vector<std::pair<std::string, PairRank*>> links;
    std::size_t end = first;
    for (; end < objects.size() && objects[end].name == objects[first].name; ++end) {
      ranks.emplace_back(objects[end].links.size(), 0);
      for (const int link : linksWithShapes(objects[end]))
        links.emplace_back(objects[end].links[link].name, &ranks.back()[link]);
    }
    std::sort(links.begin(), links.end());
    for (const auto& link : links) *link.second = next++;
    first = end;
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
      crew_(options.threads),
      awake_(scene.objects.size()),
      alarms_(scene.objects.size()),
      seen_(scene.objects.size(), 0),
      settled_(scene.objects.size(), 0),
      is_noted_(scene.objects.size(), 0) {
  for (std::size_t i = 0; i < scene.objects.size(); ++i)
    if (scene.objects[i].on_timeout == OnTimeout::kFreeze) freezing_.push_back(static_cast<int>(i));
  if (world_.may_rest && hasBroadPhase(scene)) {
    beginBroadPhase();
  } else {
    addAllPairs();
  }
}

void PairTable::startEpoch() {
  coverage_.startEpoch();
  are_fixed_tested_ = false;
  untested_ = true;
  due_.clear();
  open_.clear();
  for (std::vector<ObjectPair*>& list : awake_) list.clear();
  alarms_.clear();
  for (std::size_t i = 0; i < seen_.size(); ++i)
    seen_[i] = settled_[i] = world_.track(static_cast<int>(i)).firstIndex();
  for (const auto& pair : statics_) pair->startOver();
  met_.clear();
  asked_.clear();
  if (broad_) {
    broad_->startEpoch();
    near_.clear();
    for (auto& pair : pairs_) {
      pair->place = {};
      spare_.push_back(std::move(pair));
    }
    pairs_.clear();
    for (const int object : fixed_late_)
      meetOnes(object, broad_->stay(object, world_.travellers[object].standingBox(), kAlways), kAlways);
  }
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
  Traveller& traveller = world_.travellers[object];
  for (std::size_t& index = seen_[object]; track.has(index); ++index) {
    const Sample& sample = track.sample(index);
    coverage_.take(object, sample);
    traveller.take(sample);
    if (!broad_) continue;
    const bool joined = sample.join == Join::kJoined;
    meetOnes(object,
             broad_->move(object, traveller.sweepTo(sample),
                          joined ? sample.segment.motion.start_ns : sample.pose.stamp_ns,
                          sample.pose.stamp_ns, !joined),
             kForEver);
  }
  // A frozen object stays where its last segment ended.
  if (broad_ && track.isFrozen() && !broad_->isStaying(object)) {
    const Sample& last = track.sample(seen_[object] - 1);
    const Bounds at = traveller.coreAt(track, seen_[object] - 1);
    meetOnes(object, broad_->stay(object, grown(at, traveller.radius()), last.pose.stamp_ns),
             last.pose.stamp_ns);
  }
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

/// Of a pair that was awake.
void PairTable::layDown(ObjectPair& pair) {
  for (const int object : {pair.a(), pair.b()}) {
    std::vector<ObjectPair*>& list = awake_[object];
    const auto at = std::find(list.begin(), list.end(), &pair);
    if (at == list.end()) continue;
    *at = list.back();
    list.pop_back();
  }
  setAlarms(pair);
}

/// A resting pair is asked for again when one of its objects has gone its share of the way that is left: by
/// their speeds, so that both come to that at about the same time.
void PairTable::setAlarms(ObjectPair& pair) {
  alarms_.silence(pair.name);
  if (!pair.isResting()) return;
  const Traveller &a = world_.travellers[pair.a()], &b = world_.travellers[pair.b()];
  const auto set = [&](int object, double speed, double other) {
    constexpr double kLeast = 0.125;  // for who speeds up
    const Traveller& traveller = world_.travellers[object];
    if (traveller.isFixed()) return;
    const double both = speed + other, even = both > 0.0 ? speed / both : 0.5;
    const double share = (a.isFixed() || b.isFixed()) ? 1.0 : kLeast + (1.0 - 2.0 * kLeast) * even;
    alarms_.set(object, traveller.spent() + share * pair.slack(), pair.name);
  };
  set(pair.a(), a.speed(), b.speed());
  set(pair.b(), b.speed(), a.speed());
}

/// The newest sample that every proof of a resting pair has taken into account.
std::size_t PairTable::settled(int object) const {
  const std::size_t first = world_.track(object).firstIndex();
  return std::max(first, settled_[object] > 0 ? settled_[object] - 1 : 0);
}

/// ... and how far that sample tells where the object is. Who is silent may come back at the watermark.
Nanoseconds PairTable::settledUntil(int object) const {
  const Track& track = world_.track(object);
  if (track.isFixed()) return kForEver;
  const std::size_t index = settled(object);
  const Nanoseconds stamp = track.stamp(index);
  const bool is_new = settled_[object] <= track.firstIndex();
  if (is_new || track.sample(index).after == After::kOpen) return stamp;
  if (track.has(index + 1)) return track.stamp(index + 1);
  return std::max(stamp, world_.time_line.watermark().value_or(stamp));
}

/// The pair is proved apart for all samples that are settled; what comes behind them is to be looked at.
void PairTable::goOnBehindProof(ObjectPair& pair, Nanoseconds proved_ns) const {
  const int a = pair.a(), b = pair.b();
  const Nanoseconds until = std::min({proved_ns, settledUntil(a), settledUntil(b)});
  pair.jumpTo(world_.track(a).indexAt(until, settled(a)), world_.track(b).indexAt(until, settled(b)));
  pair.tryToRest(world_);
}

/// Which of the resting pairs may go on resting, when some of their objects have moved, and which of those
/// that are new may begin to.
void PairTable::askResting() {
  for (const int object : noted_) {
    alarms_.take(object, world_.travellers[object].spent(), [this](ObjectPair& pair) {
      asked_.push_back({&pair, kForEver});
    });
  }
  const std::size_t parts = (asked_.size() + kAskedAtOnce - 1) / kAskedAtOnce;
  crew_.forEach(parts, asked_.size() >= kEnoughAsked, [&](std::size_t part) {
    const std::size_t end = std::min(asked_.size(), (part + 1) * kAskedAtOnce);
    for (std::size_t i = part * kAskedAtOnce; i < end; ++i)
      goOnBehindProof(*asked_[i].pair, asked_[i].proved_ns);
  });
  for (const Asked& asked : asked_) {
    if (asked.pair->isResting()) {
      setAlarms(*asked.pair);
    } else {
      rouse(*asked.pair);
    }
  }
  asked_.clear();
}

// ---- work

void PairTable::solve(Nanoseconds rest_known_ns, EventQueue& queue) {
  for (const Meeting& meeting : met_) makeNear(meeting.a, meeting.b, meeting.proved_ns);
  met_.clear();
  askResting();
  for (const int object : noted_)
    for (ObjectPair* pair : awake_[object]) makeDue(*pair);
  if (rest_known_ns != world_.rest_known_ns) {
    world_.rest_known_ns = rest_known_ns;
    for (const int object : freezing_)
      if (world_.track(object).isFrozen())
        for (ObjectPair* pair : awake_[object]) makeDue(*pair);
  }
  std::uint64_t work = 0;
  for (const ObjectPair* pair : due_) work += pair->place.last_tests + kTestsOfAnyWalk;
  if (work >= kEnoughWork) {
    std::stable_sort(due_.begin(), due_.end(), [](const ObjectPair* l, const ObjectPair* r) {
      return l->place.last_tests > r->place.last_tests;
    });
  }
  crew_.forEach(due_.size(), work >= kEnoughWork, [&](std::size_t i) { due_[i]->walk(world_); });
  for (ObjectPair* pair : due_) {
    pair->place.is_due = false;
    pair->place.last_tests = pair->costs.node_tests;
    takeAway(*pair, queue);
    if (pair->isResting()) layDown(*pair);
  }
  due_.clear();
  for (const int object : noted_) {
    settled_[object] = seen_[object];
    is_noted_[object] = 0;
  }
  noted_.clear();
  if (broad_) broad_->forgetBefore(rest_known_ns);
  if (pairs_.size() >= retire_at_) retire(false);
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
  are_fixed_tested_ = true;  // now at the latest
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
  retire(true);
}

}  // namespace collision_node::scene

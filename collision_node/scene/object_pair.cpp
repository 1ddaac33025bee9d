#include "collision_node/scene/object_pair.h"

#include <algorithm>

#include "collision_node/scene/rest.h"

namespace collision_node::scene {

namespace {

constexpr double kUp = 1.0 + 0x1p-48;
constexpr double kDown = 1.0 - 0x1p-48;
constexpr double kReading = 0x1p-44;

double baseOf(const Traveller& traveller, const Track& track, std::size_t index) {
  return traveller.isFixed() ? traveller.spent() : traveller.spentAt(track.sample(index).travelled);
}

}  // namespace

void ObjectPair::become(int a, int b) {
  a_ = a;
  b_ = b;
  cursor_ = PieceCursor();
  watches_.clear();
  is_resting_ = is_tested_ = false;
  place.last_tests = 0;
}

void ObjectPair::restart(const PairWorld& world) {
  startOver();
  cursor_.restart(world.track(a_), world.track(b_));
}

void ObjectPair::startOver() {
  is_resting_ = is_tested_ = false;
  for (PairWatch& watch : watches_) watch.startOver();
}

void ObjectPair::jumpTo(std::size_t index_a, std::size_t index_b) {
  cursor_.jumpTo(index_a, index_b);
  for (PairWatch& watch : watches_) watch.skip();
}

void ObjectPair::makeWatches(const PairWorld& world) {
  if (!watches_.empty()) return;
  const std::vector<Object>& objects = world.scene.objects;
  impact::PairOptions options = world.options;
  for (const LinkPair& pair : world.scene.pairs.between(objects, a_, b_)) {
    options.contact_distance = pair.contact_distance;
    const auto ranks = std::minmax(world.link_ranks[a_][pair.link_a], world.link_ranks[b_][pair.link_b]);
    const PairRank rank = (ranks.first << 32) | ranks.second;
    watches_.emplace_back(world.scene, pair, rank,
                          world.make_method(*objects[a_].links[pair.link_a].body,
                                            *objects[b_].links[pair.link_b].body, options));
  }
}

void ObjectPair::advance(const PairWorld& world, const Step& step) {
  makeWatches(world);
  for (PairWatch& watch : watches_) watch.advance(step, outbox, costs);
}

void ObjectPair::walk(const PairWorld& world) {
  while (!tryToRest(world)) {
    const Step step = cursor_.next(world.track(a_), world.track(b_), world.rest_known_ns);
    if (step.what == Step::What::kWait) return;
    if (step.what == Step::What::kPiece) {
      advance(world, step);
    } else {
      for (PairWatch& watch : watches_) watch.interrupt(step.reason, outbox);
    }
  }
}

/// The proof: from the samples that begin the current segments on, each core goes at most as far as its
/// odometer says, so the distance of the cores there, less both radii and both ways, is a distance for all
/// time that is released.
bool ObjectPair::tryToRest(const PairWorld& world) {
  const Track& a = world.track(a_);
  const Track& b = world.track(b_);
  const std::size_t index_a = cursor_.indexA(), index_b = cursor_.indexB();
  if (!world.may_rest || !a.has(index_a) || !b.has(index_b)) return false;
  const Traveller& side_a = world.travellers[a_];
  const Traveller& side_b = world.travellers[b_];
  const double apart = distanceBetween(side_a.coreAt(a, index_a), side_b.coreAt(b, index_b)) -
                       (side_a.radius() + side_b.radius()) * kUp;
  const double spent_a = side_a.spent(), spent_b = side_b.spent();
  const double way = (spent_a - baseOf(side_a, a, index_a)) + (spent_b - baseOf(side_b, b, index_b));
  // What an odometer could not tell from nothing is nothing.
  slack_ = (apart * kDown - way * kUp) * kDown - kReading * (spent_a + spent_b);
  is_resting_ = slack_ > 0.0 && std::all_of(watches_.begin(), watches_.end(),
                                            [](const PairWatch& watch) { return watch.isQuiet(); });
  return is_resting_;
}

void ObjectPair::test(const PairWorld& world) {
  if (is_tested_) return;
  const std::optional<Step> step = firstRest(world.time_line, a_, b_);
  if (!step) return;
  is_tested_ = true;
  tested_ns_ = step->piece.end_ns;
  for (PairWatch& watch : watches_) watch.startOver();  // the answer holds for the whole epoch
  advance(world, *step);
  finish();
}

void ObjectPair::endTest(const PairWorld& world) {
  test(world);
  if (!is_tested_) return;
  const Step step = lastRest(world.time_line, a_, b_, tested_ns_);
  for (PairWatch& watch : watches_) {
    if (!watch.isTouching()) continue;
    if (step.piece.start_ns < step.piece.end_ns) watch.advance(step, outbox, costs);
    watch.interrupt(impact::Reason::kReset, outbox);
  }
}

void ObjectPair::finish() {
  for (PairWatch& watch : watches_) watch.finish(outbox);
}

std::optional<Instant> ObjectPair::openSince() const {
  std::optional<Instant> first;
  for (const PairWatch& watch : watches_) {
    const std::optional<Instant> since = watch.openSince();
    if (since && (!first || *since < *first)) first = since;
  }
  return first;
}

}  // namespace collision_node::scene

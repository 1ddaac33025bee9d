#include "collision_node/impact/walk/search.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace collision_node::impact {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Split time rather than space when the motion's remainder exceeds this share of the nodes' sizes and of
/// what counts as contact between them (measured: flat from 0.03 to 0.06). Nodes so small that they are split
/// again and again are asked whether they are near at all.
constexpr double kTimeSplit = 0.04;

constexpr int kAtOnce = 4;  ///< tests that hide each other's latencies (measured: flat from 3 to 6)

constexpr int kWidth = geometry::BvhBlock::kWidth;

// Without signs: nothing to round towards zero.
std::int32_t blockOf(std::int32_t node) {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(node) / kWidth);
}
int laneOf(std::int32_t node) { return static_cast<int>(static_cast<std::uint32_t>(node) % kWidth); }

/// A measure of a node's size, to compare with others.
double sizeOf(const geometry::BvhBlock& block, int lane) {
  return 0.6 * (block.half[0][lane] + block.half[1][lane] + block.half[2][lane]);
}

}  // namespace

Search::Search(const PairPiece& piece, std::uint64_t node_budget, Workspace& workspace,
               std::optional<StraightPath> straight)
    : piece_(piece),
      tree_{&piece.a.bvh(), &piece.b.bvh()},
      reach_(reachOf(piece)),
      test_(piece),
      budget_(node_budget),
      shells_(ShellPair::of(piece, node_budget, workspace.buffers().shell_bodies)),
      workspace_of_shells_(shells_ ? &workspace.buffers().forShells() : nullptr),
      straight_(std::move(straight)),
      slabs_(piece, workspace.buffers().slabs),
      agenda_(workspace.buffers().agenda),
      near_(workspace.buffers().near),
      found_(workspace.buffers().found) {}

/// Puts the item into the smallest slab that was made for it, and says what is to be done with it.
Search::Todo Search::todo(Item& item) {
  const geometry::BvhBlock &block_a = tree_[0]->block(blockOf(item.node[0])),
                           &block_b = tree_[1]->block(blockOf(item.node[1]));
  const int lane_a = laneOf(item.node[0]), lane_b = laneOf(item.node[1]);
  const std::int32_t link_a = block_a.link[lane_a], link_b = block_b.link[lane_b];
  const double size_a = sizeOf(block_a, lane_a), size_b = sizeOf(block_b, lane_b);
  const double reach = std::max(block_a.reach[lane_a], block_b.reach[lane_b]);
  const double least_size = std::min(size_a, size_b), limit = kTimeSplit * (size_a + size_b + test_.grown());
  const auto bends = [&](const Slab& slab) {
    const double bend = std::min(slab.in_a.bend, slab.in_b.bend) + slab.bend_q * reach;
    const double remainder = slab.half * (0.5 * slab.half * bend + slab.turn * least_size);
    return remainder > limit && slab.half > 1e-9 * piece_.motion.duration();
  };
  bool straddles;
  while (true) {
    const Slab& slab = slabs_[item.slab];
    const bool late = item.span.low >= slab.middle;
    straddles = !late && item.span.high > slab.middle;
    // To make one costs as much as two tests: only where it bends.
    if (straddles || (slab.child[late] < 0 && !bends(slab))) break;
    item.slab = slab.child[late] < 0 ? slabs_.childOf(item.slab, late) : slab.child[late];
  }
  if (link_a < 0 && link_b < 0) return {Todo::kElements, 0, {link_a, link_b}};
  if (straddles && bends(slabs_[item.slab])) return {Todo::kHalve, 0, {link_a, link_b}};
  const bool of_b = (link_b >= 0) & ((link_a < 0) | (size_a < size_b));  // either as often: no branch
  return {Todo::kTest, of_b, {link_a, link_b}};
}

/// Notes the children with time left.
void Search::pushChildren(const Item& item, const Todo& todo, unsigned lanes, const Span spans[],
                          double until) {
  const geometry::Bvh& tree = *tree_[todo.parent];
  const std::int32_t link = todo.link[todo.parent];
  const geometry::BvhBlock& children = tree.block(link);
  for (; lanes != 0; lanes &= lanes - 1) {
    const int i = __builtin_ctz(lanes);
    if (!(spans[i].low < until)) continue;
    tree.prefetch(children.link[i]);
    Item child = item;
    child.node[todo.parent] = kWidth * link + i;
    child.span = spans[i];
    agenda_.push(child);
  }
}

template <typename Leaf>
void Search::walk(double from, double to, bool by_time, Leaf&& leaf) {
  const bool primitives = piece_.a.triangleCount() == 0 && piece_.b.triangleCount() == 0;
  if (primitives && piece_.a.elementCount() == 1 && piece_.b.elementCount() == 1) {  // nothing to walk
    ++node_tests_;
    if (exhausted()) {
      leaf.unresolved(from);
    } else {
      static const Slab kAll{};  // nothing looks at it
      leaf(kAll, 0, 0, {from, to});
    }
    return;
  }
  const auto clip = [&](const Item& item, const Todo& todo, Span spans[]) {
    const std::int32_t other = item.node[1 - todo.parent];
    return test_.clipChildren(slabs_[item.slab], tree_[todo.parent]->block(todo.link[todo.parent]),
                              todo.parent == 0, tree_[1 - todo.parent]->block(blockOf(other)), laneOf(other),
                              item.span, spans);
  };
  slabs_.start(from, to);
  ++node_tests_;
  constexpr std::int32_t kRoot = geometry::Bvh::kRoot;
  Item whole{{kRoot, kRoot}, 0, -1, {from, to}};
  if (by_time) {  // where days are worth it: those that the roots leave
    Span spans[kWidth];
    const geometry::BvhBlock &root_a = tree_[0]->block(kRoot), &root_b = tree_[1]->block(kRoot);
    if ((test_.clipChildren(slabs_[0], root_a, true, root_b, 0, whole.span, spans) & 1U) == 0) return;
    whole.span = spans[0];
  }
  agenda_.start(whole.span.low, whole.span.high, by_time);
  agenda_.push(whole);
  double until = kInfinity;
  while (!agenda_.empty()) {
    Item item = agenda_.pop();
    if (!(item.span.low < until)) continue;
    item.span.high = std::min(item.span.high, until);
    if (exhausted()) {
      until = std::min(until, leaf.unresolved(item.span.low));
      continue;
    }
    const Todo now = todo(item);
    if (now.kind == Todo::kElements) {
      until = std::min(until, leaf(slabs_[item.slab], ~now.link[0], ~now.link[1], item.span));
      continue;
    }
    ++node_tests_;
    if (now.kind == Todo::kHalve) {
      if (test_.nodesApart(slabs_[item.slab], tree_[0]->block(blockOf(item.node[0])), laneOf(item.node[0]),
                           tree_[1]->block(blockOf(item.node[1])), laneOf(item.node[1]), item.span))
        continue;
      const double middle = slabs_[item.slab].middle;
      const std::int32_t late = slabs_.childOf(item.slab, true), early = slabs_.childOf(item.slab, false);
      agenda_.push({{item.node[0], item.node[1]}, late, -1, {middle, item.span.high}});
      agenda_.push({{item.node[0], item.node[1]}, early, -1, {item.span.low, middle}});
      continue;
    }
    // What would come next is tested at the same time: none waits for another.
    struct Test {
      Item item;
      Todo todo;
      unsigned lanes;
      Span spans[kWidth];
    } tests[kAtOnce];
    tests[0].item = item;
    tests[0].todo = now;
    int count = 1;
    for (; count < kAtOnce && !agenda_.empty() && agenda_.top().span.low < until; ++count) {
      agenda_.top().span.high = std::min(agenda_.top().span.high, until);
      tests[count].todo = todo(agenda_.top());
      if (tests[count].todo.kind != Todo::kTest) break;
      tests[count].item = agenda_.pop();
      ++node_tests_;
    }
    for (int i = 0; i < count; ++i) tests[i].lanes = clip(tests[i].item, tests[i].todo, tests[i].spans);
    for (int i = count - 1; i >= 0; --i)
      pushChildren(tests[i].item, tests[i].todo, tests[i].lanes, tests[i].spans, until);
  }
}

Search::First Search::firstPossible(double from, double to, double width, double window) {
  constexpr double kShareOfWidth = 0.1;
  struct Leaf {
    Search& search;
    double stop, window;
    First& first;
    double unresolved(double low) {
      if (!first.found || low < first.time) first = {true, low, {}};
      return first.time + window;
    }
    double operator()(const Slab& slab, std::int32_t ea, std::int32_t eb, Span span) {
      const ElementView view_a(search.piece_.a, ea), view_b(search.piece_.b, eb);
      const Element &a = *view_a, &b = *view_b;
      if (a.triangle >= 0 && b.triangle >= 0 && search.test_.trianglesApart(slab, a, b, span))
        return kInfinity;
      PairSteps steps(search.piece_, a, b);
      const double t = steps.advance(span.low, span.high, stop, search.node_tests_, search.budget_);
      if (t > span.high) return kInfinity;
      if (!first.found || t < first.time) {
        first = {true, t, {ea, eb}};
        search.stopped_by_ = first.pair;
        search.stopped_closest_ = steps.closest();
        search.stopped_along_ = steps.parting().axis.direction;
      }
      search.near_.push_back({{ea, eb}, t, steps.parting()});
      return first.time + window;
    }
  };
  const double stop = kShareOfWidth * width;
  First first;
  near_.clear();
  near_from_ = stopped_at_ = kInfinity;
  if (straight_) {
    straight_->first(from, to, width, path_contact_);
    node_tests_ += path_contact_.tests;
    if (path_contact_.kind == PathContact::Kind::kClear) return first;
    if (path_contact_.kind == PathContact::Kind::kContact) {
      const std::int32_t met = path_contact_.met[0].element;
      const ElementPair pair = straight_->pointIsA() ? ElementPair{0, met} : ElementPair{met, 0};
      return {true, path_contact_.lower, pair};
    }
  }
  const double asked_from = from, asked_to = to;
  from = std::max(from, reach_.low);
  to = std::min(to, reach_.high);
  if (from <= to && (!shells_ || shells_->clear(from, to, stop, node_tests_, *workspace_of_shells_)))
    walk(from, to, true, Leaf{*this, stop, window, first});
  near_from_ = exhausted() ? kInfinity : asked_from;
  if (first.found) stopped_at_ = first.time;
  near_to_ = first.found ? std::min(first.time + window, asked_to) : asked_to;
  // What begins at the window's end was not looked at any more.
  near_all_to_ = first.found ? std::min(std::nextafter(first.time + window, -kInfinity), asked_to) : asked_to;
  near_.erase(std::remove_if(near_.begin(), near_.end(), [&](const Near& n) { return n.time > near_to_; }),
              near_.end());
  return first;
}

const PathContact* Search::provedAt(double time) const {
  const bool proved =
      straight_ && path_contact_.kind == PathContact::Kind::kContact && path_contact_.lower == time;
  return proved ? &path_contact_ : nullptr;
}

const Instant& Search::at(double t) {
  if (has_computed_ && t == computed_.t) return computed_;
  if (has_computed_ && piece_.isNear(t, computed_)) return near_it_ = piece_.at(t, computed_);
  has_computed_ = true;
  return computed_ = piece_.at(t);
}

Closest Search::closestAt(double time, ElementPair pair) const {
  const bool seen = time >= stopped_at_ && pair.a == stopped_by_.a && pair.b == stopped_by_.b;
  return seen ? stopped_closest_ : Closest();
}

const Parting* Search::partingAt(double time, ElementPair pair) const {
  if (!(time >= stopped_at_ && time <= near_to_)) return nullptr;
  for (const Near& near : near_) {
    if (near.pair.a == pair.a && near.pair.b == pair.b)
      return near.parting.axis.valid ? &near.parting : nullptr;
  }
  return nullptr;
}

NearPairs Search::nearPairs(double from, double to, std::size_t limit, ElementPair known) {
  struct Leaf {
    Search& search;
    NearPairs& pairs;
    std::size_t limit;
    ElementPair known;
    double unresolved(double) { return -kInfinity; }
    double operator()(const Slab& slab, std::int32_t ea, std::int32_t eb, Span span) {
      const ElementView view_a(search.piece_.a, ea), view_b(search.piece_.b, eb);
      const Element &a = *view_a, &b = *view_b;
      if (a.triangle >= 0 && b.triangle >= 0 && search.test_.trianglesApart(slab, a, b, span))
        return kInfinity;
      return advance(ea, eb, span);
    }
    double advance(std::int32_t ea, std::int32_t eb, Span span) {
      if (ea == known.a && eb == known.b) return kInfinity;
      const ElementView view_a(search.piece_.a, ea), view_b(search.piece_.b, eb);
      const Element &a = *view_a, &b = *view_b;
      const auto same = [&](const ElementPair& p) { return p.a == ea && p.b == eb; };
      if (std::any_of(pairs.begin(), pairs.end(), same)) return kInfinity;  // in two slabs
      PairSteps steps(search.piece_, a, b);
      if (steps.advance(span.low, span.high, 0.0, search.node_tests_, search.budget_) <= span.high)
        pairs.push_back({ea, eb});
      return pairs.size() < limit ? kInfinity : -kInfinity;
    }
  };
  NearPairs pairs;
  Leaf leaf{*this, pairs, limit, known};
  if (from >= near_from_ && to <= near_all_to_) {  // all of them were seen a moment ago
    for (const Near& near : near_) {
      ++node_tests_;
      if (leaf.advance(near.pair.a, near.pair.b, {from, to}) < 0.0) break;
    }
  } else {
    walk(from, to, false, leaf);
  }
  return pairs;
}

Proved Search::classifyElements(const Instant& now, const Element& a, const Element& b, const Closest& start,
                                ContactWitness& witness) const {
  const double radius = a.radius + b.radius + piece_.contact_distance;
  // Known points that are as close as a proof needs will do, unless it is to last.
  const double enough = start.count > 0 ? std::max(0.0, radius - 4.0 * piece_.point_error) : 0.0;
  const Closest closest = closestPoints(Cores(now, a, b), start, {enough});
  // What is likelier is asked first: the two answers exclude each other.
  const bool likely = closest.overlap || closest.v.norm() < radius;
  if (likely && touchesAt(piece_, now, a, b, closest, witness)) return Proved::kContact;
  Axis axis;
  if (PairSteps(piece_, a, b).apartFor(now, closest, 1e-300, &axis) > 0.0) return Proved::kApart;
  return !likely && touchesAt(piece_, now, a, b, closest, witness) ? Proved::kContact : Proved::kNothing;
}

Proved Search::classifyPair(double t, ElementPair pair, ContactWitness* witness) {
  ++node_tests_;
  const ElementView view_a(piece_.a, pair.a), view_b(piece_.b, pair.b);
  const Element &a = *view_a, &b = *view_b;
  witness->clear();
  const Instant& now = at(t);
  const Closest before = closestAt(t, pair);
  const Parting* const parting = partingAt(t, pair);
  const Vec3 direction = parting != nullptr ? parting->at(t) : Vec3(Vec3::Zero());
  Proved proved = Proved::kContact;
  if (!touchesSliding(piece_, now, a, b, before, parting != nullptr ? &direction : nullptr, *witness))
    proved = classifyElements(now, a, b, before, *witness);
  witness->element_a = pair.a;
  witness->element_b = pair.b;
  return proved;
}

double Search::closingSpeed(const First& last) {
  const Parting* const parting = partingAt(last.time, last.pair);
  if (parting == nullptr) return 0.0;
  const ElementView view_a(piece_.a, last.pair.a), view_b(piece_.b, last.pair.b);
  const CorePair cores(*view_a, *view_b);
  const Axis axis{parting->at(last.time), parting->axis.rate, true};
  return std::max(0.0, -GapModel(piece_, at(last.time), cores, axis).trend().slope);
}

Proved Search::classify(double t, ContactWitness* witness, double horizon) {
  struct Leaf {
    Search& search;
    const Instant now;
    std::size_t wanted;
    std::vector<ContactWitness>& found;
    bool undecided = false;
    double unresolved(double) {
      undecided = true;
      return -kInfinity;
    }
    double operator()(const Slab& slab, std::int32_t ea, std::int32_t eb, Span span) {
      const ElementView view_a(search.piece_.a, ea), view_b(search.piece_.b, eb);
      const Element &a = *view_a, &b = *view_b;
      if (a.triangle >= 0 && b.triangle >= 0 && search.test_.trianglesApart(slab, a, b, span))
        return kInfinity;
      ContactWitness w;
      if (wanted > 1) w.shrunk = kInfinity;  // to be followed
      switch (search.classifyElements(now, a, b, Closest(), w)) {
        case Proved::kApart:
          return kInfinity;
        case Proved::kNothing:
          undecided = true;
          search.hidden_.add(search.piece_, now, a, b);
          return kInfinity;
        case Proved::kContact:
          break;
      }
      w.element_a = ea;
      w.element_b = eb;
      found.push_back(w);
      return found.size() < wanted ? kInfinity : -kInfinity;
    }
  };
  constexpr std::size_t kCandidates = 64;
  found_.clear();
  hidden_.clear(stopped_along_);
  Leaf leaf{*this, piece_.at(t), horizon > 0.0 ? kCandidates : 1, found_, false};
  walk(t, t, false, leaf);
  if (!found_.empty()) {
    if (horizon > 0.0 && longestLasting(t, horizon, witness)) return Proved::kContact;
    *witness = found_[0];
    return Proved::kContact;
  }
  if (leaf.undecided) return Proved::kNothing;
  Vec3 held = Vec3::Zero();
  switch (containment(piece_, leaf.now, &held)) {
    case Where::kOutside:
      return Proved::kApart;
    case Where::kUnknown:
      return Proved::kNothing;
    case Where::kInside:
      break;
  }
  witness->clear();
  witness->point = held;
  return Proved::kContact;
}

bool Search::holdsHidden(double t, ContactWitness* witness) {
  ++node_tests_;
  Vec3 held;
  if (!hidden_.areHeld(piece_, at(t), &held)) return false;
  witness->clear();
  witness->point = held;
  return true;
}

bool Search::longestLasting(double t, double horizon, ContactWitness* witness) {
  const Instant now = piece_.at(t);
  const double end = std::min(t + horizon, piece_.motion.duration());
  for (double span = end - t; span > 16.0 * kUnit * piece_.motion.duration(); span *= 0.125) {
    const Instant later = piece_.at(t + span);
    for (ContactWitness& w : found_) {
      ++node_tests_;
      const ElementView view_a(piece_.a, w.element_a), view_b(piece_.b, w.element_b);
      const Element &a = *view_a, &b = *view_b;
      double share;
      const Closest closest = w.closest;
      if (touchesThrough(piece_, now, later, a, b, w, share)) {
        w.closest = closest;
        *witness = w;
        return true;
      }
    }
  }
  return false;
}

/// The distance of the origins from each other along the chord of their path is convex in time: where it is
/// large enough and falls, it was larger before; where it rises, it will be.
Span Search::reachOf(const PairPiece& piece) const {
  const RelativeMotion& m = piece.motion;
  const double end = m.duration(), rounding = 64.0 * kUnit * m.maxDistance();
  const double reach = (piece.a.reach() + piece.b.reach() + piece.contact_distance + piece.point_error +
                        0.125 * end * end * m.maxAcceleration() + rounding) *
                       (kUp + 64.0 * kUnit);
  const Vec3 d = m.displacement(0.0), e = m.displacement(end) - d;
  const double length2 = e.squaredNorm(), length = std::sqrt(length2);
  const double nearest = length2 > 0.0 ? -d.dot(e) / length2 : 0.0;
  const double reach2 = squareAbove(reach);
  const auto beyond = [&](double share) { return (d + share * e).squaredNorm() > reach2; };
  if (beyond(std::clamp(nearest, 0.0, 1.0))) return {kInfinity, -kInfinity};
  Span span{0.0, end};
  if (!(length > rounding)) return span;
  const double across2 = (d + nearest * e).squaredNorm();
  const double half = std::sqrt(std::max(0.0, reach2 - across2)) / length * (1.0 + 1e-9) + 1e-9;
  const double low = nearest - half, high = nearest + half;
  if (low > 0.0 && beyond(low) && (d + low * e).dot(e) < -rounding * length)
    span.low = low * end * (1.0 - 1e-12);
  if (high < 1.0 && beyond(high) && (d + high * e).dot(e) > rounding * length)
    span.high = std::min(end, high * end * (1.0 + 1e-12));
  return span;
}

}  // namespace collision_node::impact

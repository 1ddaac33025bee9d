#include "collision_node/impact/search.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "collision_node/impact/inside.h"

namespace collision_node::impact {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kUp = 1.0 + 64.0 * kUnit;

/// Split time rather than space when the motion's remainder exceeds this share of the nodes' sizes (measured:
/// flat from 0.03 to 0.1).
constexpr double kTimeSplit = 0.06;

/// Keeps the part of [low, high] (relative to the slab's middle) on which |d + w s| <= e. False when nothing
/// is left.
bool clipAxis(double d, double w, double e, double pad, double& low, double& high) {
  if (w == 0.0) return !(std::abs(d) > e);
  const double near = (-e - d) / w, far = (e - d) / w;
  low = std::max(low, std::min(near, far) - pad);
  high = std::min(high, std::max(near, far) + pad);
  return !(low > high);
}

/// The longest time any proposed axis proves. More are tried only where the first does worse than plain
/// advancement by the distance would.
double apartFrom(const PairPiece& piece, const Instant& now, const Element& a, const Element& b,
                 const Closest& closest, bool rounded, double span) {
  double best = 0.0, gap = 0.0;
  const auto propose = [&](const Axis& axis) {
    if (axis.valid) best = std::max(best, apartFor(GapModel(piece, now, a, b, axis), span, &gap));
  };
  Axis axis = axisOf(piece, now, closest, rounded);
  propose(axis);
  const double radius = a.radius + b.radius + piece.contact_distance;
  const double plain = (closest.v.norm() - radius - 2.0 * piece.point_error) / piece.speed;
  if (best >= span || !(best < 0.5 * plain || best == 0.0)) return best;
  axis.rate.setZero();
  propose(axis);
  const double length = closest.v.norm();
  if (length > 0.0) propose({closest.v / length, Vec3::Zero(), true});
  if (best < 0.5 * plain || best == 0.0) {
    for (const Axis& other : featureAxes(piece, now, a, b)) propose(other);
  }
  return best;
}

}  // namespace

std::int32_t Search::addSlab(double low, double high) {
  const RelativeMotion& m = piece_.motion;
  Slab s;
  s.middle = 0.5 * (low + high);
  s.half = std::max(high - s.middle, s.middle - low) * (1.0 + 4.0 * kUnit);
  const Instant now = piece_.at(s.middle);
  const Vec3 &wa = m.omegaA(), &wb = m.omegaB();
  const Vec3 turn = wb - wa;
  s.turn = turn.norm() * kUp;
  s.p0 = now.ra.transpose() * now.d;
  s.p1 = now.ra.transpose() * (now.d_rate - wa.cross(now.d));
  s.q0 = now.ra.transpose() * now.rb;
  for (int k = 0; k < 3; ++k) s.q1.col(k) = now.ra.transpose() * turn.cross(now.rb.col(k));
  s.back_p0 = -(now.rb.transpose() * now.d);
  s.back_p1 = -(now.rb.transpose() * (now.d_rate - wb.cross(now.d)));

  // |x''| <= |d'' - 2 w x d' + w x (w x d)| + (|O|^2 + |wa x wb|) |y|, the first at the middle plus its
  // growth.
  const Vec3 bend = m.acceleration(s.middle);
  const double bend_sup = bend.norm() + s.half * m.jerk();
  const double speed_sup = now.d_rate.norm() + s.half * bend_sup;
  const auto pathBend = [&](const Vec3& w, double spin) {
    const Vec3 g = bend - 2.0 * w.cross(now.d_rate) + w.cross(w.cross(now.d));
    return (g.norm() + s.half * (m.jerk() + 2.0 * spin * bend_sup + spin * spin * speed_sup)) * kUp;
  };
  s.bend_a = pathBend(wa, m.spinA());
  s.bend_b = pathBend(wb, m.spinB());
  s.bend_q = (s.turn * s.turn + wa.cross(wb).norm()) * kUp;
  s.extent = (s.q0.cwiseAbs() + s.half * s.q1.cwiseAbs()).array() +
             (0.5 * s.half * s.half * s.bend_q + 64.0 * kUnit);
  s.extent = s.extent.cwiseMin(1.0 + 64.0 * kUnit);
  slabs_.push_back(s);
  return static_cast<std::int32_t>(slabs_.size()) - 1;
}

std::int32_t Search::childOf(std::int32_t slab, bool late) {
  if (slabs_[slab].early < 0) {
    const double middle = slabs_[slab].middle, half = slabs_[slab].half;
    const std::int32_t early = addSlab(middle - half, middle);
    addSlab(middle, middle + half);
    slabs_[slab].early = early;
    ++subdivisions_;
  }
  return slabs_[slab].early + (late ? 1 : 0);
}

/// Narrows the item's time to where the boxes can overlap along their six axes; false when they cannot.
bool Search::clip(Item& item) const {
  const geometry::BvhNode &na = piece_.a.nodes()[item.a], &nb = piece_.b.nodes()[item.b];
  const Slab& s = slabs_[item.slab];
  const double bend = 0.5 * s.half * s.half * kUp;
  const double budget = piece_.contact_distance + 2.0 * piece_.frame_error + 2.0 * s.half * piece_.rate_error;
  const double pad = 32.0 * kUnit * piece_.motion.duration();
  double low = item.low - s.middle, high = item.high - s.middle;

  const Vec3 d = s.p0 + s.q0 * nb.centre - na.centre;
  const Vec3 w = s.p1 + s.q1 * nb.centre;
  const double extra_a = bend * (s.bend_a + s.bend_q * nb.reach) + budget;
  const Vec3 e = (na.half + s.extent * nb.half) * kUp;
  for (int k = 0; k < 3; ++k) {
    if (!clipAxis(d[k], w[k], e[k] + extra_a, pad, low, high)) return false;
  }
  const Vec3 back_d = s.back_p0 + s.q0.transpose() * na.centre - nb.centre;
  const Vec3 back_w = s.back_p1 + s.q1.transpose() * na.centre;
  const double extra_b = bend * (s.bend_b + s.bend_q * na.reach) + budget;
  const Vec3 back_e = (nb.half + s.extent.transpose() * na.half) * kUp;
  for (int k = 0; k < 3; ++k) {
    if (!clipAxis(back_d[k], back_w[k], back_e[k] + extra_b, pad, low, high)) return false;
  }
  item.low = std::max(item.low, s.middle + low);
  item.high = std::min(item.high, s.middle + high);
  return !(item.low > item.high);
}

/// Clips, then moves to ever smaller slabs as long as the rest of the time fits into one.
bool Search::prepare(Item& item) {
  ++node_tests_;
  if (!clip(item)) return false;
  while (true) {
    const double middle = slabs_[item.slab].middle;
    const bool late = item.low >= middle;
    if (!late && item.high > middle) return true;
    const double width = item.high - item.low;
    if (!(slabs_[item.slab].half > 16.0 * kUnit * piece_.motion.duration())) return true;
    if (slabs_[item.slab].bend_a + slabs_[item.slab].bend_q + slabs_[item.slab].turn == 0.0) return true;
    item.slab = childOf(item.slab, late);
    if (width < slabs_[item.slab].half) continue;  // a better slab is below
    if (!clip(item)) return false;
  }
}

template <typename Leaf>
void Search::walk(double from, double to, Leaf&& leaf) {
  slabs_.clear();
  stack_.clear();
  addSlab(from, to);
  Item root{0, 0, 0, from, to};
  if (prepare(root)) stack_.push_back(root);
  const auto &nodes_a = piece_.a.nodes(), &nodes_b = piece_.b.nodes();
  double until = kInfinity;
  while (!stack_.empty()) {
    const Item item = stack_.back();
    stack_.pop_back();
    if (!(item.low < until)) continue;
    if (exhausted()) {
      until = std::min(until, leaf.unresolved(item.low));
      continue;
    }
    const geometry::BvhNode &na = nodes_a[item.a], &nb = nodes_b[item.b];
    if (na.left < 0 && nb.left < 0) {
      until = std::min(until, leaf(na.element, nb.element, item.low, std::min(item.high, until)));
      continue;
    }
    Item children[2] = {item, item};
    const double size_a = na.half.norm(), size_b = nb.half.norm();
    const Slab& s = slabs_[item.slab];
    const double remainder =
        0.5 * s.half * s.half * (std::min(s.bend_a, s.bend_b) + s.bend_q * std::max(na.reach, nb.reach)) +
        s.half * s.turn * std::min(size_a, size_b);
    const bool split_time = remainder > kTimeSplit * (size_a + size_b) &&
                            s.half > 1e-9 * piece_.motion.duration() && item.low < s.middle &&
                            item.high > s.middle;
    if (split_time) {
      const double middle = s.middle;
      children[0].slab = childOf(item.slab, false);
      children[0].high = middle;
      children[1].slab = childOf(item.slab, true);
      children[1].low = middle;
    } else if (nb.left < 0 || (na.left >= 0 && size_a >= size_b)) {
      children[0].a = na.left;
      children[1].a = na.left + 1;
    } else {
      children[0].b = nb.left;
      children[1].b = nb.left + 1;
    }
    const bool keep0 = prepare(children[0]), keep1 = prepare(children[1]);
    const bool first_is_0 = !keep1 || (keep0 && children[0].low <= children[1].low);
    if (first_is_0) {
      if (keep1) stack_.push_back(children[1]);
      if (keep0) stack_.push_back(children[0]);
    } else {
      if (keep0) stack_.push_back(children[0]);
      stack_.push_back(children[1]);
    }
  }
}

/// Steps from `from` as long as a gap is proved; returns the time up to which, >= to when throughout.
double Search::advance(const Element& a, const Element& b, double from, double to, double stop) {
  const bool rounded = a.radius + b.radius + piece_.contact_distance > 0.0;
  constexpr int kMaxSteps = 4000;
  double t = from;
  Vec3 guess = Vec3::Zero();
  for (int step = 0; step < kMaxSteps; ++step) {
    if (step > 0) ++node_tests_;
    const Instant now = piece_.at(t);
    const Closest closest = closestPoints(Cores(now, a, b), guess);
    guess = closest.v;
    const double s = apartFrom(piece_, now, a, b, closest, rounded, to - t);
    if (!(s > 0.0)) return t;
    if (s >= to - t) return kInfinity;
    const double next = t + s;
    if (!(next > t)) return t;
    t = next;
    if (s < stop) return t;
  }
  return t;
}

Search::First Search::firstPossible(double from, double to, double stop) {
  struct Leaf {
    Search& search;
    double stop;
    First& first;
    double unresolved(double low) {
      if (!first.found || low < first.time) first = {true, low, {}};
      return first.time;
    }
    double operator()(std::int32_t ea, std::int32_t eb, double low, double high) {
      Vec3 buffer_a[3], buffer_b[3];
      const Element a = search.piece_.a.element(ea, buffer_a), b = search.piece_.b.element(eb, buffer_b);
      const double t = search.advance(a, b, low, high, stop);
      if (t > high) return kInfinity;
      if (!first.found || t < first.time) first = {true, t, {ea, eb}};
      return first.time;
    }
  };
  First first;
  if (straight_) {
    straight_->first(from, to, 10.0 * stop, path_contact_);
    node_tests_ += path_contact_.tests;
    if (path_contact_.kind == PathContact::Kind::kClear) return first;
    if (path_contact_.kind == PathContact::Kind::kContact) {
      const std::int32_t met = path_contact_.met[0].element;
      const ElementPair pair = straight_->pointIsA() ? ElementPair{0, met} : ElementPair{met, 0};
      return {true, path_contact_.lower, pair};
    }
  }
  walk(from, to, Leaf{*this, stop, first});
  return first;
}

const PathContact* Search::provedAt(double time) const {
  const bool proved =
      straight_ && path_contact_.kind == PathContact::Kind::kContact && path_contact_.lower == time;
  return proved ? &path_contact_ : nullptr;
}

std::vector<ElementPair> Search::nearPairs(double from, double to, std::size_t limit) {
  struct Leaf {
    Search& search;
    std::vector<ElementPair>& pairs;
    std::size_t limit;
    double unresolved(double) { return -kInfinity; }
    double operator()(std::int32_t ea, std::int32_t eb, double low, double high) {
      Vec3 buffer_a[3], buffer_b[3];
      const Element a = search.piece_.a.element(ea, buffer_a), b = search.piece_.b.element(eb, buffer_b);
      if (search.advance(a, b, low, high, 0.0) <= high) pairs.push_back({ea, eb});
      return pairs.size() < limit ? kInfinity : -kInfinity;
    }
  };
  std::vector<ElementPair> pairs;
  walk(from, to, Leaf{*this, pairs, limit});
  return pairs;
}

Proved Search::classify(double t, ContactWitness* witness, double horizon) {
  struct Leaf {
    Search& search;
    const Instant now;
    std::size_t wanted;
    std::vector<ContactWitness> found;
    bool undecided = false;
    double unresolved(double) {
      undecided = true;
      return -kInfinity;
    }
    double operator()(std::int32_t ea, std::int32_t eb, double, double) {
      Vec3 buffer_a[3], buffer_b[3];
      const PairPiece& piece = search.piece_;
      const Element a = piece.a.element(ea, buffer_a), b = piece.b.element(eb, buffer_b);
      const Closest closest = closestPoints(Cores(now, a, b), Vec3::Zero());
      const bool rounded = a.radius + b.radius + piece.contact_distance > 0.0;
      if (apartFrom(piece, now, a, b, closest, rounded, 1e-300) > 0.0) return kInfinity;
      ContactWitness w;
      if (touchesAt(piece, now, a, b, closest, w)) {
        w.element_a = ea;
        w.element_b = eb;
        found.push_back(std::move(w));
        if (found.size() >= wanted) return -kInfinity;
      } else {
        undecided = true;
      }
      return kInfinity;
    }
  };
  constexpr std::size_t kCandidates = 64;
  Leaf leaf{*this, piece_.at(t), horizon > 0.0 ? kCandidates : 1, {}, false};
  walk(t, t, leaf);
  if (!leaf.found.empty()) {
    if (horizon > 0.0 && longestLasting(t, horizon, leaf.found, witness)) return Proved::kContact;
    *witness = std::move(leaf.found[0]);
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
  *witness = ContactWitness();
  witness->point = held;
  return Proved::kContact;
}

bool Search::longestLasting(double t, double horizon, const std::vector<ContactWitness>& found,
                            ContactWitness* witness) {
  const Instant now = piece_.at(t);
  const double end = std::min(t + horizon, piece_.motion.duration());
  for (double span = end - t; span > 16.0 * kUnit * piece_.motion.duration(); span *= 0.125) {
    const Instant later = piece_.at(t + span);
    for (const ContactWitness& w : found) {
      ++node_tests_;
      Vec3 buffer_a[3], buffer_b[3];
      const Element a = piece_.a.element(w.element_a, buffer_a), b = piece_.b.element(w.element_b, buffer_b);
      if (touchesThrough(piece_, now, later, a, b, w)) {
        *witness = w;
        return true;
      }
    }
  }
  return false;
}

bool Search::outOfReach() const {
  const RelativeMotion& m = piece_.motion;
  const double reach = piece_.a.reach() + piece_.b.reach() + piece_.contact_distance + piece_.point_error;
  // Distance of the origin from the chord of d(t), minus how far the path can leave its chord.
  const Vec3 d0 = m.displacement(0.0), e = m.displacement(m.duration()) - d0;
  const double length2 = e.squaredNorm();
  const double s = length2 > 0.0 ? std::clamp(-d0.dot(e) / length2, 0.0, 1.0) : 0.0;
  const double away = (d0 + s * e).norm() * (1.0 - 64.0 * kUnit) - 64.0 * kUnit * m.maxDistance();
  return away - 0.125 * m.duration() * m.duration() * m.maxAcceleration() > reach * kUp;
}

}  // namespace collision_node::impact

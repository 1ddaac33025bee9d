/// Points that pass through surfaces, and straight paths whose contact the search has proved itself.
#include <algorithm>

#include "collision_node/impact/piece_run.h"
#include "collision_node/impact/straight/straight_facts.h"

namespace collision_node::impact {
namespace {

using Phase = PairState::Phase;

}  // namespace

bool PieceRun::closeStraight(const PathContact& met) {
  const StraightPath& path = *search_.straight();
  const bool whole = options_.scope == Scope::kWholePiece;
  const Phase next = phaseBehind(path, met);
  if (next == Phase::kUndecided) return false;
  PairEvent event;
  writeStraight(piece_, options_, path, met, event);
  events_.push_back(event);
  state_.contact = event;
  state_.phase = next;
  if (next == Phase::kApart) {
    events_.push_back(separationBehind(event));
  } else if (path.radius() == 0.0) {
    witness_.emplace();  // held by the solid
    witness_->point = event.position - pair_.motion.originOfA(event.toi_lower);
  } else if (whole) {
    ContactWitness found;
    found.element_a = opened_.a;
    found.element_b = opened_.b;
    Vec3 buffer_a[3], buffer_b[3];
    const Element a = pair_.a.element(opened_.a, buffer_a), b = pair_.b.element(opened_.b, buffer_b);
    const Instant now = pair_.at(met.upper);
    if (touchesAt(pair_, now, a, b, closestPoints(Cores(now, a, b), Vec3::Zero()), found)) witness_ = found;
  }
  return true;
}

bool PieceRun::passed(double from, double at, double& t) {
  if (state_.published || pair_.contact_distance > 0.0) return false;
  const NearPairs near = search_.nearPairs(from, at, 64);
  const double earlier = std::max(std::min(free_since_, from), from - std::max(at - from, 32.0 * floor_));
  const Instant first = pair_.at(earlier);
  for (const double more : {0.0, 1.0, 4.0, 16.0}) {
    const double later = std::min(end_, at + more * (at - earlier));
    if (more > 0.0 && !(later > at)) return false;
    for (const ElementPair& pair : near) {
      if (!passesBetween(first, pair_.at(later), near, pair)) continue;
      // Not by firstPossible(): what parted the pair before is still asked for.
      if (more > 0.0 && !search_.provesApart(at, later)) return false;
      PairEvent event = state_.pending;
      event.kind = Kind::kImpact;
      writer_.finishImpact(event, from, at, pair, state_);
      event.certificate = Certificate::kConfirmed;
      event.reason = Reason::kNone;
      events_.push_back(event);
      state_.contact = event;
      events_.push_back(separationBehind(event));
      state_.phase = Phase::kApart;
      t = at;
      return true;
    }
  }
  return false;
}

bool PieceRun::passesBetween(const Instant& first, const Instant& last, const NearPairs& near,
                             ElementPair pair) const {
  Vec3 buffer_a[3], buffer_b[3];
  const Element a = pair_.a.element(pair.a, buffer_a), b = pair_.b.element(pair.b, buffer_b);
  const bool point_is_a = a.count == 1 && b.triangle >= 0, point_is_b = b.count == 1 && a.triangle >= 0;
  if (!(point_is_a || point_is_b) || a.radius + b.radius > 0.0) return false;
  const Element& triangle = point_is_a ? b : a;
  const Vec3 point = point_is_a ? a.vertices[0] : b.vertices[0];
  const std::array<Vec3, 3> corners = {triangle.vertices[0], triangle.vertices[1], triangle.vertices[2]};
  if (passesThrough(pair_, first, last, point_is_a, point, TrianglePatch{corners})) return true;
  const auto patch = patchAround(near, pair, point_is_a, triangle.shape);  // through an edge or a vertex
  return passesThrough(pair_, first, last, point_is_a, point, patch);
}

TrianglePatch PieceRun::patchAround(const NearPairs& near, ElementPair pair, bool point_is_a,
                                    int shape) const {
  TrianglePatch patch;
  for (const ElementPair& other : near) {
    if (point_is_a ? other.a != pair.a : other.b != pair.b) continue;
    Vec3 buffer[3];
    const Element e = point_is_a ? pair_.b.element(other.b, buffer) : pair_.a.element(other.a, buffer);
    if (e.triangle >= 0 && e.shape == shape) patch.push_back({e.vertices[0], e.vertices[1], e.vertices[2]});
  }
  return patch;
}
}  // namespace collision_node::impact

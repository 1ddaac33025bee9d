#include "collision_node/scene/broad_phase/broad_phase.h"

#include <algorithm>
#include <limits>

namespace collision_node::scene {

namespace {

constexpr Nanoseconds kForEver = std::numeric_limits<Nanoseconds>::max();
/// How much larger than its object a lasting stay is, in radii: what is paid in neighbours that are not near
/// is saved in moves that change nothing.
constexpr double kRoom = 0.5;
/// And how many such segments more it has room for ahead, but no farther than so many radii.
constexpr double kSegmentsAhead = 8.0, kRadiiAhead = 2.0;

/// A box for an object that may go on as it does. Any box that holds the sweep is right.
Bounds roomFor(const Sweep& sweep) {
  const Vec3 room = Vec3::Constant(kRoom * sweep.radius);
  Bounds box = sweep.box();
  box.lower -= room;
  box.upper += room;
  const Vec3 way = sweep.to - sweep.from;
  const double length = way.norm();
  if (length > 0.0) {
    const Vec3 ahead = way * std::min(kSegmentsAhead, kRadiiAhead * sweep.radius / length);
    box.lower += ahead.cwiseMin(0.0);
    box.upper += ahead.cwiseMax(0.0);
  }
  return box;
}

}  // namespace

void BroadPhase::stand(const std::vector<int>& objects, const std::vector<Bounds>& boxes) {
  Vec3 middle = Vec3::Zero();
  for (const Bounds& box : boxes) middle += 0.5 * (box.lower + box.upper) / static_cast<double>(boxes.size());
  if (!boxes.empty()) seeFrom(middle);
  for (std::size_t i = 0; i < objects.size(); ++i) {
    Object& object = objects_[objects[i]];
    object.open = kStands;
    object.box = imageOf(boxes[i], origin_);
    standing_tree_.insert(object.box, objects[i]);
  }
}

/// Floats are fine near their origin only: it is where the first box is.
void BroadPhase::seeFrom(const Vec3& place) {
  if (has_origin_) return;
  has_origin_ = true;
  origin_ = place;
}

void BroadPhase::startEpoch() {
  has_origin_ = standing_tree_.size() > 0;
  for (Object& object : objects_) {
    object.first = kNone;
    if (object.open != kStands) object.open = kNone;
  }
  tree_.clear();
  stays_.clear();
  boxes_.clear();
  free_ = -1;
  endings_.clear();
}

template <typename Question>
void BroadPhase::askStanding(const Question& question) {
  if (standing_tree_.size() == 0) return;
  standing_tree_.find(question, walk_);
  found_.insert(found_.end(), walk_.items(), walk_.items() + walk_.count());
}

const std::vector<int>& BroadPhase::standingNear(const Bounds& box) {
  found_.clear();
  askStanding(imageOf(box, origin_));
  return found_;
}

template <typename Question>
void BroadPhase::ask(int object, const Question& question, Nanoseconds from_ns, Nanoseconds to_ns) {
  found_.clear();
  askStanding(question);
  tree_.find(question, walk_);
  for (std::size_t i = 0; i < walk_.count(); ++i) {
    const Stay& other = stays_[walk_.items()[i]];
    if (other.object != object && other.from_ns <= to_ns && from_ns <= other.to_ns)
      found_.push_back(other.object);
  }
}

const std::vector<int>& BroadPhase::move(int object, const Sweep& sweep, Nanoseconds from_ns,
                                         Nanoseconds to_ns, bool begins_anew) {
  seeFrom(sweep.from);
  Object& own = objects_[object];
  if (!begins_anew && own.open >= 0 && holdsImage(own.box, sweep.box(), origin_)) {
    found_.clear();
    return found_;
  }
  if (!sweep.isLong()) return stay(object, roomFor(sweep), from_ns);
  close(object, from_ns);
  const FloatLine line(sweep, origin_);
  ask(object, line, from_ns, to_ns);
  endings_.add(to_ns, begin(object, line.box, from_ns, to_ns));
  return found_;
}

const std::vector<int>& BroadPhase::stay(int object, const Bounds& box, Nanoseconds from_ns) {
  seeFrom(0.5 * (box.lower + box.upper));
  close(object, from_ns);
  Object& own = objects_[object];
  own.box = imageOf(box, origin_);
  ask(object, own.box, from_ns, kForEver);
  own.open = begin(object, own.box, from_ns, kForEver);
  return found_;
}

/// Right after ask().
std::int32_t BroadPhase::begin(int object, const FloatBox& box, Nanoseconds from_ns, Nanoseconds to_ns) {
  std::int32_t index = free_;
  if (index < 0) {
    index = static_cast<std::int32_t>(stays_.size());
    stays_.emplace_back();
    boxes_.emplace_back();
  } else {
    free_ = stays_[index].next;
  }
  boxes_[index] = box;
  stays_[index] = {object, std::exchange(objects_[object].first, index), from_ns, to_ns};
  tree_.insert(box, index, walk_);
  return index;
}

void BroadPhase::close(int object, Nanoseconds ns) {
  const std::int32_t open = std::exchange(objects_[object].open, kNone);
  if (open < 0) return;
  stays_[open].to_ns = ns;
  endings_.add(ns, open);
}

void BroadPhase::forgetBefore(Nanoseconds ns) {
  over_.clear();
  endings_.advance(ns, [this](std::int32_t index) {
    over_.push_back(index);
    __builtin_prefetch(&stays_[index]);
  });
  tree_.remove(over_);
  for (const std::int32_t index : over_) {
    Stay& stay = stays_[index];
    std::int32_t* link = &objects_[stay.object].first;
    while (*link != index) link = &stays_[*link].next;
    *link = std::exchange(stay.next, std::exchange(free_, index));
  }
}

bool BroadPhase::mayMeet(int a, int b) const {
  if (objects_[a].open == kStands) std::swap(a, b);
  const Object& first = objects_[a];
  const Object& second = objects_[b];
  // What lasts meets most often.
  if (first.open != kNone && second.open != kNone && first.box.meets(second.box)) return true;
  for (std::int32_t i = first.first; i >= 0; i = stays_[i].next) {
    const Stay& stay = stays_[i];
    if (second.open == kStands && boxes_[i].meets(second.box)) return true;
    for (std::int32_t k = second.first; k >= 0; k = stays_[k].next) {
      const Stay& other = stays_[k];
      if (other.from_ns <= stay.to_ns && stay.from_ns <= other.to_ns && boxes_[i].meets(boxes_[k]))
        return true;
    }
  }
  return false;
}

}  // namespace collision_node::scene

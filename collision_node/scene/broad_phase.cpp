#include "collision_node/scene/broad_phase.h"

#include <algorithm>
#include <limits>

#include "collision_node/scene/block_question.h"

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
  Bounds box = grown(sweep.box, kRoom * sweep.radius);
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
  standing_objects_ = objects;
  standing_ = boxes;
  for (std::size_t i = 0; i < objects.size(); ++i)
    objects_[objects[i]].standing = static_cast<std::int32_t>(i);
  if (objects.empty()) return;
  standing_tree_ = geometry::Bvh(boxes);
  for (const Bounds& box : boxes) {
    const Vec3 far = (box.lower - standing_tree_.origin())
                         .cwiseAbs()
                         .cwiseMax((box.upper - standing_tree_.origin()).cwiseAbs());
    standing_far_ = standing_far_.cwiseMax(far);
  }
}

void BroadPhase::startEpoch() {
  for (Object& object : objects_) {
    object.stays.clear();
    object.open = -1;
  }
  tree_.clear();
  stays_.clear();
  free_stays_.clear();
  endings_ = {};
}

template <typename Question>
void BroadPhase::askStanding(const Question& question) {
  if (standing_.empty()) return;
  const auto take = [&](std::int32_t index) {
    if (question.meets(standing_[index])) found_.push_back(standing_objects_[index]);
  };
  const BlockQuestion block_question(question, standing_tree_.origin(), standing_far_.maxCoeff());
  const std::int32_t root = standing_tree_[geometry::Bvh::kRoot].link;
  if (root < 0) {
    take(~root);
    return;
  }
  waiting_.assign(1, root);
  while (!waiting_.empty()) {
    const geometry::BvhBlock& block = standing_tree_.block(waiting_.back());
    waiting_.pop_back();
    bool meets[geometry::BvhBlock::kWidth];
    block_question.ask(block, meets);
    for (int i = 0; i < geometry::BvhBlock::kWidth; ++i) {
      if (!meets[i]) continue;
      if (block.link[i] < 0) {
        take(~block.link[i]);
      } else {
        waiting_.push_back(block.link[i]);
      }
    }
  }
}

const std::vector<int>& BroadPhase::standingNear(const Bounds& box) {
  found_.clear();
  askStanding(BoxQuestion{box});
  return found_;
}

template <typename Question>
void BroadPhase::ask(int object, const Question& question, Nanoseconds from_ns, Nanoseconds to_ns) {
  found_.clear();
  askStanding(question);
  tree_.visit(question, [&](std::int32_t leaf) {
    const Stay& other = stays_[tree_.item(leaf)];
    if (other.object != object && other.from_ns <= to_ns && from_ns <= other.to_ns)
      found_.push_back(other.object);
  });
}

const std::vector<int>& BroadPhase::move(int object, const Sweep& sweep, Nanoseconds from_ns,
                                         Nanoseconds to_ns, bool begins_anew) {
  const std::int32_t open = objects_[object].open;
  if (!begins_anew && open >= 0 && holds(tree_.box(stays_[open].leaf), sweep.box)) {
    found_.clear();
    return found_;
  }
  if (!sweep.isLong()) return stay(object, roomFor(sweep), from_ns);
  close(object, from_ns);
  ask(object, LineQuestion(sweep), from_ns, to_ns);
  begin(object, sweep.box, from_ns, to_ns, false);
  return found_;
}

const std::vector<int>& BroadPhase::stay(int object, const Bounds& box, Nanoseconds from_ns) {
  close(object, from_ns);
  ask(object, BoxQuestion{box}, from_ns, kForEver);
  begin(object, box, from_ns, kForEver, true);
  return found_;
}

void BroadPhase::begin(int object, const Bounds& box, Nanoseconds from_ns, Nanoseconds to_ns, bool lasts) {
  std::int32_t index = static_cast<std::int32_t>(stays_.size());
  if (free_stays_.empty()) {
    stays_.emplace_back();
  } else {
    index = free_stays_.back();
    free_stays_.pop_back();
  }
  stays_[index] = {object, from_ns, to_ns, tree_.insert(box, index)};
  objects_[object].stays.push_back(index);
  if (lasts) {
    objects_[object].open = index;
  } else {
    endings_.push({to_ns, index});
  }
}

void BroadPhase::close(int object, Nanoseconds ns) {
  const std::int32_t open = std::exchange(objects_[object].open, -1);
  if (open < 0) return;
  stays_[open].to_ns = ns;
  endings_.push({ns, open});
}

void BroadPhase::forgetBefore(Nanoseconds ns) {
  while (!endings_.empty() && endings_.top().first <= ns) {
    const std::int32_t index = endings_.top().second;
    endings_.pop();
    tree_.remove(stays_[index].leaf);
    std::vector<std::int32_t>& own = objects_[stays_[index].object].stays;
    own.erase(std::find(own.begin(), own.end(), index));
    free_stays_.push_back(index);
  }
}

bool BroadPhase::mayMeet(int a, int b) const {
  if (objects_[a].standing >= 0) std::swap(a, b);
  const Object& first = objects_[a];
  const Object& second = objects_[b];
  for (const std::int32_t i : first.stays) {
    const Stay& stay = stays_[i];
    if (second.standing >= 0 && meet(tree_.box(stay.leaf), standing_[second.standing])) return true;
    for (const std::int32_t k : second.stays) {
      const Stay& other = stays_[k];
      if (other.from_ns <= stay.to_ns && stay.from_ns <= other.to_ns &&
          meet(tree_.box(stay.leaf), tree_.box(other.leaf)))
        return true;
    }
  }
  return false;
}

}  // namespace collision_node::scene

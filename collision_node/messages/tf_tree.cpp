#include "collision_node/messages/tf_tree.h"

#include <algorithm>
#include <set>
#include <utility>

#include "collision_node/scene/fingerprint.h"

namespace collision_node::messages {

TfTree::TfTree(std::string world_frame, const scene::TimeOptions& time, Sink sink)
    : world_(std::move(world_frame)), time_(time), sink_(std::move(sink)) {}

void TfTree::follow(int object, const std::string& frame, const std::string& label) {
  Follower follower;
  follower.object = object;
  follower.frame = frame;
  follower.label = label;
  followers_.push_back(std::move(follower));
}

std::vector<std::string> TfTree::chainToRoot(const std::string& frame) const {
  std::vector<std::string> chain{frame};
  for (auto edge = edges_.find(frame); edge != edges_.end(); edge = edges_.find(edge->second.parent)) {
    // No frame ever gets a second parent, so a loop can only close on a frame already in the chain.
    if (std::find(chain.begin(), chain.end(), edge->second.parent) != chain.end())
      throw TfError("tf frames form a loop through '" + edge->second.parent + "'");
    chain.push_back(edge->second.parent);
  }
  return chain;
}

/// Throws when an edge above one of the first `count` frames is in conflict.
void TfTree::checkConflicts(const std::vector<std::string>& chain, std::size_t count) const {
  for (std::size_t i = 0; i < count; ++i)
    if (const auto found = conflicts_.find(chain[i]); found != conflicts_.end()) throw TfError(found->second);
}

bool TfTree::resolve(Follower& follower) const {
  const auto from_world = chainToRoot(world_);
  const auto from_frame = chainToRoot(follower.frame);
  std::size_t common_w = 0, common_f = 0;
  for (; common_w < from_world.size(); ++common_w) {
    const auto found = std::find(from_frame.begin(), from_frame.end(), from_world[common_w]);
    if (found == from_frame.end()) continue;
    common_f = static_cast<std::size_t>(found - from_frame.begin());
    break;
  }
  if (common_w == from_world.size()) {
    // Where a chain ends, the transform above it may have been refused.
    checkConflicts({from_world.back()}, 1);
    checkConflicts({from_frame.back()}, 1);
    return false;
  }
  checkConflicts(from_world, common_w);
  checkConflicts(from_frame, common_f);

  follower.up.assign(from_world.begin(), from_world.begin() + static_cast<std::ptrdiff_t>(common_w));
  follower.down.assign(from_frame.begin(), from_frame.begin() + static_cast<std::ptrdiff_t>(common_f));
  std::reverse(follower.down.begin(), follower.down.end());

  prepare(follower);
  follower.resolved = true;
  return true;
}

/// Decides how a frame whose chain is known is followed.
void TfTree::prepare(Follower& follower) const {
  std::vector<scene::ComposedPath::Part> parts;
  follower.before = {};
  follower.is_bare = true;
  bool is_plain = true;  // nothing moving before the part, nor is it inverted
  for (const auto* side : {&follower.up, &follower.down}) {
    for (const auto& child : *side) {
      const Edge& edge = edges_.at(child);
      scene::ComposedPath::Part part;
      part.inverse = side == &follower.up;
      part.pose = edge.pose;
      if (edge.is_static) {
        const Pose step = part.inverse ? edge.pose.inverse() : edge.pose;
        if (follower.moving.empty()) follower.before = follower.is_bare ? step : follower.before * step;
        if (follower.moving.empty()) follower.is_bare = false;
      } else {
        is_plain = follower.moving.empty() && !part.inverse;
        part.edge = static_cast<int>(follower.moving.size());
        follower.moving.emplace(child, part.edge);
      }
      parts.push_back(part);
    }
  }
  if (follower.moving.empty() || (is_plain && parts.back().edge >= 0)) return;
  const int object = follower.object;
  follower.path = std::make_unique<scene::ComposedPath>(
      std::move(parts), static_cast<int>(follower.moving.size()), time_,
      [this, object](const motion::StampedPose& pose, bool guessed) {
        sink_(object, pose, guessed ? StampKind::kGuessed : StampKind::kSent);
      });
}

/// What its edges have kept, in the order of arrival.
void TfTree::handOutKept(const Follower& follower) const {
  if (follower.moving.empty()) {
    motion::StampedPose pose;
    pose.pose = follower.before;
    sink_(follower.object, pose, StampKind::kAlways);
    return;
  }
  std::map<std::uint64_t, std::pair<const std::string*, const Sample*>> in_order;
  for (const auto& moving : follower.moving)
    for (const Sample& sample : edges_.at(moving.first).kept)
      in_order[sample.arrival] = {&moving.first, &sample};
  for (const auto& entry : in_order) emit(follower, *entry.second.first, *entry.second.second);
}

void TfTree::resolveAll() {
  std::string fault;
  bool all = true;
  for (auto& follower : followers_) {
    if (follower.resolved) continue;
    try {
      if (resolve(follower)) handOutKept(follower);
    } catch (const TfError& error) {
      if (fault.empty()) fault = error.what();
    }
    all = all && follower.resolved;
  }
  if (all)
    for (auto& edge : edges_) edge.second.kept.clear();
  if (!fault.empty()) throw TfError(fault);
}

void TfTree::emit(const Follower& follower, const std::string& child, const Sample& sample) const {
  motion::StampedPose out = sample.pose;
  const bool is_good = motion::checkAndNormalise(out) == motion::PoseFault::kNone;
  // A single edge keeps its numbers: composing with an identity would round them.
  if (!is_good || (!follower.path && follower.is_bare)) {
    sink_(follower.object, sample.pose, sample.kind);
  } else if (follower.path) {
    follower.path->add(follower.moving.at(child), out, sample.kind == StampKind::kGuessed);
  } else {
    out.pose = follower.before * out.pose;
    out.linear = follower.before.orientation * out.linear;
    out.angular = follower.before.orientation * out.angular;
    sink_(follower.object, out, sample.kind);
  }
}

void TfTree::announce(const std::string& parent, const std::string& child) {
  edges_[child].parent = parent;
  resolveAll();
}

void TfTree::add(const std::string& parent, const std::string& child, const motion::StampedPose& pose,
                 StampKind kind) {
  if (followers_.empty()) return;
  const bool is_static = kind == StampKind::kAlways;
  const auto found = edges_.find(child);
  if (parent == child) {
    refuse(child, "tf frame '" + child + "' is its own parent");
  } else if (found != edges_.end() && found->second.parent != parent) {
    refuse(child, "tf frame '" + child + "' had the parent '" + found->second.parent + "' and now gets '" +
                      parent + "'");
  } else if (found != edges_.end() && found->second.is_static != is_static) {
    refuse(child, "tf frame '" + child + "' is sent both on /tf and on /tf_static");
  } else if (is_static) {
    addStatic(parent, child, pose.pose);
  } else {
    addMoving(parent, child, {++arrivals_, pose, kind});
  }
}

void TfTree::flush() {
  for (const auto& follower : followers_)
    if (follower.path) follower.path->flush();
}

void TfTree::clockWentBack() {
  for (const auto& follower : followers_)
    if (follower.path) follower.path->clockWentBack();
}

/// Keeps the fault at the edge above `child`; throws it when a followed chain runs through there.
void TfTree::refuse(const std::string& child, const std::string& fault) {
  conflicts_[child] = fault;
  for (const auto& follower : followers_) {
    if (!follower.resolved) continue;
    for (const auto* part : {&follower.up, &follower.down})
      if (std::find(part->begin(), part->end(), child) != part->end()) throw TfError(fault);
  }
  resolveAll();
}

void TfTree::addStatic(const std::string& parent, const std::string& child, const Pose& pose) {
  motion::StampedPose checked;
  checked.pose = pose;
  if (motion::checkAndNormalise(checked) != motion::PoseFault::kNone) {
    refuse(child,
           "static transform '" + parent + "' to '" + child + "' is not finite or its quaternion not unit");
    return;
  }
  const bool is_new = edges_.count(child) == 0;
  Edge& edge = edges_[child];
  edge.parent = parent;
  edge.is_static = true;
  edge.pose = checked.pose;
  if (!is_new) return;
  conflicts_.erase(child);  // only refused transforms so far, and now a good one
  resolveAll();
}

void TfTree::addMoving(const std::string& parent, const std::string& child, const Sample& sample) {
  const bool is_new = edges_.count(child) == 0;
  Edge& edge = edges_[child];
  edge.parent = parent;
  if (is_new) conflicts_.erase(child);
  bool waiting = false;
  for (const auto& follower : followers_) {
    if (!follower.resolved)
      waiting = true;
    else if (follower.moving.count(child) != 0)
      emit(follower, child, sample);
  }
  if (!waiting) return;
  if (edge.kept.size() == kKept) edge.kept.pop_front();
  edge.kept.push_back(sample);
  // The chain can only have become complete with a new edge.
  if (is_new) resolveAll();
}

void TfTree::describe(scene::Fingerprint& to) const {
  for (const auto& follower : followers_) {
    to.add(follower.resolved);
    for (const auto* part : {&follower.up, &follower.down}) {
      for (const auto& child : *part) {
        const Edge& edge = edges_.at(child);
        to.add(child);
        to.add(edge.parent);
        to.add(edge.is_static);
        if (edge.is_static) to.add(edge.pose);
        to.add(conflicts_.count(child));
      }
    }
    if (follower.path) follower.path->describe(to);
  }
}

std::vector<std::string> TfTree::unresolved() const {
  std::vector<std::string> out;
  for (const auto& follower : followers_)
    if (!follower.resolved) out.push_back(follower.label);
  return out;
}

std::vector<std::string> TfTree::frames() const {
  std::set<std::string> all;
  for (const auto& edge : edges_) {
    all.insert(edge.first);
    all.insert(edge.second.parent);
  }
  return {all.begin(), all.end()};
}

}  // namespace collision_node::messages

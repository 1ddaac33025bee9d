#include "collision_node/messages/tf_tree.h"

#include <algorithm>
#include <set>
#include <utility>

namespace collision_node::messages {

TfTree::TfTree(std::string world_frame, Sink sink) : world_(std::move(world_frame)), sink_(std::move(sink)) {}

void TfTree::follow(int object, const std::string& frame) {
  Follower follower;
  follower.object = object;
  follower.frame = frame;
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

  std::vector<std::string> moving;
  for (const auto* part : {&follower.up, &follower.down})
    for (const auto& child : *part)
      if (!edges_.at(child).is_static) moving.push_back(child);
  if (moving.empty())
    throw TfError("tf frame '" + follower.frame + "' never moves in '" + world_ +
                  "' (static transforms only): use pose: {fixed: ...}");
  if (moving.size() > 1)
    throw TfError("tf frame '" + follower.frame + "' hangs on " + std::to_string(moving.size()) +
                  " moving transforms ('" + edges_.at(moving[0]).parent + "' to '" + moving[0] + "', '" +
                  edges_.at(moving[1]).parent + "' to '" + moving[1] + "'): only one is supported so far");
  follower.moving = moving.front();
  follower.resolved = true;
  return true;
}

void TfTree::resolveAll() {
  std::string fault;
  bool all = true;
  for (auto& follower : followers_) {
    if (follower.resolved) continue;
    try {
      if (resolve(follower))
        for (const auto& sample : edges_.at(follower.moving).kept) emit(follower, sample);
    } catch (const TfError& error) {
      if (fault.empty()) fault = error.what();
    }
    all = all && follower.resolved;
  }
  if (all)
    for (auto& edge : edges_) edge.second.kept.clear();
  if (!fault.empty()) throw TfError(fault);
}

void TfTree::emit(const Follower& follower, const Sample& sample) const {
  motion::StampedPose out;
  out.stamp_ns = sample.stamp_ns;
  out.pose = sample.pose;
  if (motion::checkAndNormalise(out) != motion::PoseFault::kNone) {
    out.pose = sample.pose;
    sink_(follower.object, out);
    return;
  }
  const Pose moving = out.pose;
  // A single edge keeps its numbers: composing with an identity would round them.
  if (!(follower.up.empty() && follower.down.size() == 1)) {
    Pose pose;
    for (const auto& child : follower.up)
      pose = pose * (child == follower.moving ? moving : edges_.at(child).pose).inverse();
    for (const auto& child : follower.down)
      pose = pose * (child == follower.moving ? moving : edges_.at(child).pose);
    out.pose = pose;
  } else {
    out.pose = sample.pose;
  }
  sink_(follower.object, out);
}

void TfTree::add(const std::string& parent, const std::string& child, Nanoseconds stamp_ns, const Pose& pose,
                 bool is_static) {
  if (followers_.empty()) return;
  const auto found = edges_.find(child);
  if (parent == child) {
    refuse(child, "tf frame '" + child + "' is its own parent");
  } else if (found != edges_.end() && found->second.parent != parent) {
    refuse(child, "tf frame '" + child + "' had the parent '" + found->second.parent + "' and now gets '" +
                      parent + "'");
  } else if (found != edges_.end() && found->second.is_static != is_static) {
    refuse(child, "tf frame '" + child + "' is sent both on /tf and on /tf_static");
  } else if (is_static) {
    addStatic(parent, child, pose);
  } else {
    addMoving(parent, child, {stamp_ns, pose});
  }
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
    else if (follower.moving == child)
      emit(follower, sample);
  }
  if (!waiting) return;
  if (edge.kept.size() == kKept) edge.kept.pop_front();
  edge.kept.push_back(sample);
  // The chain can only have become complete with a new edge.
  if (is_new) resolveAll();
}

std::vector<std::string> TfTree::unresolved() const {
  std::vector<std::string> out;
  for (const auto& follower : followers_)
    if (!follower.resolved) out.push_back(follower.frame);
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

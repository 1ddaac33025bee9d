#include "collision_node/replay/session.h"

#include <limits>
#include <utility>

#include "collision_node/scene/fingerprint.h"
#include "collision_node/scene/needs.h"
#include "collision_node/scene/tracks/instant.h"

namespace collision_node::replay {

Session::Session(const Options& options, std::shared_ptr<const scene::Scene> scene, const BagInput& input,
                 Sinks sinks)
    : scene_(std::move(scene)),
      sinks_(std::move(sinks)),
      heard_(scene_->objects.size(), 0),
      router_(
          scene_, [&](const std::string& topic) { return resolveTopic(options.name_space, topic); },
          [this](int object, const motion::StampedPose& pose, messages::StampKind kind) {
            if (kind != messages::StampKind::kAlways) sinks_.pose_seen(now_ns_, pose.stamp_ns);
            heard_[static_cast<std::size_t>(object)] = 1;
            messages::handToEngine(*engine_, object, pose, kind);
          }) {
  input.check(router_, *scene_,
              [&](const std::string& topic) { return resolveTopic(options.name_space, topic); });
  scene::EngineOptions how;
  how.threads = options.threads;
  how.everything = options.everything;
  engine_ = std::make_unique<scene::Engine>(scene_, options.method, sinks_.engine, how);
}

void Session::feed(const BagInput::Message& message) {
  now_ns_ = message.received_ns;
  gaps_.see(message.connection.topic, message.connection.sender, message.raw);
  try {
    router_.handle(message.connection.topic, message.raw, now_ns_);
  } catch (const messages::PoseError&) {
    // Counted by the router and told at the end; the rest of the bag is good.
  }
}

void Session::flush() {
  router_.flush();
  engine_->flush();
}

scene::Stats Session::withMessages(scene::Stats stats) const {
  router_.count(stats);
  stats.lost = gaps_.lost();
  return stats;
}

scene::Cut Session::cut() const {
  scene::Cut cut = engine_->cut();
  scene::Fingerprint state;
  state.add(cut.state);
  router_.describe(state);
  cut.state = state.value();
  return cut;
}

bool Session::knowsAllAt(const scene::Cut& cut) const {
  if (!cut.is_settled || !router_.tf().unresolved().empty()) return false;
  const std::vector<scene::Need> needs = scene::needsOf(*scene_);
  for (std::size_t i = 0; i < heard_.size(); ++i) {
    const scene::PoseSource::Type type = scene_->objects[i].source.type;
    if (needs[i] != scene::Need::kWatched) continue;
    const bool hangs = type == scene::PoseSource::Type::kTf || type == scene::PoseSource::Type::kJoints;
    if (heard_[i] == 0 && hangs) return false;
  }
  // Two rounds of a loop are a memory as good as a long one.
  return cut.epoch >= 2 || cut.span_ns >= memoryOf(scene_->time);
}

Nanoseconds memoryOf(const scene::TimeOptions& time) {
  constexpr Nanoseconds kEver = std::numeric_limits<Nanoseconds>::max() / 8;
  Nanoseconds sum = 0;
  for (const double part : {time.timeout, time.max_gap, time.reorder, time.jump})
    sum += std::min(scene::toNanoseconds(part), kEver / 4);
  return sum;
}

}  // namespace collision_node::replay

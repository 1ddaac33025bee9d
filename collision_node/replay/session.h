/// Messages in, events out: one router and one engine, from some point of a recording on.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "collision_node/messages/pose_router.h"
#include "collision_node/messages/sequence_gaps.h"
#include "collision_node/replay/bag_input.h"
#include "collision_node/replay/options.h"
#include "collision_node/scene/engine.h"

namespace collision_node::replay {

class Session {
 public:
  struct Sinks {
    scene::Engine::Sinks engine;
    /// A pose with a stamp was received.
    std::function<void(Nanoseconds received_ns, Nanoseconds stamp_ns)> pose_seen;
  };

  /// Checks the bags against the scene; throws as BagInput::check, PoseRouter and Engine do.
  Session(const Options& options, std::shared_ptr<const scene::Scene> scene, const BagInput& input,
          Sinks sinks);

  /// What cannot be used is counted.
  void feed(const BagInput::Message& message);
  /// The end of the recording.
  void flush();

  const messages::PoseRouter& router() const { return router_; }
  const scene::Engine& engine() const { return *engine_; }
  /// Of the engine, and of messages that never reached it.
  scene::Stats stats() const { return withMessages(engine_->stats()); }
  scene::Stats withMessages(scene::Stats stats) const;

  /// Of the engine, and of what stands between it and the messages.
  scene::Cut cut() const;
  /// A session that begins here, and not at the begin of the recording, knows all that counts at `cut`.
  bool knowsAllAt(const scene::Cut& cut) const;

  /// By object: it has sent a pose.
  const std::vector<char>& heard() const { return heard_; }

 private:
  std::shared_ptr<const scene::Scene> scene_;
  Sinks sinks_;
  std::vector<char> heard_;
  messages::PoseRouter router_;
  messages::SequenceGaps gaps_;
  std::unique_ptr<scene::Engine> engine_;
  Nanoseconds now_ns_ = 0;
};

/// How far before a cut a session must begin at least, to know what the tracks remember there. [ns]
Nanoseconds memoryOf(const scene::TimeOptions& time);

}  // namespace collision_node::replay

/// The live node: poses from topics in, impacts out. One class for the executable and the nodelet.
#pragma once

#include <diagnostic_msgs/DiagnosticArray.h>
#include <ros/callback_queue.h>
#include <ros/node_handle.h>
#include <ros/spinner.h>
#include <std_srvs/Trigger.h>
#include <topic_tools/shape_shifter.h>

#include <chrono>
#include <cstdint>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "collision_node/messages/markers.h"
#include "collision_node/messages/pose_router.h"
#include "collision_node/messages/sequence_gaps.h"
#include "collision_node/node/parameters.h"
#include "collision_node/scene/engine.h"

namespace collision_node::node {

/// Works on one thread and one callback queue of its own. Time is the poses' own; the clock is only watched
/// for going back. Publishes ~impacts, ~stats, ~markers, ~plan, /diagnostics; serves ~reset, ~flush,
/// ~reload_scene.
class CollisionNode {
 public:
  /// Reads parameters and scene, subscribes, starts working. Throws ParameterError, scene::SceneError,
  /// messages::PoseError or std::invalid_argument, whose what() is for the user.
  CollisionNode(const ros::NodeHandle& handle, const ros::NodeHandle& private_handle);

  /// Decides and publishes everything that has arrived. ROS must still be up for anyone to hear it.
  ~CollisionNode();

 private:
  using Trigger = std_srvs::Trigger;
  using Raw = topic_tools::ShapeShifter;

  std::shared_ptr<const scene::Scene> load(const Parameters& parameters) const;
  void start(const Parameters& parameters, std::shared_ptr<const scene::Scene> scene);
  void subscribe();
  void flush();
  void onMessage(const std::string& topic, const ros::MessageEvent<Raw const>& event);
  void watchClock();
  void onEvent(scene::Event event);
  scene::Stats withMessages(scene::Stats stats) const;
  void onStats(scene::Stats stats);
  void onMarkerSubscriber();
  void onDiagnosticsTimer(const ros::WallTimerEvent&);
  bool onReset(Trigger::Request&, Trigger::Response& response);
  bool onFlush(Trigger::Request&, Trigger::Response& response);
  bool onReload(Trigger::Request&, Trigger::Response& response);

  ros::CallbackQueue queue_;
  ros::NodeHandle handle_, private_handle_;
  ros::Publisher impacts_, stats_, markers_out_, plan_, diagnostics_;
  std::vector<ros::ServiceServer> services_;
  std::vector<ros::Subscriber> subscribers_;
  std::set<std::string> subscribed_;  // topics
  ros::WallTimer diagnostics_timer_;

  std::shared_ptr<const scene::Scene> scene_;
  std::unique_ptr<messages::PoseRouter> router_;
  std::unique_ptr<messages::Markers> markers_;
  std::unique_ptr<scene::Engine> engine_;

  messages::SequenceGaps gaps_;
  std::vector<std::uint8_t> bytes_;
  ros::Time last_clock_;
  std::chrono::steady_clock::time_point last_heartbeat_;
  std::uint32_t queue_size_ = 0;
  std::uint64_t messages_ = 0, events_ = 0;
  std::uint32_t epoch_ = 0,
                first_epoch_ = 0;  // first_epoch_: a reloaded scene counts on, its engine starts at 0
  std::unique_ptr<ros::AsyncSpinner> spinner_;  // last: stops before anything it uses is gone
};

}  // namespace collision_node::node

/// Which topic feeds which object: one place for node and replay, so that both hear the same poses.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "collision_node/messages/pose_reader.h"
#include "collision_node/messages/tf_tree.h"
#include "collision_node/scene/scene.h"

namespace collision_node::messages {

/// What could not be used of one topic.
struct TopicFaults {
  std::uint64_t refused = 0;   ///< messages: another frame, type or length than the scene needs
  std::string first_refusal;   ///< one line
  std::uint64_t rejected = 0;  ///< poses: NaN, Inf or no unit quaternion; handed on, the engine drops them
};

/// Takes raw messages by topic and hands poses to the engine. One caller at a time.
class PoseRouter {
 public:
  using Sink = std::function<void(int object, const motion::StampedPose& pose)>;
  /// Topic as the scene has it -> name in the ROS graph or bag.
  using ResolveTopic = std::function<std::string(const std::string& topic)>;

  /// Throws PoseError for sources that are not supported yet (gazebo model/link states, links: true).
  PoseRouter(std::shared_ptr<const scene::Scene> scene, const ResolveTopic& resolve, Sink sink);
  PoseRouter(const PoseRouter&) = delete;
  PoseRouter& operator=(const PoseRouter&) = delete;

  /// Every topic to listen to, in byte order; /tf and /tf_static among them when an object is driven by tf.
  const std::vector<std::string>& topics() const { return topics_; }
  bool usesTf() const { return uses_tf_; }

  /// Throws PoseError, with topic and type, when messages of this type cannot be used on `topic`.
  void checkType(const std::string& topic, const std::string& datatype, const std::string& md5sum) const;

  /// Topic of an object that is driven by one, as resolved; "" for others.
  const std::string& topicOf(int object) const { return topic_of_[static_cast<std::size_t>(object)]; }

  /// Hands every pose in the message to the sink. Throws PoseError with topic and object after all that can
  /// be used has been used, and counts the message as refused.
  void handle(const std::string& topic, const RawMessage& message);

  const TfTree& tf() const { return tf_; }

  /// By topic; topics without a fault are absent.
  const std::map<std::string, TopicFaults>& faults() const { return faults_; }
  /// Refused messages on all topics.
  std::uint64_t refused() const;

 private:
  void deliver(const std::string& topic, int object, const motion::StampedPose& pose);
  void handlePoses(const std::string& topic, const RawMessage& message);
  void handleTf(const std::string& topic, const RawMessage& message);

  std::shared_ptr<const scene::Scene> scene_;
  Sink sink_;
  TfTree tf_;
  bool uses_tf_ = false;
  std::vector<std::string> topics_;
  std::vector<std::string> topic_of_;  // by object
  std::map<std::string, TopicFaults> faults_;
  std::map<std::string, std::vector<int>> objects_of_;
};

}  // namespace collision_node::messages

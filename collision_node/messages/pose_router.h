/// Which topic feeds which object: one place for node and replay, so that both hear the same poses.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "collision_node/messages/joint_states.h"
#include "collision_node/messages/path_memory.h"
#include "collision_node/messages/pose_reader.h"
#include "collision_node/messages/tf_tree.h"
#include "collision_node/scene/engine.h"
#include "collision_node/scene/needs.h"
#include "collision_node/scene/scene.h"

namespace collision_node::messages {

/// What could not be used of one topic.
struct TopicFaults {
  std::uint64_t refused = 0;    ///< messages: another frame, type or length than the scene needs
  std::string first_refusal;    ///< one line
  std::uint64_t rejected = 0;   ///< poses that are none (checkAndNormalise); handed on, the engine drops them
  std::uint64_t unstamped = 0;  ///< poses and joint positions whose stamp is 0; of one stamp the first stands
  std::uint64_t twistless = 0;  ///< poses without the twist that their object's motion is made from
};

/// Takes raw messages by topic and hands poses to the engine. One caller at a time.
///
/// Poses in world_frame go straight on. What else drives an object becomes edges of one frame tree: /tf,
/// poses in another frame (an edge from there to the object), joint positions (an edge from the part before
/// the joint to the part behind it). Of an object in no watched pair nothing is heard, unless parts that are
/// hang on it: then its poses only carry these.
class PoseRouter {
 public:
  using Sink = TfTree::Sink;
  /// Topic as the scene has it -> name in the ROS graph or bag.
  using ResolveTopic = std::function<std::string(const std::string& topic)>;

  /// Throws PoseError for a topic that is read otherwise (/tf).
  PoseRouter(std::shared_ptr<const scene::Scene> scene, const ResolveTopic& resolve, Sink sink);
  PoseRouter(const PoseRouter&) = delete;
  PoseRouter& operator=(const PoseRouter&) = delete;

  /// Every topic to listen to, in byte order; /tf and /tf_static among them when something is driven by tf.
  /// These two may join later, with the first message in a frame that is not world_frame.
  const std::vector<std::string>& topics() const { return topics_; }
  bool usesTf() const { return uses_tf_; }

  /// Throws PoseError, with topic and type, when messages of this type cannot be used on `topic`, or when the
  /// topic had another type before.
  void checkType(const std::string& topic, const std::string& datatype, const std::string& md5sum);
  /// Learns from a topic's first message in which frame its poses come; says nothing of what is wrong with
  /// it.
  void learnFrame(const std::string& topic, const RawMessage& message);

  /// Topic of an object that is driven by one and heard, as resolved; "" for others.
  const std::string& topicOf(int object) const { return topic_of_[static_cast<std::size_t>(object)]; }

  /// Hands every pose in the message to the sink. `received_ns`: for types that have no stamp. Throws
  /// PoseError with topic and object after all that can be used has been used, and counts the message as
  /// refused.
  void handle(const std::string& topic, const RawMessage& message, motion::Nanoseconds received_ns);

  /// The end: hands out what still waits for more. More may follow.
  void flush();
  /// /clock went back. To be called before the engine is told.
  void clockWentBack();
  /// The engine is about to forget all poses: hands out what waits, and takes nothing for sent again.
  void reset();

  const TfTree& tf() const { return tf_; }
  /// All that the poses it hands out later depend on.
  void describe(scene::Fingerprint& to) const;

  /// By topic; topics without a fault are absent.
  const std::map<std::string, TopicFaults>& faults() const { return faults_; }
  /// Refused messages on all topics.
  std::uint64_t refused() const;
  /// Adds to what the engine counted what never came to it: refused messages, and what was dropped of chains
  /// and paths.
  void count(scene::Stats& stats) const;
  /// One line for each joint that is waited for.
  std::vector<std::string> missingJoints() const;

 private:
  struct Target {  // of the poses on a topic
    int object = -1;
    std::string name;
    scene::PoseSource source;
    std::string child;                 // its frame in the tree
    bool has_parts = false;            // joints hang on it
    std::optional<std::string> frame;  // of its first message
    PathMemory paths;
  };
  struct TopicType {
    std::string datatype, md5sum;
  };

  bool isWatched(int object) const {
    return needs_[static_cast<std::size_t>(object)] == scene::Need::kWatched;
  }
  void followTopic(int index, const ResolveTopic& resolve);
  void followJoints(int index, const ResolveTopic& resolve);
  void ignoreJoints(int index, const ResolveTopic& resolve);
  bool hasParts(int index) const;
  void checkTopic(const std::string& topic, const std::string& name) const;
  void checkTypeFor(const std::string& topic, const std::string& datatype, const std::string& md5sum) const;
  void addTopic(const std::string& topic);
  void useTf();
  void lookAtStamp(const std::string& topic, const motion::StampedPose& pose, StampKind kind);
  void deliver(const std::string& topic, int object, const motion::StampedPose& pose, StampKind kind);
  void takeFrame(const std::string& topic, Target& target, const PoseReading& reading);
  void take(const std::string& topic, Target& target, const PoseReading& reading);
  void handleJoints(const std::string& topic, const RawMessage& message);
  void handlePoses(const std::string& topic, const RawMessage& message, motion::Nanoseconds received_ns);
  void handleTf(const std::string& topic, const RawMessage& message);

  std::shared_ptr<const scene::Scene> scene_;
  std::vector<scene::Need> needs_;  // by object
  std::string world_frame_;
  Sink sink_;
  TfTree tf_;
  bool uses_tf_ = false;
  std::vector<std::string> topics_;
  std::vector<std::string> topic_of_;  // by object
  std::map<std::string, TopicFaults> faults_;
  std::uint64_t rejected_parents_ = 0;  // poses that only carry parts, and are bad
  std::map<std::string, TopicType> types_;
  std::map<std::string, std::vector<Target>> targets_;  // by topic
  std::map<std::string, JointEdges> joints_;            // by topic
};

/// What a router's sink does with a pose: hands it to the engine as what it is.
void handToEngine(scene::Engine& engine, int object, const motion::StampedPose& pose, StampKind kind);

}  // namespace collision_node::messages

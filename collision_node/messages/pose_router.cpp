#include "collision_node/messages/pose_router.h"

#include <tf2_msgs/TFMessage.h>

#include <algorithm>
#include <utility>

#include "collision_node/messages/convert.h"
#include "collision_node/messages/deserialise.h"

namespace collision_node::messages {

namespace {

const char* const kTf = "/tf";
const char* const kTfStatic = "/tf_static";

bool isTf(const std::string& topic) { return topic == kTf || topic == kTfStatic; }

/// The name in the frame tree of an object's own poses.
std::string poseFrame(const std::string& object) { return "the pose of object '" + object + "'"; }

}  // namespace

PoseRouter::PoseRouter(std::shared_ptr<const scene::Scene> scene, const ResolveTopic& resolve, Sink sink)
    : scene_(std::move(scene)),
      needs_(scene::needsOf(*scene_)),
      world_frame_(withoutSlash(scene_->world_frame)),
      sink_(std::move(sink)),
      tf_(world_frame_, scene_->time,
          [this](int object, const motion::StampedPose& pose, StampKind kind) {
            const std::string& topic = topicOf(object);
            deliver(topic.empty() ? kTf : topic, object, pose, kind);
          }),
      topic_of_(scene_->objects.size()) {
  for (std::size_t i = 0; i < scene_->objects.size(); ++i) {
    const scene::PoseSource& source = scene_->objects[i].source;
    const int index = static_cast<int>(i);
    if (!source.topic.empty()) checkTopic(resolve(source.topic), scene_->objects[i].name);
    if (needs_[i] == scene::Need::kNone) continue;
    switch (source.type) {
      case scene::PoseSource::Type::kFixed:
        break;
      case scene::PoseSource::Type::kTf:
        useTf();
        if (isWatched(index)) tf_.follow(index, withoutSlash(source.tf_frame));
        break;
      case scene::PoseSource::Type::kTopic:
        followTopic(index, resolve);
        break;
      case scene::PoseSource::Type::kJoints:
        followJoints(index, resolve);
        break;
    }
  }
  for (std::size_t i = 0; i < needs_.size(); ++i)
    if (needs_[i] == scene::Need::kNone) ignoreJoints(static_cast<int>(i), resolve);
}

void PoseRouter::followTopic(int index, const ResolveTopic& resolve) {
  const scene::Object& object = scene_->objects[static_cast<std::size_t>(index)];
  const std::string topic = resolve(object.source.topic);
  targets_[topic].push_back(
      {index,
       object.name,
       object.source,
       poseFrame(object.name),
       hasParts(index),
       {},
       PathMemory(scene::toNanoseconds(scene_->time.reorder), scene::toNanoseconds(scene_->time.jump))});
  topic_of_[static_cast<std::size_t>(index)] = topic;
  addTopic(topic);
}

/// The first part stands in front of the others, which hang on its frame.
void PoseRouter::followJoints(int index, const ResolveTopic& resolve) {
  const scene::Object& object = scene_->objects[static_cast<std::size_t>(index)];
  const scene::PoseSource& root =
      std::find_if(scene_->objects.begin(), scene_->objects.end(), [&](const scene::Object& other) {
        return other.name == object.name;
      })->source;
  const std::string topic = resolve(object.source.topic);
  topic_of_[static_cast<std::size_t>(index)] = topic;
  addTopic(topic);

  std::string parent =
      root.type == scene::PoseSource::Type::kTf ? withoutSlash(root.tf_frame) : poseFrame(object.name);
  const std::string first = parent;
  std::vector<JointEdges::Edge> edges;
  for (const scene::PartJoint& joint : object.source.joints) {
    const std::string child = "joint '" + joint.joint.name + "' of object '" + object.name + "'";
    edges.push_back({object.name, parent, child, joint});
    parent = child;
  }
  tf_.follow(index, parent, object.label());
  for (JointEdges::Edge& edge : edges) {
    tf_.announce(edge.parent, edge.child);
    joints_[topic].add(std::move(edge));
  }
  motion::StampedPose fixed;
  fixed.pose = root.fixed;
  if (root.type == scene::PoseSource::Type::kFixed) tf_.add(world_frame_, first, fixed, StampKind::kAlways);
}

/// The joints that only move what is in no pair are no strangers on a topic that is heard for others.
void PoseRouter::ignoreJoints(int index, const ResolveTopic& resolve) {
  const scene::PoseSource& source = scene_->objects[static_cast<std::size_t>(index)].source;
  if (source.type != scene::PoseSource::Type::kJoints) return;
  const auto heard = joints_.find(resolve(source.topic));
  if (heard == joints_.end()) return;
  for (const scene::PartJoint& joint : source.joints) heard->second.ignore(joint.joint.driver);
}

bool PoseRouter::hasParts(int index) const {
  const std::vector<scene::Object>& objects = scene_->objects;
  const std::string& name = objects[static_cast<std::size_t>(index)].name;
  for (auto i = static_cast<std::size_t>(index) + 1; i < objects.size() && objects[i].name == name; ++i)
    if (isWatched(static_cast<int>(i))) return true;
  return false;
}

void PoseRouter::checkTopic(const std::string& topic, const std::string& name) const {
  if (isTf(topic)) throw PoseError("object '" + name + "': topic " + topic + " is read by pose: {tf: frame}");
}

void PoseRouter::addTopic(const std::string& topic) {
  const auto place = std::lower_bound(topics_.begin(), topics_.end(), topic);
  if (place == topics_.end() || *place != topic) topics_.insert(place, topic);
}

void PoseRouter::useTf() {
  uses_tf_ = true;
  addTopic(kTf);
  addTopic(kTfStatic);
}

void PoseRouter::checkType(const std::string& topic, const std::string& datatype, const std::string& md5sum) {
  if (isTf(topic)) {
    // tf/tfMessage and tf2_msgs/TFMessage are the same bytes.
    if (md5sum != ros::message_traits::md5sum<tf2_msgs::TFMessage>())
      throw PoseError("topic " + topic + ": type " + datatype + " is not tf2_msgs/TFMessage");
    return;
  }
  checkTypeFor(topic, datatype, md5sum);
  if (targets_.count(topic) == 0 && joints_.count(topic) == 0) return;
  const TopicType& first = types_.emplace(topic, TopicType{datatype, md5sum}).first->second;
  if (first.datatype != datatype)
    throw PoseError("topic " + topic + ": its type was " + first.datatype + " and is now " + datatype +
                    "; the first stands");
}

void PoseRouter::checkTypeFor(const std::string& topic, const std::string& datatype,
                              const std::string& md5sum) const {
  std::string reader;
  try {
    if (const auto found = targets_.find(topic); found != targets_.end()) {
      for (const Target& target : found->second) {
        reader = "object '" + target.name + "'";
        checkPoseType(datatype, md5sum, target.source);
      }
    }
    reader = "joints";
    if (joints_.count(topic) != 0) checkJointType(datatype, md5sum);
  } catch (const PoseError& error) {
    throw PoseError("topic " + topic + " (" + reader + "): " + error.what());
  }
}

void PoseRouter::count(scene::Stats& stats) const {
  stats.rejected += refused() + rejected_parents_;
  const scene::InputCounts chains = tf_.dropped();
  stats.late += chains.late;
  stats.duplicate += chains.duplicate;
  for (const auto& entry : targets_) {
    for (const Target& target : entry.second) {
      stats.late += target.paths.late();
      stats.duplicate += target.paths.duplicates();
    }
  }
}

std::vector<std::string> PoseRouter::missingJoints() const {
  std::vector<std::string> out;
  for (const auto& [topic, edges] : joints_)
    for (const std::string& line : edges.missing()) out.push_back(line + ", on " + topic);
  return out;
}

std::uint64_t PoseRouter::refused() const {
  std::uint64_t sum = 0;
  for (const auto& entry : faults_) sum += entry.second.refused;
  return sum;
}

void PoseRouter::deliver(const std::string& topic, int object, const motion::StampedPose& pose,
                         StampKind kind) {
  motion::StampedPose checked = pose;
  const bool is_bad = motion::checkAndNormalise(checked) != motion::PoseFault::kNone;
  if (is_bad) ++faults_[topic].rejected;
  if (!isWatched(object)) {
    if (is_bad) ++rejected_parents_;
    return;
  }
  const bool is_slerp =
      scene_->objects[static_cast<std::size_t>(object)].motion == scene::MotionModel::kSlerp;
  if (!is_slerp && !pose.has_twist && kind != StampKind::kAlways) ++faults_[topic].twistless;
  sink_(object, pose, kind);
}

/// A publisher that leaves header.stamp empty sends one instant over and over.
void PoseRouter::lookAtStamp(const std::string& topic, const motion::StampedPose& pose, StampKind kind) {
  if (kind == StampKind::kSent && pose.stamp_ns == 0) ++faults_[topic].unstamped;
}

void PoseRouter::flush() { tf_.flush(); }

void PoseRouter::clockWentBack() {
  tf_.clockWentBack();
  for (auto& entry : targets_)
    for (Target& target : entry.second) target.paths.forget();
}

void PoseRouter::describe(scene::Fingerprint& to) const {
  tf_.describe(to);
  for (const auto& entry : targets_)
    for (const Target& target : entry.second) target.paths.describe(to);
}

void PoseRouter::reset() {
  flush();
  for (auto& entry : targets_)
    for (Target& target : entry.second) target.paths.forget();
}

void PoseRouter::handle(const std::string& topic, const RawMessage& message,
                        motion::Nanoseconds received_ns) {
  try {
    if (isTf(topic)) {
      handleTf(topic, message);
    } else {
      checkType(topic, message.datatype, message.md5sum);
      if (joints_.count(topic) != 0) handleJoints(topic, message);
      handlePoses(topic, message, received_ns);
    }
  } catch (const PoseError& error) {
    TopicFaults& faults = faults_[topic];
    if (faults.refused++ == 0) faults.first_refusal = error.what();
    throw;
  }
}

void PoseRouter::learnFrame(const std::string& topic, const RawMessage& message) {
  const auto found = targets_.find(topic);
  if (found == targets_.end()) return;
  for (Target& target : found->second) {
    try {
      if (message.datatype != kPath)
        takeFrame(topic, target, readPose(message, target.source, 0));
      else if (const auto path = readPath(message); !path.empty())
        takeFrame(topic, target, path.front());
    } catch (const std::runtime_error&) {  // PoseError, TfError
      // It is refused, and told, when it is handled.
    }
  }
}

/// The frame of the first message stands. Another one than world_frame makes the object hang on tf; an object
/// on which joints hang is in the tree whatever its frame.
void PoseRouter::takeFrame(const std::string& topic, Target& target, const PoseReading& reading) {
  const std::string& frame = reading.in_world ? world_frame_ : reading.frame;
  if (frame.empty())
    throw PoseError("header.frame_id is empty; it must name a frame, such as the scene's world_frame '" +
                    world_frame_ + "'");
  if (target.frame && *target.frame != frame)
    throw PoseError("header.frame_id is '" + frame + "' and was '" + *target.frame + "'; the first stands");
  if (target.frame) return;
  target.frame = frame;
  if (frame == world_frame_ && !target.has_parts) return;
  if (frame != world_frame_) useTf();
  if (isWatched(target.object)) tf_.follow(target.object, target.child, frame + ", of topic " + topic);
  tf_.announce(frame, target.child);
}

void PoseRouter::handlePoses(const std::string& topic, const RawMessage& message,
                             motion::Nanoseconds received_ns) {
  const auto found = targets_.find(topic);
  if (found == targets_.end()) return;
  std::string fault;
  for (Target& target : found->second) {
    try {
      if (message.datatype != kPath) {
        take(topic, target, readPose(message, target.source, received_ns));
        continue;
      }
      const std::vector<PoseReading> path = readPath(message);
      if (!path.empty()) takeFrame(topic, target, path.front());
      for (const PoseReading& reading : target.paths.news(path)) take(topic, target, reading);
    } catch (const std::runtime_error& error) {  // PoseError, TfError
      if (fault.empty()) fault = "topic " + topic + " (object '" + target.name + "'): " + error.what();
    }
  }
  if (!fault.empty()) throw PoseError(fault);
}

void PoseRouter::take(const std::string& topic, Target& target, const PoseReading& reading) {
  takeFrame(topic, target, reading);
  lookAtStamp(topic, reading.pose, reading.kind);
  motion::StampedPose checked = reading.pose;
  // What hangs on a bad pose would be counted as bad, too.
  const bool is_bad = target.has_parts && motion::checkAndNormalise(checked) != motion::PoseFault::kNone;
  if ((*target.frame == world_frame_ && !target.has_parts) || is_bad)
    deliver(topic, target.object, reading.pose, reading.kind);
  else
    tf_.add(*target.frame, target.child, reading.pose, reading.kind);
}

void PoseRouter::handleJoints(const std::string& topic, const RawMessage& message) {
  try {
    joints_.at(topic).take(readJointStates(message),
                           [&](const JointEdges::Edge& edge, const motion::StampedPose& pose) {
                             lookAtStamp(topic, pose, StampKind::kSent);
                             tf_.add(edge.parent, edge.child, pose, StampKind::kSent);
                           });
  } catch (const std::runtime_error& error) {  // PoseError, TfError
    throw PoseError("topic " + topic + " (joints): " + error.what());
  }
}

void PoseRouter::handleTf(const std::string& topic, const RawMessage& message) {
  checkType(topic, message.datatype, message.md5sum);
  checkArray(message, 0, ros::serialization::serializationLength(geometry_msgs::TransformStamped()));
  const auto transforms = deserialise<tf2_msgs::TFMessage>(message);
  std::string fault;
  for (const auto& transform : transforms.transforms) {
    const auto& t = transform.transform.translation;
    const auto& q = transform.transform.rotation;
    motion::StampedPose pose;
    pose.stamp_ns = toNanoseconds(transform.header.stamp);
    pose.pose = {Vec3(t.x, t.y, t.z), Quat(q.w, q.x, q.y, q.z)};
    const StampKind kind = topic == kTfStatic ? StampKind::kAlways : StampKind::kSent;
    lookAtStamp(topic, pose, kind);
    try {
      tf_.add(withoutSlash(transform.header.frame_id), withoutSlash(transform.child_frame_id), pose, kind);
    } catch (const TfError& error) {
      if (fault.empty()) fault = "topic " + topic + ": " + error.what();
    }
  }
  if (!fault.empty()) throw PoseError(fault);
}

void handToEngine(scene::Engine& engine, int object, const motion::StampedPose& pose, StampKind kind) {
  if (kind == StampKind::kAlways)
    engine.fix(object, pose.pose);
  else
    engine.addPose(object, pose, kind == StampKind::kGuessed);
}

}  // namespace collision_node::messages

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

}  // namespace

PoseRouter::PoseRouter(std::shared_ptr<const scene::Scene> scene, const ResolveTopic& resolve, Sink sink)
    : scene_(std::move(scene)),
      world_frame_(withoutSlash(scene_->world_frame)),
      sink_(std::move(sink)),
      tf_(world_frame_, scene_->time,
          [this](int object, const motion::StampedPose& pose, StampKind kind) {
            const std::string& topic = topicOf(object);
            deliver(topic.empty() ? kTf : topic, object, pose, kind);
          }),
      topic_of_(scene_->objects.size()) {
  for (std::size_t i = 0; i < scene_->objects.size(); ++i) {
    const scene::Object& object = scene_->objects[i];
    const int index = static_cast<int>(i);
    switch (object.source.type) {
      case scene::PoseSource::Type::kFixed:
        break;
      case scene::PoseSource::Type::kTf:
        useTf();
        tf_.follow(index, withoutSlash(object.source.tf_frame));
        break;
      case scene::PoseSource::Type::kTopic: {
        Target target;
        target.object = index;
        target.name = object.name;
        target.source = object.source;
        target.child = "the pose of object '" + object.name + "'";
        const std::string topic = resolve(object.source.topic);
        topic_of_[i] = topic;
        listen(topic, std::move(target));
        break;
      }
    }
  }
}

void PoseRouter::listen(const std::string& topic, Target target) {
  if (isTf(topic))
    throw PoseError("object '" + target.name + "': topic " + topic + " is read by pose: {tf: frame}");
  targets_[topic].push_back(std::move(target));
  addTopic(topic);
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
  const auto found = targets_.find(topic);
  if (found == targets_.end()) return;
  for (const Target& target : found->second) {
    try {
      checkPoseType(datatype, md5sum, target.source);
    } catch (const PoseError& error) {
      throw PoseError("topic " + topic + " (object '" + target.name + "'): " + error.what());
    }
  }
  const TopicType& first = types_.emplace(topic, TopicType{datatype, md5sum}).first->second;
  if (first.datatype != datatype)
    throw PoseError("topic " + topic + ": its type was " + first.datatype + " and is now " + datatype +
                    "; the first stands");
}

std::uint64_t PoseRouter::refused() const {
  std::uint64_t sum = 0;
  for (const auto& entry : faults_) sum += entry.second.refused;
  return sum;
}

void PoseRouter::deliver(const std::string& topic, int object, const motion::StampedPose& pose,
                         StampKind kind) {
  motion::StampedPose checked = pose;
  if (motion::checkAndNormalise(checked) != motion::PoseFault::kNone) ++faults_[topic].rejected;
  sink_(object, pose, kind);
}

void PoseRouter::flush() { tf_.flush(); }

void PoseRouter::clockWentBack() { tf_.clockWentBack(); }

void PoseRouter::handle(const std::string& topic, const RawMessage& message,
                        motion::Nanoseconds received_ns) {
  try {
    if (isTf(topic))
      handleTf(topic, message);
    else
      handlePoses(topic, message, received_ns);
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
      takeFrame(topic, target, readPose(message, target.source, 0));
    } catch (const std::runtime_error&) {  // PoseError, TfError
      // It is refused, and told, when it is handled.
    }
  }
}

/// The frame of the first message stands. Another one than world_frame makes the object hang on tf.
void PoseRouter::takeFrame(const std::string& topic, Target& target, const PoseReading& reading) {
  const std::string& frame = reading.in_world ? world_frame_ : reading.frame;
  if (frame.empty())
    throw PoseError("header.frame_id is empty; it must name a frame, such as the scene's world_frame '" +
                    world_frame_ + "'");
  if (target.frame && *target.frame != frame)
    throw PoseError("header.frame_id is '" + frame + "' and was '" + *target.frame + "'; the first stands");
  if (target.frame) return;
  target.frame = frame;
  if (frame == world_frame_) return;
  useTf();
  tf_.follow(target.object, target.child, frame + ", of topic " + topic);
  tf_.announce(frame, target.child);
}

void PoseRouter::handlePoses(const std::string& topic, const RawMessage& message,
                             motion::Nanoseconds received_ns) {
  const auto found = targets_.find(topic);
  if (found == targets_.end()) return;
  checkType(topic, message.datatype, message.md5sum);
  std::string fault;
  for (Target& target : found->second) {
    try {
      const PoseReading reading = readPose(message, target.source, received_ns);
      takeFrame(topic, target, reading);
      if (*target.frame == world_frame_)
        deliver(topic, target.object, reading.pose, reading.kind);
      else
        tf_.add(*target.frame, target.child, reading.pose, reading.kind);
    } catch (const std::runtime_error& error) {  // PoseError, TfError
      if (fault.empty()) fault = "topic " + topic + " (object '" + target.name + "'): " + error.what();
    }
  }
  if (!fault.empty()) throw PoseError(fault);
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
    try {
      tf_.add(withoutSlash(transform.header.frame_id), withoutSlash(transform.child_frame_id), pose,
              topic == kTfStatic ? StampKind::kAlways : StampKind::kSent);
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

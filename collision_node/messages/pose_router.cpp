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
      sink_(std::move(sink)),
      tf_(withoutSlash(scene_->world_frame),
          [this](int object, const motion::StampedPose& pose) { deliver(kTf, object, pose); }),
      topic_of_(scene_->objects.size()) {
  for (std::size_t i = 0; i < scene_->objects.size(); ++i) {
    const scene::Object& object = scene_->objects[i];
    const int index = static_cast<int>(i);
    if (object.links_move)
      throw PoseError("object '" + object.name +
                      "': links: true is not available yet; list the links as objects");
    switch (object.source.type) {
      case scene::PoseSource::Type::kFixed:
        break;
      case scene::PoseSource::Type::kTf:
        uses_tf_ = true;
        tf_.follow(index, withoutSlash(object.source.tf_frame));
        break;
      case scene::PoseSource::Type::kTopic: {
        if (!object.source.model.empty() || !object.source.link.empty())
          throw PoseError("object '" + object.name +
                          "': gazebo states (model, link) are not available yet; topic " +
                          object.source.topic);
        const std::string topic = resolve(object.source.topic);
        if (isTf(topic))
          throw PoseError("object '" + object.name + "': topic " + topic + " is read by pose: {tf: frame}");
        objects_of_[topic].push_back(index);
        topic_of_[i] = topic;
        break;
      }
    }
  }
  for (const auto& entry : objects_of_) topics_.push_back(entry.first);
  if (uses_tf_) {
    topics_.push_back(kTf);
    topics_.push_back(kTfStatic);
    std::sort(topics_.begin(), topics_.end());
  }
}

void PoseRouter::checkType(const std::string& topic, const std::string& datatype,
                           const std::string& md5sum) const {
  if (isTf(topic)) {
    // tf/tfMessage and tf2_msgs/TFMessage are the same bytes.
    if (md5sum != ros::message_traits::md5sum<tf2_msgs::TFMessage>())
      throw PoseError("topic " + topic + ": type " + datatype + " is not tf2_msgs/TFMessage");
    return;
  }
  const auto found = objects_of_.find(topic);
  if (found == objects_of_.end()) return;
  for (const int index : found->second) {
    const scene::Object& object = scene_->objects[static_cast<std::size_t>(index)];
    try {
      checkPoseType(datatype, md5sum, object.source);
    } catch (const PoseError& error) {
      throw PoseError("topic " + topic + " (object '" + object.name + "'): " + error.what());
    }
  }
}

std::uint64_t PoseRouter::refused() const {
  std::uint64_t sum = 0;
  for (const auto& entry : faults_) sum += entry.second.refused;
  return sum;
}

void PoseRouter::deliver(const std::string& topic, int object, const motion::StampedPose& pose) {
  motion::StampedPose checked = pose;
  if (motion::checkAndNormalise(checked) != motion::PoseFault::kNone) ++faults_[topic].rejected;
  sink_(object, pose);
}

void PoseRouter::handle(const std::string& topic, const RawMessage& message) {
  try {
    if (isTf(topic))
      handleTf(topic, message);
    else
      handlePoses(topic, message);
  } catch (const PoseError& error) {
    TopicFaults& faults = faults_[topic];
    if (faults.refused++ == 0) faults.first_refusal = error.what();
    throw;
  }
}

void PoseRouter::handlePoses(const std::string& topic, const RawMessage& message) {
  const auto found = objects_of_.find(topic);
  if (found == objects_of_.end()) return;
  std::string fault;
  for (const int index : found->second) {
    const scene::Object& object = scene_->objects[static_cast<std::size_t>(index)];
    try {
      deliver(topic, index, readPose(message, object.source, scene_->world_frame));
    } catch (const PoseError& error) {
      if (fault.empty()) fault = "topic " + topic + " (object '" + object.name + "'): " + error.what();
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
    const Pose pose{Vec3(t.x, t.y, t.z), Quat(q.w, q.x, q.y, q.z)};
    try {
      tf_.add(withoutSlash(transform.header.frame_id), withoutSlash(transform.child_frame_id),
              toNanoseconds(transform.header.stamp), pose, topic == kTfStatic);
    } catch (const TfError& error) {
      if (fault.empty()) fault = "topic " + topic + ": " + error.what();
    }
  }
  if (!fault.empty()) throw PoseError(fault);
}

}  // namespace collision_node::messages

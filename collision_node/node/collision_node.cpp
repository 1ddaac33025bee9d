#include "collision_node/node/collision_node.h"

#include <ros/console.h>
#include <std_msgs/String.h>

#include <utility>

#include "collision_node/messages/convert.h"
#include "collision_node/messages/event_text.h"
#include "collision_node/messages/resources.h"
#include "collision_node/node/diagnostics.h"
#include "collision_node/scene/needs.h"

namespace collision_node::node {

namespace {

constexpr std::uint32_t kUnlimited = 0;
constexpr double kDiagnosticsPeriod = 1.0;  // [s] of wall time: a paused simulation must not look dead

ros::NodeHandle on(ros::CallbackQueue& queue, ros::NodeHandle handle) {
  handle.setCallbackQueue(&queue);
  return handle;
}

}  // namespace

CollisionNode::CollisionNode(const ros::NodeHandle& handle, const ros::NodeHandle& private_handle)
    : handle_(on(queue_, handle)), private_handle_(on(queue_, private_handle)) {
  const Parameters parameters = readParameters(private_handle_);
  const auto scene = load(parameters);

  // An event that a full queue drops is a lie by silence: no limit.
  impacts_ = private_handle_.advertise<Impact>("impacts", kUnlimited);
  stats_ = private_handle_.advertise<IntervalStats>("stats", 1000);
  markers_out_ = private_handle_.advertise<visualization_msgs::MarkerArray>(
      "markers", 1000, [this](const ros::SingleSubscriberPublisher&) { onMarkerSubscriber(); });
  plan_ = private_handle_.advertise<std_msgs::String>("plan", 1, true);
  diagnostics_ = handle_.advertise<diagnostic_msgs::DiagnosticArray>("/diagnostics", 10);

  start(parameters, scene);
  services_.push_back(private_handle_.advertiseService("reset", &CollisionNode::onReset, this));
  services_.push_back(private_handle_.advertiseService("flush", &CollisionNode::onFlush, this));
  services_.push_back(private_handle_.advertiseService("reload_scene", &CollisionNode::onReload, this));
  diagnostics_timer_ = private_handle_.createWallTimer(ros::WallDuration(kDiagnosticsPeriod),
                                                       &CollisionNode::onDiagnosticsTimer, this);
  spinner_ = std::make_unique<ros::AsyncSpinner>(1, &queue_);
  spinner_->start();
}

CollisionNode::~CollisionNode() {
  if (spinner_) spinner_->stop();
  // What has arrived but was not looked at yet belongs to the past that shutdown decides.
  queue_.callAvailable();
  subscribers_.clear();
  if (engine_) flush();
}

void CollisionNode::flush() {
  router_->flush();
  engine_->flush();
}

std::shared_ptr<const scene::Scene> CollisionNode::load(const Parameters& parameters) const {
  for (const auto& warning : parameters.warnings) ROS_WARN_STREAM(warning);
  const ros::NodeHandle handle = handle_;
  auto scene = scene::loadScene(
      parameters.scene,
      messages::makeResources(parameters.scene,
                              [handle](const std::string& name) {
                                std::string value;
                                if (!handle.getParam(name, value))
                                  throw std::runtime_error("parameter '" + handle.resolveName(name) +
                                                           "' is not set to a text");
                                return value;
                              }),
      parameters.overrides);
  for (const auto& warning : scene->warnings) ROS_WARN_STREAM(parameters.scene << ": " << warning);
  for (const auto& change : parameters.overrides)
    ROS_INFO_STREAM("~override/" << change.first << ": " << change.second);
  return scene;
}

void CollisionNode::start(const Parameters& parameters, std::shared_ptr<const scene::Scene> scene) {
  scene::Engine::Sinks sinks;
  sinks.event = [this](const scene::Event& event) { onEvent(event); };
  sinks.stats = [this](const scene::Stats& stats) { onStats(stats); };
  // All three are built before any is replaced: a scene that one of them refuses leaves the old one at work.
  auto router = std::make_unique<messages::PoseRouter>(
      scene, [this](const std::string& topic) { return handle_.resolveName(topic); },
      [this](int object, const motion::StampedPose& pose, messages::StampKind kind) {
        messages::handToEngine(*engine_, object, pose, kind);
      });
  auto engine = std::make_unique<scene::Engine>(scene, parameters.method, sinks,
                                                scene::EngineOptions{parameters.everything, 1});
  auto markers = std::make_unique<messages::Markers>(scene, parameters.markers);

  subscribers_.clear();
  subscribed_.clear();
  scene_ = std::move(scene);
  router_ = std::move(router);
  engine_ = std::move(engine);
  markers_ = std::move(markers);
  queue_size_ = parameters.queue;
  last_heartbeat_ = std::chrono::steady_clock::now();
  std_msgs::String plan;
  plan.data = scene::planText(*scene_);
  plan_.publish(plan);
  for (const std::string& line : scene::leftOut(*scene_)) ROS_INFO_STREAM("left out: " << line);
  subscribe();
}

void CollisionNode::subscribe() {
  for (const auto& topic : router_->topics()) {
    if (!subscribed_.insert(topic).second) continue;
    ros::SubscribeOptions options;
    options.initByFullCallbackType<const ros::MessageEvent<Raw const>&>(
        topic, queue_size_,
        [this, topic](const ros::MessageEvent<Raw const>& event) { onMessage(topic, event); });
    options.transport_hints = ros::TransportHints().tcpNoDelay();
    subscribers_.push_back(handle_.subscribe(options));
  }
}

void CollisionNode::onMessage(const std::string& topic, const ros::MessageEvent<Raw const>& event) {
  watchClock();
  ++messages_;
  const Raw& shifter = *event.getConstMessage();
  bytes_.resize(shifter.size());
  ros::serialization::OStream stream(bytes_.data(), static_cast<std::uint32_t>(bytes_.size()));
  shifter.write(stream);
  messages::RawMessage raw;
  raw.datatype = shifter.getDataType();
  raw.md5sum = shifter.getMD5Sum();
  raw.data = bytes_.data();
  raw.size = static_cast<std::uint32_t>(bytes_.size());
  gaps_.see(topic, event.getPublisherName(), raw);
  try {
    router_->handle(topic, raw, messages::toNanoseconds(event.getReceiptTime()));
  } catch (const messages::PoseError& error) {
    ROS_ERROR_STREAM_THROTTLE(5.0, error.what());  // counted by the router
  }
  subscribe();  // poses in another frame ask for tf
}

void CollisionNode::watchClock() {
  if (!ros::Time::isSimTime()) return;
  const ros::Time now = ros::Time::now();
  const bool went_back = now < last_clock_;
  last_clock_ = now;
  if (!went_back) return;
  router_->clockWentBack();
  engine_->clockWentBack();
}

void CollisionNode::onEvent(scene::Event event) {
  event.epoch += first_epoch_;
  epoch_ = event.epoch;
  ++events_;
  impacts_.publish(messages::toMessage(event, scene_->world_frame));
  if (markers_out_.getNumSubscribers() > 0) markers_out_.publish(markers_->event(event));
}

scene::Stats CollisionNode::withMessages(scene::Stats stats) const {
  router_->count(stats);
  stats.lost = gaps_.lost();
  return stats;
}

void CollisionNode::onStats(scene::Stats stats) {
  stats = withMessages(std::move(stats));
  stats.epoch += first_epoch_;
  epoch_ = stats.epoch;
  const auto now = std::chrono::steady_clock::now();
  stats.wall_time = std::chrono::duration<double>(now - last_heartbeat_).count();
  last_heartbeat_ = now;
  stats_.publish(messages::toMessage(stats, scene_->world_frame));
}

void CollisionNode::onMarkerSubscriber() {
  const scene::Stats stats = engine_->stats();
  markers_out_.publish(markers_->start(messages::toTime(stats.has_watermark ? stats.watermark_ns : 0)));
}

void CollisionNode::onDiagnosticsTimer(const ros::WallTimerEvent&) {
  if (diagnostics_.getNumSubscribers() == 0) return;
  Health health;
  health.name = private_handle_.getNamespace();  // of the nodelet, not of its manager
  health.scene = scene_->file;
  health.has_pairs = scene_->pairs.count(scene_->objects) > 0;
  health.epoch = epoch_;
  health.messages = messages_;
  health.events = events_;
  health.stats = withMessages(engine_->stats());
  health.faults = router_->faults();
  health.lost = gaps_.lostByTopic();
  for (const auto& frame : router_->tf().unresolved())
    health.unconnected.push_back("'" + frame + "' to world_frame '" + scene_->world_frame + "'");
  health.missing_joints = router_->missingJoints();
  for (const auto& subscriber : subscribers_)
    if (subscriber.getTopic() != "/tf_static" && subscriber.getNumPublishers() == 0)
      health.without_publisher.push_back(subscriber.getTopic());

  diagnostic_msgs::DiagnosticArray array;
  array.header.stamp = ros::Time::now();
  array.status.push_back(diagnose(health));
  diagnostics_.publish(array);
}

bool CollisionNode::onFlush(Trigger::Request&, Trigger::Response& response) {
  flush();
  response.success = 1;
  response.message = std::to_string(events_) + " events";
  return true;
}

bool CollisionNode::onReset(Trigger::Request&, Trigger::Response& response) {
  router_->reset();
  engine_->reset();
  if (markers_out_.getNumSubscribers() > 0) onMarkerSubscriber();
  response.success = 1;
  response.message = "reset; " + std::to_string(events_) + " events so far";
  return true;
}

bool CollisionNode::onReload(Trigger::Request&, Trigger::Response& response) {
  try {
    const Parameters parameters = readParameters(private_handle_);
    const auto scene = load(parameters);
    router_->flush();
    engine_->reset();  // the new scene knows nothing of the contacts that are open: they end here
    const std::uint32_t last_epoch = epoch_;
    start(parameters, scene);
    first_epoch_ = epoch_ = last_epoch + 1;
    if (markers_out_.getNumSubscribers() > 0) onMarkerSubscriber();
    response.success = 1;
    response.message = "loaded " + scene->file;
  } catch (const std::runtime_error& error) {
    response.success = 0;
    response.message = error.what();
  } catch (const std::invalid_argument& error) {
    response.success = 0;
    response.message = error.what();
  }
  if (response.success == 0)
    ROS_ERROR_STREAM("scene not reloaded, the old one goes on: " << response.message);
  return true;
}

}  // namespace collision_node::node

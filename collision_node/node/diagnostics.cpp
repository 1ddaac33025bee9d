#include "collision_node/node/diagnostics.h"

#include "collision_node/messages/event_text.h"

namespace collision_node::node {

namespace {

using Status = diagnostic_msgs::DiagnosticStatus;

std::string list(const std::vector<std::string>& items) {
  std::string out;
  for (const auto& item : items) out += (out.empty() ? "" : ", ") + item;
  return out;
}

void judge(const Health& health, Status& status) {
  status.level = Status::OK;
  status.message = "watching";
  const auto raise = [&](std::uint8_t level, const std::string& message) {
    if (level <= status.level) return;
    status.level = level;
    status.message = message;
  };
  const scene::Stats& stats = health.stats;
  for (const auto& entry : health.faults)
    if (entry.second.refused > 0) raise(Status::ERROR, entry.second.first_refusal);
  const std::string silent =
      health.without_publisher.empty() ? "" : "nobody publishes " + list(health.without_publisher);
  if (!health.has_pairs) raise(Status::WARN, "no pair is watched: nothing can be reported");
  for (const auto& [topic, faults] : health.faults)
    if (faults.unstamped > 1)
      raise(Status::WARN, "no stamps on " + topic + ": header.stamp is 0 again and again");
  for (const auto& [topic, faults] : health.faults)
    if (faults.twistless > 0)
      raise(Status::WARN, "no twists on " + topic + ", from which motion: hermite and spin are made");
  if (stats.accepted == 0 && !stats.has_watermark)
    raise(Status::WARN, "no pose has arrived yet" + (silent.empty() ? "" : ": " + silent));
  if (!health.unconnected.empty()) raise(Status::WARN, "tf does not connect " + health.unconnected.front());
  if (!health.missing_joints.empty()) raise(Status::WARN, "no position of " + health.missing_joints.front());
  if (!stats.uncovered_objects.empty()) raise(Status::WARN, "no poses of " + stats.uncovered_objects.front());
  if (!silent.empty()) raise(Status::WARN, silent);
  if (stats.rejected > 0)
    raise(Status::WARN, "poses rejected: not finite, beyond 1e15 m, or no unit quaternion");
  if (stats.late > 0) raise(Status::WARN, "poses dropped: later than time.reorder allows");
  if (!health.lost.empty()) raise(Status::WARN, "messages lost on " + health.lost.begin()->first);
}

}  // namespace

Status diagnose(const Health& health) {
  Status status;
  status.name = health.name.substr(health.name.rfind('/', 0) == 0 ? 1 : 0) + ": impacts";
  status.hardware_id = "none";
  judge(health, status);

  const auto add = [&](const std::string& key, const std::string& value) {
    diagnostic_msgs::KeyValue out;
    out.key = key;
    out.value = value;
    status.values.push_back(out);
  };
  const scene::Stats& stats = health.stats;
  add("scene", health.scene);
  add("watermark", stats.has_watermark ? messages::secondsText(stats.watermark_ns) : "none yet");
  if (stats.has_watermark) add("latency", std::to_string(stats.latency) + " s");
  add("epoch", std::to_string(health.epoch));
  add("messages", std::to_string(health.messages));
  add("events", std::to_string(health.events));
  add("accepted", std::to_string(stats.accepted));
  add("reordered", std::to_string(stats.reordered));
  add("late", std::to_string(stats.late));
  add("duplicate", std::to_string(stats.duplicate));
  add("rejected", std::to_string(stats.rejected));
  add("lost", std::to_string(stats.lost));
  for (const auto& name : stats.uncovered_objects) add("uncovered", name);
  for (const auto& frames : health.unconnected) add("not connected", frames);
  for (const auto& joint : health.missing_joints) add("no position of", joint);
  for (const auto& topic : health.without_publisher) add("without publisher", topic);
  for (const auto& [topic, count] : health.lost) add("lost on " + topic, std::to_string(count));
  for (const auto& [topic, faults] : health.faults) {
    if (faults.refused > 0) add("refused on " + topic, std::to_string(faults.refused));
    if (faults.rejected > 0) add("rejected on " + topic, std::to_string(faults.rejected));
    if (faults.twistless > 0) add("no twist on " + topic, std::to_string(faults.twistless));
    if (faults.unstamped > 0) add("stamp 0 on " + topic, std::to_string(faults.unstamped));
  }
  return status;
}

}  // namespace collision_node::node

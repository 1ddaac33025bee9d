#include "collision_node/replay/outputs.h"

#include <std_msgs/String.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "collision_node/messages/convert.h"
#include "collision_node/messages/event_text.h"

namespace collision_node::replay {

namespace {

using messages::toMessage;

const char* const kImpacts = "/collision_node/impacts";
const char* const kMarkers = "/collision_node/markers";
const char* const kStats = "/collision_node/stats";
const char* const kPlan = "/collision_node/plan";

/// A bag keeps `latching` and `callerid` only of a connection header that is whole.
boost::shared_ptr<ros::M_string> headerOf(const Connection& connection) {
  auto header = boost::make_shared<ros::M_string>();
  (*header)["topic"] = connection.topic;
  (*header)["type"] = connection.datatype;
  (*header)["md5sum"] = connection.md5sum;
  (*header)["message_definition"] = connection.definition;
  if (!connection.sender.empty()) (*header)["callerid"] = connection.sender;
  if (connection.latched) (*header)["latching"] = "1";
  return header;
}

boost::shared_ptr<ros::M_string> planHeader() {
  namespace traits = ros::message_traits;
  return headerOf({kPlan, traits::datatype<std_msgs::String>(), traits::md5sum<std_msgs::String>(),
                   traits::definition<std_msgs::String>(), "/collision_node", true});
}

std::unique_ptr<PendingFile> pending(const std::string& name, const Options& options,
                                     const std::vector<const PendingFile*>& others) {
  if (name.empty() || name == "-") return nullptr;
  std::vector<std::string> inputs = options.bags;
  inputs.push_back(options.scene);
  return std::make_unique<PendingFile>(name, inputs, others);
}

std::string sideText(const scene::EventSide& side) {
  std::string out = side.object;
  if (!side.link.empty() && side.link != side.object) out += "/" + side.link;
  if (!side.zone.empty()) out += "[" + side.zone + (side.zone_certain ? "]" : "?]");
  return out;
}

}  // namespace

Outputs::Outputs(const Options& options, std::shared_ptr<const scene::Scene> scene,
                 std::ostream& standard_output)
    : scene_(std::move(scene)),
      standard_output_(standard_output),
      table_(options.jsonl != "-" && options.csv != "-"),
      json_to_standard_output_(options.jsonl == "-"),
      json_file_(pending(options.jsonl, options, {})),
      csv_file_(pending(options.csv, options, {json_file_.get()})),
      bag_file_(pending(options.out, options, {json_file_.get(), csv_file_.get()})),
      markers_(scene_),
      clock_(std::llround(scene_->time.jump * 1e9)) {
  if (options.csv == "-" || options.out == "-")
    throw InputError("--csv and --out need a file name; only --jsonl can go to standard output (-)");
  if (bag_file_ && bag_file_->isStream())
    throw InputError(options.out + ": is no regular file; a bag is written back and forth and needs one");
  if (json_file_) openText(json_, *json_file_);
  if (csv_file_) openText(csv_, *csv_file_);
  if (csv_file_) csv_ << messages::csvHeader() << '\n';
  if (bag_file_) {
    try {
      bag_.open(bag_file_->path(), rosbag::bagmode::Write);
    } catch (const rosbag::BagException& error) {
      throw InputError(bag_file_->path() + ": cannot be written (" + error.what() + ")");
    }
    bag_.setCompression(rosbag::compression::LZ4);
  }
}

void Outputs::begin(const ros::Time& first_receive_time, const std::string& plan) {
  first_ = std::max(first_receive_time, ros::TIME_MIN);
  if (!bag_file_) return;
  std_msgs::String text;
  text.data = plan;
  bag_.write(kPlan, first_, text, planHeader());
  bag_.write(kMarkers, first_, markers_.start(first_));
}

void Outputs::input(const BagInput::Message& message) {
  if (!bag_file_) return;
  if (copies_.size() <= message.sender) copies_.resize(message.sender + 1);
  Copy& copy = copies_[message.sender];
  const Connection& connection = message.connection;
  if (!copy.header) {
    copy.header = headerOf(connection);
    copy.message.morph(connection.md5sum, connection.datatype, connection.definition,
                       connection.latched ? "1" : "0");
  }
  ros::serialization::IStream stream(const_cast<std::uint8_t*>(message.raw.data), message.raw.size);
  copy.message.read(stream);
  bag_.write(connection.topic, std::max(messages::toTime(message.received_ns), first_), copy.message,
             copy.header);
}

void Outputs::poseSeen(motion::Nanoseconds received_ns, motion::Nanoseconds stamp_ns) {
  clock_.poseSeen(received_ns, stamp_ns);
}

ros::Time Outputs::receiveTime(std::uint32_t epoch, motion::Nanoseconds stamp_ns) {
  return std::max(messages::toTime(clock_.at(epoch, stamp_ns)), first_);
}

void Outputs::jsonLine(const std::string& line) {
  if (json_to_standard_output_) standard_output_ << line << '\n';
  if (json_file_) json_ << line << '\n';
}

void Outputs::event(const scene::Event& event, std::uint32_t own_epoch) {
  if (table_) row(event);
  ++events_;
  if (json_to_standard_output_ || json_file_) jsonLine(messages::toJson(event, scene_->world_frame));
  if (csv_file_) csv_ << messages::toCsv(event, scene_->world_frame) << '\n';
  if (!bag_file_) return;
  const ros::Time time = receiveTime(own_epoch, event.stamp_ns);
  bag_.write(kImpacts, time, toMessage(event, scene_->world_frame));
  bag_.write(kMarkers, time, markers_.event(event));
}

void Outputs::stats(const scene::Stats& stats, std::uint32_t own_epoch) {
  if (bag_file_)
    bag_.write(kStats, receiveTime(own_epoch, stats.stamp_ns), toMessage(stats, scene_->world_frame));
}

void Outputs::row(const scene::Event& event) {
  char line[400];
  if (events_ == 0) {
    std::snprintf(line, sizeof line, "%-5s %-20s %-15s %-22s %-26s %-26s %9s  %-32s %9s %9s\n", "epoch",
                  "time [s]", "what", "certificate", "a", "b", "width [s]", "point [m]", "ball [m]", "m/s");
    standard_output_ << line;
  }
  std::string certificate = impact::toString(event.certificate);
  if (event.reason != impact::Reason::kNone) certificate += std::string(" ") + impact::toString(event.reason);
  char point[64];
  std::snprintf(point, sizeof point, "%.4f %.4f %.4f", event.position.x(), event.position.y(),
                event.position.z());
  std::snprintf(line, sizeof line, "%-5u %-20s %-15s %-22s %-26s %-26s %9.2g  %-32s %9.2g %9.1f\n",
                event.epoch, messages::secondsText(event.stamp_ns).c_str(), impact::toString(event.kind),
                certificate.c_str(), sideText(event.a).c_str(), sideText(event.b).c_str(),
                event.toi_upper - event.toi_lower, point, event.position_error, event.closing_speed);
  standard_output_ << line;
}

void Outputs::end() {
  if (json_file_) finishText(json_, *json_file_);
  if (csv_file_) finishText(csv_, *csv_file_);
  if (bag_file_) {
    try {
      bag_.close();
    } catch (const rosbag::BagException& error) {
      throw InputError(bag_file_->path() + ": could not be written whole (" + error.what() + ")");
    }
    bag_file_->keep();
  }
  standard_output_.flush();
  if (!standard_output_) throw InputError("standard output: could not be written whole (disk full?)");
}

}  // namespace collision_node::replay

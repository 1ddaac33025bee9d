#include "collision_node/replay/bag_input.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>

#include "collision_node/messages/convert.h"
#include "collision_node/messages/event_text.h"

namespace collision_node::replay {

namespace {

namespace fs = std::filesystem;

std::unique_ptr<rosbag::Bag> openBag(const std::string& file) {
  std::error_code ignored;
  if (!fs::exists(file, ignored)) throw InputError(file + ": no such bag");
  if (!fs::is_regular_file(file, ignored)) throw InputError(file + ": is not a file; a bag is expected");
  if (fs::file_size(file, ignored) == 0) throw InputError(file + ": is empty (0 bytes); a bag is expected");
  char start[8] = {};
  std::ifstream(file, std::ios::binary).read(start, 7);
  if (std::string(start) != "#ROSBAG")
    throw InputError(file + ": is not a bag (does not start with #ROSBAG)");
  try {
    return std::make_unique<rosbag::Bag>(file, rosbag::bagmode::Read);
  } catch (const rosbag::BagUnindexedException&) {
    throw InputError(file +
                     ": has no index (its recording was never closed): run `rosbag reindex` on a copy of it");
  } catch (const rosbag::BagException& error) {
    throw InputError(file + ": is cut short or damaged (" + error.what() +
                     "): run `rosbag reindex` on a copy of it to save what is left");
  }
}

void fillBytes(const rosbag::MessageInstance& message, std::vector<std::uint8_t>& bytes) {
  bytes.resize(message.size());
  ros::serialization::OStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  message.write(stream);
}

std::string list(const std::vector<std::string>& items) {
  std::string out;
  for (const auto& item : items) out += (out.empty() ? "" : ", ") + item;
  return out.empty() ? "nothing" : out;
}

}  // namespace

BagInput::BagInput(const std::vector<std::string>& files) : files_(files) {
  std::string faults;
  for (const auto& file : files) {
    try {
      bags_.push_back(openBag(file));
    } catch (const InputError& error) {
      faults += (faults.empty() ? "" : "\n") + std::string(error.what());
    }
  }
  if (!faults.empty()) throw InputError(faults);
  rosbag::View all;
  for (const auto& bag : bags_) all.addQuery(*bag);
  if (all.size() == 0) throw InputError(list(files_) + ": holds no messages");
  begin_ = all.getBeginTime();
  end_ = all.getEndTime();
}

void BagInput::check(const messages::PoseRouter& router, const scene::Scene& scene) const {
  rosbag::View all;
  for (const auto& bag : bags_) all.addQuery(*bag);
  std::map<std::string, const rosbag::ConnectionInfo*> present;
  std::string faults;
  const auto fault = [&](const std::string& line) { faults += (faults.empty() ? "" : "\n") + line; };
  for (const rosbag::ConnectionInfo* connection : all.getConnections()) {
    present[connection->topic] = connection;
    try {
      router.checkType(connection->topic, connection->datatype, connection->md5sum);
    } catch (const messages::PoseError& error) {
      fault(list(files_) + ": " + error.what());
    }
  }
  std::vector<std::string> missing, held;
  for (const auto& topic : router.topics())
    if (topic != "/tf_static" && present.count(topic) == 0) missing.push_back(topic);
  for (const auto& entry : present) held.push_back(entry.first + " (" + entry.second->datatype + ")");
  if (!missing.empty())
    fault(list(files_) + ": lacks " + list(missing) + ", which the scene " + scene.file + " names; it has " +
          list(held));
  if (!faults.empty()) throw InputError(faults);
  if (router.usesTf()) checkTf(scene);
}

void BagInput::checkTf(const scene::Scene& scene) const {
  messages::PoseRouter probe(
      std::make_shared<scene::Scene>(scene), [](const std::string& topic) { return topic; },
      [](int, const motion::StampedPose&) {});
  // Damage is met again, and told, when the poses are read.
  std::string fault;
  forEach({"/tf", "/tf_static"}, {}, {},
          [&](const rosbag::MessageInstance& m, const messages::RawMessage& raw) {
            try {
              probe.handle(m.getTopic(), raw);
            } catch (const messages::PoseError& error) {
              if (fault.empty()) fault = error.what();
            }
          });
  if (!fault.empty()) throw InputError(list(files_) + ": " + fault);
  if (!probe.tf().unresolved().empty())
    throw InputError(list(files_) + ": tf never connects '" + list(probe.tf().unresolved()) +
                     "' to world_frame '" + scene.world_frame +
                     "'; tf frames here: " + list(probe.tf().frames()));
}

BagInput::Summary BagInput::forEach(
    const std::vector<std::string>& topics, std::optional<double> from, std::optional<double> to,
    const std::function<void(const rosbag::MessageInstance&, const messages::RawMessage&)>& visit) const {
  const ros::Time start = from ? begin_ + ros::Duration(*from) : ros::TIME_MIN;
  const ros::Time stop = to ? begin_ + ros::Duration(*to) : ros::TIME_MAX;
  Summary summary;
  std::vector<std::uint8_t> bytes;
  ros::Time last = start;
  try {
    rosbag::View view;
    for (const auto& bag : bags_) view.addQuery(*bag, rosbag::TopicQuery(topics), start, stop);
    for (auto message = view.begin(); message != view.end(); ++message) {
      fillBytes(*message, bytes);
      messages::RawMessage raw;
      raw.datatype = message->getDataType();
      raw.md5sum = message->getMD5Sum();
      raw.data = bytes.data();
      raw.size = static_cast<std::uint32_t>(bytes.size());
      visit(*message, raw);
      last = message->getTime();
      ++summary.messages;
    }
  } catch (const rosbag::BagException& error) {
    summary.damage = list(files_) + ": damaged after receive time " +
                     messages::secondsText(messages::toNanoseconds(last)) + " s (" + error.what() +
                     "): the " + std::to_string(summary.messages) +
                     " messages before it are used, the rest is not";
  }
  return summary;
}

}  // namespace collision_node::replay

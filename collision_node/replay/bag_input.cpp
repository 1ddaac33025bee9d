#include "collision_node/replay/bag_input.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <stdexcept>

#include "collision_node/messages/convert.h"
#include "collision_node/messages/event_text.h"
#include "collision_node/replay/bag_index.h"

namespace collision_node::replay {

namespace {

namespace fs = std::filesystem;

std::unique_ptr<rosbag::Bag> openBag(const std::string& file) {
  std::error_code ignored;
  if (!fs::exists(file, ignored)) throw InputError(file + ": no such bag");
  if (!fs::is_regular_file(file, ignored)) throw InputError(file + ": is not a file; a bag is expected");
  if (fs::file_size(file, ignored) == 0) throw InputError(file + ": is empty (0 bytes); a bag is expected");
  std::string start(13, '\0');
  std::ifstream in(file, std::ios::binary);
  in.read(start.data(), static_cast<std::streamsize>(start.size()));
  start.resize(static_cast<std::size_t>(in.gcount()));
  if (start.rfind("#ROSBAG", 0) != 0) throw InputError(file + ": is not a bag (does not start with #ROSBAG)");
  const std::string version = start.substr(7, start.find('\n') - 7);
  if (version != " V2.0")
    throw InputError(file + ": is a bag of version" + version +
                     "; V2.0 is read: `rosbag reindex` and `rosbag fix` make one of an older bag, on a copy");
  try {
    return std::make_unique<rosbag::Bag>(file, rosbag::bagmode::Read);
  } catch (const rosbag::BagUnindexedException&) {
    throw InputError(file +
                     ": has no index (its recording was never closed): run `rosbag reindex` on a copy of it");
  } catch (const std::exception& error) {  // damage makes rosbag throw more than its own
    throw InputError(file + ": is cut short or damaged (" + error.what() +
                     "): run `rosbag reindex` on a copy of it to save what is left");
  }
}

const char* const kTf = "/tf";
const char* const kTfStatic = "/tf_static";

/// A length that no pose message has. rosbag trusts the length it reads from a damaged bag.
constexpr std::uint32_t kLargestMessage = 16 * 1024 * 1024;

void fillBytes(const rosbag::MessageInstance& message, std::vector<std::uint8_t>& bytes) {
  if (message.size() > kLargestMessage)
    throw std::length_error("a message on " + message.getTopic() + " claims " +
                            std::to_string(message.size()) + " bytes, at most " +
                            std::to_string(kLargestMessage) + " are read");
  bytes.resize(message.size());
  ros::serialization::OStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  message.write(stream);
}

void fill(const rosbag::MessageInstance& message, std::vector<std::uint8_t>& bytes,
          messages::RawMessage& raw) {
  fillBytes(message, bytes);
  raw.datatype = message.getDataType();
  raw.md5sum = message.getMD5Sum();
  raw.data = bytes.data();
  raw.size = static_cast<std::uint32_t>(bytes.size());
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
      if (const auto damaged = checkIndex(file))
        damaged_from_ns_ = std::min(*damaged, damaged_from_ns_.value_or(*damaged));
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

void BagInput::check(messages::PoseRouter& router, const scene::Scene& scene,
                     const messages::PoseRouter::ResolveTopic& resolve) const {
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
    if (topic != kTfStatic && present.count(topic) == 0) missing.push_back(topic);
  for (const auto& entry : present) held.push_back(entry.first + " (" + entry.second->datatype + ")");
  if (!missing.empty())
    fault(list(files_) + ": lacks " + list(missing) + ", which the scene " + scene.file + " names; it has " +
          list(held));
  if (!faults.empty()) throw InputError(faults);
  learnFrames(router);
  if (router.usesTf()) checkTf(scene, resolve);
}

/// Whether tf is needed, and must be read from its beginning, stands in the first message of each topic.
void BagInput::learnFrames(messages::PoseRouter& router) const {
  const std::vector<std::string> topics = router.topics();  // a copy: tf may join
  for (const auto& topic : topics) {
    if (topic == kTf || topic == kTfStatic) continue;
    try {
      rosbag::View view;
      for (const auto& bag : bags_) view.addQuery(*bag, rosbag::TopicQuery(topic));
      if (view.size() == 0) continue;
      std::vector<std::uint8_t> bytes;
      messages::RawMessage raw;
      fill(*view.begin(), bytes, raw);
      router.learnFrame(topic, raw);
    } catch (const std::exception&) {
      // Damage is met again, and told, when the poses are read.
    }
  }
}

void BagInput::checkTf(const scene::Scene& scene, const messages::PoseRouter::ResolveTopic& resolve) const {
  messages::PoseRouter probe(std::make_shared<scene::Scene>(scene), resolve,
                             [](int, const motion::StampedPose&, messages::StampKind) {});
  learnFrames(probe);
  // Damage and messages that cannot be used are met again, and told, when the poses are read.
  std::string fault;
  forEach({kTf, kTfStatic}, {}, {}, [&](const rosbag::MessageInstance& m, const messages::RawMessage& raw) {
    try {
      probe.handle(m.getTopic(), raw, 0);
    } catch (const messages::PoseError& error) {
      if (fault.empty()) fault = error.what();
    }
  });
  if (probe.tf().unresolved().empty()) return;
  throw InputError(list(files_) + ": tf never says where '" + list(probe.tf().unresolved()) +
                   "' is in world_frame '" + scene.world_frame + "'" +
                   (fault.empty() ? "" : " (" + fault + ")") +
                   "; tf frames here: " + list(probe.tf().frames()));
}

ros::Time BagInput::at(double seconds) const {
  return messages::toTime(messages::toNanoseconds(begin_) + std::llround(seconds * 1e9));
}

BagInput::Summary BagInput::forEach(
    const std::vector<std::string>& topics, std::optional<double> from, std::optional<double> to,
    const std::function<void(const rosbag::MessageInstance&, const messages::RawMessage&)>& visit) const {
  const ros::Time start = from ? at(*from) : ros::TIME_MIN;
  const ros::Time stop = to ? at(*to) : ros::TIME_MAX;
  std::vector<std::string> timed = topics;
  const auto removed = std::remove(timed.begin(), timed.end(), kTfStatic);
  const bool wants_static = removed != timed.end();
  timed.erase(removed, timed.end());
  Summary summary;
  ros::Time last = start;
  // Only what rosbag does is guarded: a fault of the visitor is no damage of the bag. Beside its own
  // exceptions a damaged bag makes rosbag throw those of boost and the standard library.
  const auto read = [&](const auto& step) {
    try {
      step();
      return true;
    } catch (const std::exception& error) {
      summary.damage = list(files_) + ": damaged after receive time " +
                       messages::secondsText(messages::toNanoseconds(last)) + " s (" + error.what() +
                       "): the " + std::to_string(summary.messages) +
                       " messages before it are used, the rest is not";
      return false;
    }
  };
  rosbag::View view;
  rosbag::View::iterator message;
  std::vector<std::uint8_t> bytes;
  messages::RawMessage raw;
  const auto open = [&] {
    for (const auto& bag : bags_) {
      view.addQuery(*bag, rosbag::TopicQuery(timed), start, stop);
      if (wants_static) view.addQuery(*bag, rosbag::TopicQuery(kTfStatic), ros::TIME_MIN, stop);
    }
    message = view.begin();
  };
  const auto take = [&] {
    if (damaged_from_ns_ && messages::toNanoseconds(message->getTime()) >= *damaged_from_ns_)
      throw std::length_error("a message is longer than its chunk");
    fill(*message, bytes, raw);
  };
  if (!read(open)) return summary;
  while (message != view.end()) {
    if (!read(take)) break;
    visit(*message, raw);
    last = message->getTime();
    ++summary.messages;
    if (!read([&] { ++message; })) break;
  }
  return summary;
}

}  // namespace collision_node::replay

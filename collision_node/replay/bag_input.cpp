#include "collision_node/replay/bag_input.h"

#include <algorithm>
#include <limits>
#include <map>

#include "collision_node/messages/convert.h"
#include "collision_node/messages/event_text.h"

namespace collision_node::replay {

namespace {

const char* const kTf = "/tf";
const char* const kTfStatic = "/tf_static";
constexpr Nanoseconds kEver = std::numeric_limits<Nanoseconds>::min();
constexpr Nanoseconds kNever = std::numeric_limits<Nanoseconds>::max();

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
      bags_.push_back(std::make_unique<BagFile>(file));
    } catch (const InputError& error) {
      faults += (faults.empty() ? "" : "\n") + std::string(error.what());
    }
  }
  if (!faults.empty()) throw InputError(faults);
  begin_ns_ = kNever;
  end_ns_ = kEver;
  for (const auto& bag : bags_) {
    first_of_.push_back(raw_.size());
    for (const Connection& connection : bag->connections())
      raw_.push_back({connection.datatype, connection.md5sum, nullptr, 0});
    messages_ += bag->messages();
    for (const ChunkInfo& chunk : bag->chunks()) {
      begin_ns_ = std::min(begin_ns_, chunk.first_ns);
      end_ns_ = std::max(end_ns_, chunk.last_ns);
    }
  }
  if (messages_ == 0) throw InputError(list(files_) + ": holds no messages");
}

void BagInput::check(messages::PoseRouter& router, const scene::Scene& scene,
                     const messages::PoseRouter::ResolveTopic& resolve) const {
  std::map<std::string, const Connection*> present;
  std::string faults;
  const auto fault = [&](const std::string& line) { faults += (faults.empty() ? "" : "\n") + line; };
  for (const auto& bag : bags_) {
    std::vector<char> has_messages(bag->connections().size(), 0);
    for (const ChunkInfo& chunk : bag->chunks())
      for (const std::uint32_t connection : chunk.connections) has_messages[connection] = 1;
    for (std::size_t i = 0; i < has_messages.size(); ++i) {
      if (has_messages[i] == 0) continue;
      const Connection& connection = bag->connections()[i];
      present[connection.topic] = &connection;
      try {
        router.checkType(connection.topic, connection.datatype, connection.md5sum);
      } catch (const messages::PoseError& error) {
        fault(list(files_) + ": " + error.what());
      }
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
/// Damage is met again, and told, when the poses are read.
void BagInput::learnFrames(messages::PoseRouter& router) const {
  const std::vector<std::string> topics = router.topics();  // a copy: tf may join
  for (const auto& topic : topics) {
    if (topic == kTf || topic == kTfStatic) continue;
    forEach({topic}, kEver, kNever, [&](const Message& message) {
      router.learnFrame(topic, message.raw);
      return false;
    });
  }
}

void BagInput::checkTf(const scene::Scene& scene, const messages::PoseRouter::ResolveTopic& resolve) const {
  messages::PoseRouter probe(std::make_shared<scene::Scene>(scene), resolve,
                             [](int, const motion::StampedPose&, messages::StampKind) {});
  learnFrames(probe);
  // Damage and messages that cannot be used are met again, and told, when the poses are read.
  std::string fault;
  forEach({kTf, kTfStatic}, kEver, kNever, [&](const Message& message) {
    try {
      probe.handle(message.connection.topic, message.raw, 0);
    } catch (const messages::PoseError& error) {
      if (fault.empty()) fault = error.what();
    }
    return !probe.tf().unresolved().empty();
  });
  if (probe.tf().unresolved().empty()) return;
  throw InputError(list(files_) + ": tf never says where '" + list(probe.tf().unresolved()) +
                   "' is in world_frame '" + scene.world_frame + "'" +
                   (fault.empty() ? "" : " (" + fault + ")") +
                   "; tf frames here: " + list(probe.tf().frames()));
}

/// Of every connection of every bag: nothing is wanted.
std::vector<std::vector<Nanoseconds>> BagInput::never() const {
  std::vector<std::vector<Nanoseconds>> out;
  for (const auto& bag : bags_) out.emplace_back(bag->connections().size(), kNever);
  return out;
}

BagInput::Summary BagInput::forEach(const std::vector<std::string>& topics, Nanoseconds from_ns,
                                    Nanoseconds to_ns, const Visit& visit) const {
  auto wanted = never();
  for (std::size_t bag = 0; bag < bags_.size(); ++bag)
    for (std::size_t i = 0; i < wanted[bag].size(); ++i) {
      const std::string& topic = bags_[bag]->connections()[i].topic;
      if (std::find(topics.begin(), topics.end(), topic) != topics.end())
        wanted[bag][i] = topic == kTfStatic ? kEver : from_ns;
    }
  BagStream stream(bags_, std::move(wanted), to_ns);
  Summary summary;
  Nanoseconds last_ns = std::max(from_ns, begin_ns_);
  for (;;) {
    const BagStream::Message* message = nullptr;
    try {
      message = stream.next();
    } catch (const DamageError& error) {  // of the bag; a fault of the visitor is none
      summary.damage = list(files_) + ": damaged after receive time " + messages::secondsText(last_ns) +
                       " s (" + error.what() + "): the " + std::to_string(summary.messages) +
                       " messages before it are used, the rest is not";
      return summary;
    }
    if (message == nullptr) return summary;
    const std::size_t sender = numberOf(message->bag, message->connection);
    messages::RawMessage& raw = raw_[sender];
    raw.data = message->data;
    raw.size = message->size;
    last_ns = message->received_ns;
    ++summary.messages;
    if (!visit({last_ns, sender, bags_[message->bag]->connections()[message->connection], raw}))
      return summary;
  }
}

std::optional<Nanoseconds> BagInput::lastBefore(const std::string& topic, Nanoseconds ns) const {
  std::optional<Nanoseconds> last;
  for (std::size_t b = 0; b < bags_.size(); ++b) {
    const BagFile& bag = *bags_[b];
    std::vector<Nanoseconds> wanted = never()[b];
    std::vector<std::uint32_t> senders;
    for (std::uint32_t i = 0; i < wanted.size(); ++i)
      if (bag.connections()[i].topic == topic) {
        wanted[i] = kEver;
        senders.push_back(i);
      }
    Chunk chunk;
    for (auto info = bag.chunks().rbegin(); info != bag.chunks().rend(); ++info) {
      const bool is_here = std::find_first_of(info->connections.begin(), info->connections.end(),
                                              senders.begin(), senders.end()) != info->connections.end();
      if (!is_here || info->first_ns >= ns || (last && info->last_ns <= *last)) continue;
      bag.read(*info, wanted, ns, chunk);
      if (chunk.messages.empty()) continue;
      last = std::max(chunk.messages.back().received_ns, last.value_or(kEver));
      break;
    }
  }
  return last;
}

}  // namespace collision_node::replay

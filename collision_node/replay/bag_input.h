/// The input bags: opened, checked against the scene, read in order of receive time.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "collision_node/messages/pose_router.h"
#include "collision_node/replay/bag_stream.h"
#include "collision_node/replay/options.h"

namespace collision_node::replay {

/// Opens all bags, for reading only. Throws InputError, one line each, as BagFile does; and when they hold no
/// message.
class BagInput {
 public:
  explicit BagInput(const std::vector<std::string>& files);

  /// Throws InputError when a topic of the scene is in no bag (lists what they hold), carries another type
  /// than a pose or two types, or tf never says where a frame of the scene or of its topics is in the world.
  /// Shows the router each topic's first message; reads /tf until it has said where the scene's frames are.
  void check(messages::PoseRouter& router, const scene::Scene& scene,
             const messages::PoseRouter::ResolveTopic& resolve) const;

  struct Message {
    Nanoseconds received_ns;
    std::size_t sender;  ///< number of its connection, over all bags: 0 .. senders() - 1
    const Connection& connection;
    const messages::RawMessage& raw;
  };
  /// Returns false when it has seen enough.
  using Visit = std::function<bool(const Message&)>;

  struct Summary {
    std::uint64_t messages = 0;
    std::string damage;  ///< "" or one line: which bag broke, where
  };

  /// Calls `visit` for each message on `topics` received in [from_ns, to_ns), in receive order; of /tf_static
  /// whatever comes before `to_ns`, since it is sent only once, at the start. Damage ends the reading and is
  /// told in the summary; what came before stands.
  Summary forEach(const std::vector<std::string>& topics, Nanoseconds from_ns, Nanoseconds to_ns,
                  const Visit& visit) const;

  /// A message on `topic` received before `ns`, behind which no more than a chunk of them comes before `ns`;
  /// nothing when there is none.
  std::optional<Nanoseconds> lastBefore(const std::string& topic, Nanoseconds ns) const;

  Nanoseconds beginNs() const { return begin_ns_; }  ///< receive time of the first message of any topic
  Nanoseconds endNs() const { return end_ns_; }      ///< and of the last one
  std::uint64_t messages() const { return messages_; }
  std::size_t senders() const { return raw_.size(); }

 private:
  std::size_t numberOf(std::size_t bag, std::uint32_t connection) const {
    return first_of_[bag] + connection;
  }
  std::vector<std::vector<Nanoseconds>> never() const;
  void learnFrames(messages::PoseRouter& router) const;
  void checkTf(const scene::Scene& scene, const messages::PoseRouter::ResolveTopic& resolve) const;

  std::vector<std::string> files_;
  std::vector<std::unique_ptr<BagFile>> bags_;
  std::vector<std::size_t> first_of_;              // by bag: number of its first connection
  mutable std::vector<messages::RawMessage> raw_;  // by sender; their types are filled in once
  Nanoseconds begin_ns_ = 0, end_ns_ = 0;
  std::uint64_t messages_ = 0;
};

}  // namespace collision_node::replay

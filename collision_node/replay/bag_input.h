/// The input bags: opened, checked against the scene, read in order of receive time.
#pragma once

#include <rosbag/bag.h>
#include <rosbag/view.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "collision_node/messages/pose_router.h"
#include "collision_node/replay/options.h"

namespace collision_node::replay {

/// Opens all bags, for reading only. Throws InputError, one line each: absent, empty, no bag, never closed,
/// cut short, index damaged.
class BagInput {
 public:
  explicit BagInput(const std::vector<std::string>& files);

  /// Throws InputError when a topic of the scene is in no bag (lists what they hold), carries another type
  /// than a pose or two types, or tf never says where a frame of the scene or of its topics is in the world.
  /// Shows the router each topic's first message; reads all of /tf when the scene uses it.
  void check(messages::PoseRouter& router, const scene::Scene& scene,
             const messages::PoseRouter::ResolveTopic& resolve) const;

  struct Summary {
    std::uint64_t messages = 0;
    std::string damage;  ///< "" or one line: which bag broke, where
  };

  /// Calls `visit` for each message on `topics` between `from` and `to` [s] after begin(), in receive order;
  /// of /tf_static whatever comes before `to`, since it is sent only once, at the start. A damaged chunk ends
  /// the reading and is told in the summary; what came before stands.
  Summary forEach(
      const std::vector<std::string>& topics, std::optional<double> from, std::optional<double> to,
      const std::function<void(const rosbag::MessageInstance&, const messages::RawMessage&)>& visit) const;

  ros::Time begin() const { return begin_; }  ///< receive time of the first message of any topic
  ros::Time end() const { return end_; }
  ros::Time at(double seconds) const;  ///< begin() and so many seconds

 private:
  void learnFrames(messages::PoseRouter& router) const;
  void checkTf(const scene::Scene& scene, const messages::PoseRouter::ResolveTopic& resolve) const;

  std::vector<std::string> files_;
  std::vector<std::unique_ptr<rosbag::Bag>> bags_;
  std::optional<std::int64_t> damaged_from_ns_;  // receive time from which messages cannot be read
  ros::Time begin_, end_;
};

}  // namespace collision_node::replay

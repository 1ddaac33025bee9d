/// Where a replay's results go. Every file is written beside its name and renamed when it is whole.
#pragma once

#include <rosbag/bag.h>
#include <topic_tools/shape_shifter.h>

#include <fstream>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "collision_node/messages/markers.h"
#include "collision_node/replay/bag_input.h"
#include "collision_node/replay/options.h"
#include "collision_node/replay/pending_file.h"
#include "collision_node/replay/receive_clock.h"
#include "collision_node/scene/engine.h"

namespace collision_node::replay {

/// The table, JSON lines, CSV and the result bag, as `options` asks.
class Outputs {
 public:
  /// Throws InputError: a file that cannot be written, or that is one of the inputs.
  Outputs(const Options& options, std::shared_ptr<const scene::Scene> scene, std::ostream& standard_output);

  /// The head of the result bag: plan (latched), cleared markers, fixed objects. What was received before
  /// `first_receive_time` is written as if it came then.
  void begin(const ros::Time& first_receive_time, const std::string& plan);
  /// Copies an input message into the result bag. `stamp_ns`: of a pose in it, if it has one; keeps the
  /// distance between stamps and receive times, by which events are placed among the inputs.
  void input(const BagInput::Message& message);
  void poseSeen(motion::Nanoseconds received_ns, motion::Nanoseconds stamp_ns);
  /// A line that is no event, among the JSON lines.
  void jsonLine(const std::string& line);
  /// `own_epoch`: as the poses seen have it.
  void event(const scene::Event& event, std::uint32_t own_epoch);
  void stats(const scene::Stats& stats, std::uint32_t own_epoch);
  /// Finishes and names all files. Throws InputError when one cannot be written whole.
  void end();

  std::uint64_t events() const { return events_; }

 private:
  /// What a sender's messages are written with into the result bag.
  struct Copy {
    topic_tools::ShapeShifter message;
    boost::shared_ptr<ros::M_string> header;
  };

  ros::Time receiveTime(std::uint32_t epoch, motion::Nanoseconds stamp_ns);
  void row(const scene::Event& event);

  std::shared_ptr<const scene::Scene> scene_;
  std::ostream& standard_output_;
  bool table_ = true, json_to_standard_output_ = false;
  std::unique_ptr<PendingFile> json_file_, csv_file_, bag_file_;
  std::ofstream json_, csv_;
  rosbag::Bag bag_;
  std::vector<Copy> copies_;  // by sender
  messages::Markers markers_;
  ros::Time first_;
  ReceiveClock clock_;
  std::uint64_t events_ = 0;
};

}  // namespace collision_node::replay

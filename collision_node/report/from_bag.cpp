#include <rosbag/bag.h>
#include <rosbag/view.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <map>
#include <stdexcept>

#include "collision_node/Impact.h"
#include "collision_node/IntervalStats.h"
#include "collision_node/report/modes.h"
#include "collision_node/report/present.h"
#include "collision_node/report/results_file.h"

namespace collision_node::report {
namespace {

/// What one heartbeat tells of the time since the one before.
struct Beat {
  double stamp = 0.0, wall_time = 0.0;  ///< [s], from the first heartbeat; as measured
  double bracket = 0.0, ball = 0.0;     ///< [s], [m]: the worst of the events in that time; 0: no event
  std::size_t events = 0;
  std::uint64_t node_tests = 0;
};

std::vector<Beat> beatsOf(const std::string& file) {
  rosbag::Bag bag;
  try {
    bag.open(file, rosbag::bagmode::Read);
  } catch (const std::exception& error) {
    throw std::runtime_error(file + ": cannot be read as a bag (" + error.what() + ")");
  }
  std::vector<Beat> beats;
  Beat beat;
  ros::Time first;
  std::uint64_t node_tests = 0;
  std::size_t unmeasured = 0;
  const std::vector<std::string> types = {"collision_node/Impact", "collision_node/IntervalStats"};
  rosbag::View view(bag, rosbag::TypeQuery(types));
  for (const rosbag::MessageInstance& message : view) {
    if (const auto impact = message.instantiate<Impact>()) {
      ++beat.events;
      beat.bracket = std::max(beat.bracket, impact->toi_upper - impact->toi_lower);
      if (impact->position_error > beat.ball) beat.ball = impact->position_error;
    } else if (const auto stats = message.instantiate<IntervalStats>()) {
      if (first.isZero()) first = stats->header.stamp;
      beat.stamp = (stats->header.stamp - first).toSec();
      beat.wall_time = stats->wall_time;
      beat.node_tests = stats->node_tests - std::min(stats->node_tests, node_tests);
      node_tests = stats->node_tests;
      if (std::isnan(beat.wall_time)) {
        ++unmeasured;
      } else {
        beats.push_back(beat);
      }
      beat = Beat();
    }
  }
  if (beats.empty() && unmeasured > 0)
    throw std::runtime_error(file + ": its " + std::to_string(unmeasured) +
                             " heartbeats have no wall_time; record with `replay ... --out F.bag --timing`");
  if (beats.empty())
    throw std::runtime_error(file +
                             ": holds no collision_node/IntervalStats; record ~stats and ~impacts, or "
                             "`replay ... --out F.bag --timing`");
  return beats;
}

}  // namespace

int runFromBag(const Options& options, std::ostream& out) {
  const std::vector<Beat> beats = beatsOf(options.bags.front());
  double seconds = 0.0, bracket = 0.0, ball = 0.0;
  std::size_t events = 0;
  for (const Beat& beat : beats) {
    seconds += beat.wall_time;
    bracket = std::max(bracket, beat.bracket);
    ball = std::max(ball, beat.ball);
    events += beat.events;
  }
  writeFile(options.out + "/from_bag.csv", [&beats](std::ostream& file) {
    file << "stamp_s,wall_time_s,events,worst_bracket_s,worst_position_error_m,node_tests\n";
    for (const Beat& beat : beats) {
      file << cell(beat.stamp) << ',' << cell(beat.wall_time) << ',' << beat.events << ','
           << cell(beat.bracket) << ',' << cell(beat.ball) << ',' << beat.node_tests << '\n';
    }
  });
  out << beats.size() << " heartbeats, " << events << " events in " << cell(seconds)
      << " s of wall time; worst bracket " << cell(bracket) << " s, worst position error " << cell(ball)
      << " m\n";
  present(options.out, out, "present_recording.py");
  return kDone;
}

}  // namespace collision_node::report

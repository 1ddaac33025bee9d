/// A bar on a terminal.
#pragma once

#include <ros/time.h>

#include <ostream>

namespace collision_node::replay {

class Progress {
 public:
  /// Draws nothing unless `show`.
  Progress(std::ostream& err, bool show, const ros::Time& begin, const ros::Time& end);
  void at(const ros::Time& now);  ///< redraws when a whole per cent has passed
  void finish();                  ///< takes the bar away

 private:
  std::ostream& err_;
  bool show_;
  double begin_, length_;  // [s]; a damaged bag may hold times that ros::Duration refuses
  int shown_ = -1;
};

}  // namespace collision_node::replay

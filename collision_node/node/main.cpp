#include <ros/console.h>
#include <ros/init.h>
#include <ros/node_handle.h>

#include <csignal>
#include <exception>
#include <memory>
#include <sstream>
#include <string>

#include "collision_node/node/collision_node.h"

namespace {

volatile std::sig_atomic_t stop_asked = 0;
void askStop(int) { stop_asked = 1; }

}  // namespace

int main(int argc, char** argv) {
  // Our own handler: ROS's would take the publishers away before the last events are out.
  ros::init(argc, argv, "collision_node", ros::init_options::NoSigintHandler);
  std::signal(SIGINT, askStop);
  std::signal(SIGTERM, askStop);
  ros::NodeHandle handle, private_handle("~");
  try {
    auto node = std::make_unique<collision_node::node::CollisionNode>(handle, private_handle);
    while (ros::ok() && stop_asked == 0)
      ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.05));
    node.reset();
    ros::WallDuration(0.2).sleep();  // roscpp has no way to ask whether its sockets have taken everything
  } catch (const std::exception& error) {
    std::istringstream lines(error.what());
    for (std::string line; std::getline(lines, line);) ROS_FATAL_STREAM(line);
    return 2;
  }
  return 0;
}

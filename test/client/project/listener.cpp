#include <collision_node/Impact.h>
#include <ros/ros.h>

int main(int argc, char** argv) {
  ros::init(argc, argv, "listener");
  ros::NodeHandle handle;
  const auto listener = handle.subscribe<collision_node::Impact>(
      "collision_node/impacts", 1000, [](const collision_node::Impact::ConstPtr& impact) {
        std::cout << impact->a.object << " hits " << impact->b.object << "/" << impact->b.link << std::endl;
      });
  ros::spin();
}

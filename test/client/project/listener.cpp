#include <collision_node/Impact.h>
#include <ros/ros.h>

void hear(const collision_node::Impact& impact) {
  std::cout << impact.a.object << " hits " << impact.b.object << "/" << impact.b.link << std::endl;
}

int main(int argc, char** argv) {
  ros::init(argc, argv, "listener");
  ros::NodeHandle handle;
  const ros::Subscriber listener = handle.subscribe("collision_node/impacts", 1000, hear);
  ros::spin();
}

#include "collision_node/node/collision_nodelet.h"

#include <pluginlib/class_list_macros.hpp>

namespace collision_node::node {

void CollisionNodelet::onInit() {
  node_ = std::make_unique<CollisionNode>(getNodeHandle(), getPrivateNodeHandle());
}

}  // namespace collision_node::node

PLUGINLIB_EXPORT_CLASS(collision_node::node::CollisionNodelet, nodelet::Nodelet)

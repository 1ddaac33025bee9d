/// The node as a nodelet.
#pragma once

#include <nodelet/nodelet.h>

#include <memory>

#include "collision_node/node/collision_node.h"

namespace collision_node::node {

class CollisionNodelet : public nodelet::Nodelet {
 private:
  void onInit() override;
  std::unique_ptr<CollisionNode> node_;
};

}  // namespace collision_node::node

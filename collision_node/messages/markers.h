/// What rviz shows of events: where, in which direction, how sure, and the bodies as they stood.
#pragma once

#include <ros/time.h>
#include <visualization_msgs/MarkerArray.h>

#include <cstddef>
#include <deque>
#include <memory>
#include <vector>

#include "collision_node/scene/engine.h"
#include "collision_node/scene/scene.h"

namespace collision_node::messages {

struct MarkerOptions {
  double min_size = 0.3;  ///< [m] an impact is never drawn smaller; its label says when it is enlarged
  double lifetime = 0.0;  ///< [s] of rviz's clock; 0: for ever
  std::size_t max_events = 1000;  ///< events shown at a time; the oldest are deleted
};

/// Builds marker arrays in the world frame. Namespaces: impact/point, impact/normal, impact/bound,
/// impact/label (not for separations; ids: the low 31 bits of event_id) and body (ids: the link's number in
/// the scene, so a body moves to its newest impact). Colours of impact/point: confirmed impact red (1, 0, 0),
/// separation blue, initial overlap yellow, possible orange, uncertified magenta.
class Markers {
 public:
  Markers(std::shared_ptr<const scene::Scene> scene, MarkerOptions options = {});

  /// Clears rviz's display and draws the fixed objects that are in some watched pair. To be sent first, and
  /// after every reset.
  visualization_msgs::MarkerArray start(const ros::Time& stamp);

  /// Draws one event and both objects as ghosts where they stood. An event of a new epoch clears the display
  /// first.
  visualization_msgs::MarkerArray event(const scene::Event& event);

 private:
  using Array = visualization_msgs::MarkerArray;
  void makeBodies();  // with the first message: who sends none pays for no triangles
  void addStart(const ros::Time& stamp, Array& out);
  void addBody(std::size_t object, const geometry::Pose& pose, const ros::Time& stamp, Array& out) const;
  void addSide(const scene::EventSide& side, const ros::Time& stamp, Array& out) const;

  std::shared_ptr<const scene::Scene> scene_;
  MarkerOptions options_;
  std::vector<visualization_msgs::Marker> bodies_;  // of watched objects' links with shapes, pose left open
  std::vector<std::vector<int>> body_of_link_;  // [object][link] -> index into bodies_, -1: nothing to draw
  std::deque<std::int32_t> shown_;
  std::uint32_t epoch_ = 0;
};

}  // namespace collision_node::messages

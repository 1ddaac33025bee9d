/// Which named part of an object a contact lies in.
#pragma once

#include <string>

#include "collision_node/scene/scene.h"

namespace collision_node::scene {

struct ZoneAnswer {
  std::string name;      ///< empty: in no zone
  bool certain = false;  ///< holds for every point of the ball
};

/// The first zone of `object`, in file order, that is on `link` and whose box (if any) holds `point`; if none
/// does, the first that the ball meets, which is never certain. The ball has its `centre` and `point` in the
/// link's frame [m]. "No zone" is certain: the ball touches no zone of the link.
ZoneAnswer findZone(const Object& object, const std::string& link, const Vec3& point, const Vec3& centre,
                    double radius);

}  // namespace collision_node::scene

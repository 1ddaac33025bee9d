/// Objects whose links move against each other: cut into parts that do not, and where joints put them.
#pragma once

#include <optional>
#include <vector>

#include "collision_node/scene/scene.h"

namespace collision_node::scene {

/// Cuts an object with a URDF's links at its movable joints. Each part is an Object with the same name and
/// options, the links that fixed joints hold together (placed from the part's first link) and their zones.
/// The first part holds the root link. A part without a shape touches nothing and needs no pose: its links
/// are listed with the first one. The parts' sources are left as the object's.
std::vector<Object> cutIntoParts(const Object& whole);

/// The movable joints from the first part of `whole` to the link `part`, outermost first.
std::vector<PartJoint> jointsTo(const Object& whole, const std::string& part);

/// The part behind the joint as seen from the part before it. `position` [rad] or [m] is that of
/// joint.driver, as is `rate` [rad/s]; without a rate, or for a joint that cannot go round, the position
/// alone says how far it turned.
motion::StampedPose jointPose(const PartJoint& joint, Nanoseconds stamp_ns, double position,
                              std::optional<double> rate);

}  // namespace collision_node::scene

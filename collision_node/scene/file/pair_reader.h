/// `pairs:` of a scene file: which links are watched against which, and why the others are not.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "collision_node/scene/file/yaml_tree.h"

namespace collision_node::scene {

/// Fills scene.pairs from `node` (may be null: every object against every
/// other). Requires scene.objects complete and sorted by name. Rules, the first that holds wins: neighbours
/// in one URDF are never watched; `ignore` leaves out; with `only` just what it lists is watched; links of
/// one object are watched with `self: true` or when `only` lists the two links. Of several `distances` that
/// fit a pair the last one counts.
void readPairs(const YamlNode* node, Scene& scene, Faults& faults);

/// The objects (of these names) that may be in a watched pair, before any is read: without those that `only`
/// does not name, or that `ignore` pairs with every other.
std::set<std::string> watchedObjects(const YamlNode* node, const std::vector<std::string>& names);

}  // namespace collision_node::scene

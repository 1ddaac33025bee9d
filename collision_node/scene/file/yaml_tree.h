/// A YAML document as plain data that remembers where each value was written.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "collision_node/scene/scene.h"

namespace collision_node::scene {

/// All faults of one scene, gathered before anything is thrown.
class Faults {
 public:
  void add(const std::string& line) { lines_.push_back(line); }
  bool empty() const { return lines_.empty(); }
  /// Throws SceneError with all lines when there are any.
  void throwIfAny() const;

 private:
  std::vector<std::string> lines_;
};

/// One value. Maps keep the file's order and every entry, also repeated keys.
struct YamlNode {
  enum class Kind { kNull, kScalar, kList, kMap } kind = Kind::kNull;
  std::string text;                                       ///< kScalar
  std::vector<YamlNode> items;                            ///< kList
  std::vector<std::pair<std::string, YamlNode>> entries;  ///< kMap
  std::string where;  ///< "scene.yaml:12" or "override precision/time": the start of a fault's line

  const YamlNode* find(const std::string& key) const;
};

/// Reads `file`, replaces or adds the nodes that `overrides` name, and reports what is no proper YAML:
/// syntax, a second document, keys that are no plain words, repeated keys (with both lines). Returns a null
/// node when unusable.
YamlNode readYaml(const std::string& file, const Overrides& overrides, Faults& faults);

/// The entry of `known` with the smallest edit distance to `word`; of equals one with the same first letter,
/// then the first; "" when `known` is empty.
std::string nearestWord(const std::string& word, const std::vector<std::string>& known);

/// "; nearest known: 'x'"; "; known here: x, y" when `word` is like none of them; "" when there is none.
std::string nearestHint(const std::string& word, const std::vector<std::string>& known);

}  // namespace collision_node::scene

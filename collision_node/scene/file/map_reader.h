/// Checked reading of one YAML map: types, limits, and the keys that nobody asked for.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "collision_node/scene/file/yaml_tree.h"

namespace collision_node::scene {

/// What a real number must satisfy. Every number must be finite.
struct Limit {
  double bound;
  bool bound_allowed;
  const char* unit;  ///< "" for none
  double most = std::numeric_limits<double>::infinity();
};

inline constexpr Limit positive(const char* unit) { return {0.0, false, unit}; }
inline constexpr Limit notNegative(const char* unit) { return {0.0, true, unit}; }
/// Nanoseconds in 64 bits hold 292 years; every duration of a scene stays below a century.
inline constexpr Limit positiveDuration() { return {0.0, false, "s", 3e9}; }
inline constexpr Limit durationOrZero() { return {0.0, true, "s", 3e9}; }

/// Reads the entries of one map. Every call makes its key known; done() then reports the others. A fault is
/// added to the list and the value is left out (std::nullopt, nullptr), so that reading goes on and finds all
/// faults.
class MapReader {
 public:
  /// `node` null or of kind kNull reads as an empty map; any other kind but a map is a fault. `path` is the
  /// key path for messages, "" at the top; `form` is what to write instead. Both `node` and `faults` must
  /// outlive the reader.
  MapReader(const YamlNode* node, std::string path, Faults& faults,
            const std::string& form = "keys with values");

  bool has(const std::string& key);
  const YamlNode* find(const std::string& key);
  /// The map under `key`; an absent one reads as empty.
  MapReader map(const std::string& key, const std::string& form = "keys with values");

  std::optional<double> real(const std::string& key, const Limit& limit);
  std::optional<Vec3> vec3(const std::string& key);
  /// [x, y, z, w], made unit; refuses | |q|^2 - 1 | >= 1e-2.
  std::optional<Pose> pose();  ///< keys position and orientation of this map, both optional
  std::optional<std::string> text(const std::string& key);
  std::optional<bool> flag(const std::string& key);
  std::optional<std::int64_t> whole(const std::string& key, std::int64_t least, std::int64_t most);
  /// One of `words`; returns its index.
  std::optional<std::size_t> choice(const std::string& key, const std::vector<std::string>& words);

  const std::vector<std::pair<std::string, YamlNode>>& entries() const;
  std::string path(const std::string& key) const { return path_.empty() ? key : path_ + "/" + key; }

  /// Adds "<where>: <path>: <what>"; for `key` "" the map itself is meant.
  void fault(const std::string& key, const std::string& what);
  /// Reports every key that was not asked for, with the nearest that was.
  void done();
  bool good() const { return good_; }  ///< no fault so far in this map itself

 private:
  std::optional<std::vector<double>> reals(const std::string& key, std::size_t count, const char* meaning);

  const YamlNode* node_;
  std::string path_;
  Faults& faults_;
  std::vector<std::string> known_;
  bool good_ = true;
};

/// A finite decimal number; false when `text` is anything else. Independent of the locale.
bool parseReal(const std::string& text, double& value);
/// The shortest decimal text that reads back as `value`.
std::string formatReal(double value);
/// What a node holds, for messages: its text, or "a list", "a map", "nothing".
std::string describe(const YamlNode& node);

}  // namespace collision_node::scene

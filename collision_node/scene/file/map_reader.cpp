#include "collision_node/scene/file/map_reader.h"

#include <algorithm>
#include <cmath>
#include <locale>
#include <sstream>

#include "collision_node/motion/stamped_pose.h"

namespace collision_node::scene {
namespace {

using Kind = YamlNode::Kind;

std::string describeLimit(const Limit& limit) {
  const std::string unit = limit.unit[0] == '\0' ? "" : std::string(" [") + limit.unit + "]";
  std::string text = std::string(limit.bound_allowed ? ">= " : "> ") + formatReal(limit.bound);
  if (std::isfinite(limit.most)) text += " and <= " + formatReal(limit.most);
  return text + unit;
}

bool isNotFiniteWord(std::string text) {
  if (!text.empty() && (text[0] == '+' || text[0] == '-')) text.erase(0, 1);
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text == ".inf" || text == "inf" || text == "infinity" || text == ".nan" || text == "nan";
}

std::string notAReal(const YamlNode& node) {
  if (node.kind == Kind::kScalar && isNotFiniteWord(node.text)) {
    return node.text + " is not finite; must be a finite number";
  }
  std::string with_point = node.kind == Kind::kScalar ? node.text : "";
  std::replace(with_point.begin(), with_point.end(), ',', '.');
  double value = 0.0;
  const bool has_comma = with_point != node.text && parseReal(with_point, value);
  return describe(node) + " is not a number" + (has_comma ? " (write " + with_point + ")" : "");
}

}  // namespace

bool parseReal(const std::string& text, double& value) {
  if (text.empty() || text.find_first_not_of("+-.0123456789eE") != std::string::npos) return false;
  std::istringstream stream(text);
  stream.imbue(std::locale::classic());
  stream >> value;
  return !stream.fail() && stream.peek() == std::istringstream::traits_type::eof() && std::isfinite(value);
}

std::string formatReal(double value) {
  // Whole numbers of up to nine digits without an exponent: 30, not 3e+01.
  int digits = 1;
  for (double size = std::abs(value); size >= 10.0 && size < 1e9 && digits < 9; size /= 10.0) ++digits;
  for (;; ++digits) {
    std::ostringstream text;
    text.imbue(std::locale::classic());
    text.precision(digits);
    text << value;
    double back = 0.0;
    if (digits >= 17 || (parseReal(text.str(), back) && back == value)) return text.str();
  }
}

std::string describe(const YamlNode& node) {
  switch (node.kind) {
    case Kind::kScalar:
      return "'" + node.text + "'";
    case Kind::kList:
      return "a list";
    case Kind::kMap:
      return "a map";
    case Kind::kNull:
      break;
  }
  return "nothing";
}

MapReader::MapReader(const YamlNode* node, std::string path, Faults& faults, const std::string& form)
    : node_(node), path_(std::move(path)), faults_(faults) {
  if (node_ == nullptr || node_->kind == Kind::kMap || node_->kind == Kind::kNull) return;
  fault("", describe(*node_) + " is not a map; write " + form);
  node_ = nullptr;
}

const std::vector<std::pair<std::string, YamlNode>>& MapReader::entries() const {
  static const std::vector<std::pair<std::string, YamlNode>> none;
  return node_ == nullptr ? none : node_->entries;
}

void MapReader::fault(const std::string& key, const std::string& what) {
  good_ = false;
  const YamlNode* named = node_ == nullptr || key.empty() ? nullptr : node_->find(key);
  const YamlNode* place = named != nullptr ? named : node_;
  std::string line;
  if (place != nullptr && !place->where.empty()) line += place->where + ": ";
  const std::string full = key.empty() ? path_ : path(key);
  if (!full.empty()) line += full + ": ";
  faults_.add(line + what);
}

const YamlNode* MapReader::find(const std::string& key) {
  if (std::find(known_.begin(), known_.end(), key) == known_.end()) known_.push_back(key);
  return node_ == nullptr ? nullptr : node_->find(key);
}

bool MapReader::has(const std::string& key) { return find(key) != nullptr; }

MapReader MapReader::map(const std::string& key, const std::string& form) {
  return MapReader(find(key), path(key), faults_, form);
}

std::optional<double> MapReader::real(const std::string& key, const Limit& limit) {
  const YamlNode* node = find(key);
  if (node == nullptr) return {};
  double value = 0.0;
  if (node->kind != Kind::kScalar || !parseReal(node->text, value)) {
    fault(key, notAReal(*node) + ", " + describeLimit(limit));
    return {};
  }
  if (value < limit.bound || (value == limit.bound && !limit.bound_allowed) || value > limit.most) {
    fault(key, formatReal(value) + " is out of range; must be " + describeLimit(limit));
    return {};
  }
  return value;
}

std::optional<std::vector<double>> MapReader::reals(const std::string& key, std::size_t count,
                                                    const char* meaning) {
  const YamlNode* node = find(key);
  if (node == nullptr) return {};
  if (node->kind != Kind::kList || node->items.size() != count) {
    const std::string found =
        node->kind == Kind::kList ? "a list of " + std::to_string(node->items.size()) : describe(*node);
    fault(key, found + " found; must be " + meaning);
    return {};
  }
  std::vector<double> values(count);
  for (std::size_t i = 0; i < count; ++i) {
    const YamlNode& item = node->items[i];
    if (item.kind != Kind::kScalar || !parseReal(item.text, values[i])) {
      fault(key, "element " + std::to_string(i) + ": " + notAReal(item) + "; must be " + meaning);
      return {};
    }
  }
  return values;
}

std::optional<Vec3> MapReader::vec3(const std::string& key) {
  const auto values = reals(key, 3, "three finite numbers [x, y, z]");
  if (!values) return {};
  return Vec3((*values)[0], (*values)[1], (*values)[2]);
}

std::optional<Pose> MapReader::pose() {
  const std::optional<Vec3> position = vec3("position");
  const auto q = reals("orientation", 4, "a unit quaternion of four finite numbers [x, y, z, w]");
  if (!good_) return {};
  motion::StampedPose stamped;
  if (position) stamped.pose.position = *position;
  if (q) stamped.pose.orientation = geometry::Quat((*q)[3], (*q)[0], (*q)[1], (*q)[2]);
  if (motion::checkAndNormalise(stamped) != motion::PoseFault::kNone) {
    fault("orientation", "quaternion with |q|^2 = " + formatReal(stamped.pose.orientation.squaredNorm()) +
                             "; must be a unit quaternion [x, y, z, w], | |q|^2 - 1 | < 0.01");
    return {};
  }
  return stamped.pose;
}

std::optional<std::string> MapReader::text(const std::string& key) {
  const YamlNode* node = find(key);
  if (node == nullptr) return {};
  if (node->kind != Kind::kScalar || node->text.empty()) {
    fault(key, (node->kind == Kind::kScalar ? "an empty text" : describe(*node)) + " found; must be a text");
    return {};
  }
  return node->text;
}

std::optional<bool> MapReader::flag(const std::string& key) {
  const YamlNode* node = find(key);
  if (node == nullptr) return {};
  if (node->kind == Kind::kScalar) {
    for (const char* word : {"true", "True", "yes"}) {
      if (node->text == word) return true;
    }
    for (const char* word : {"false", "False", "no"}) {
      if (node->text == word) return false;
    }
  }
  fault(key, describe(*node) + " found; must be true or false");
  return {};
}

std::optional<std::int64_t> MapReader::whole(const std::string& key, std::int64_t least, std::int64_t most) {
  const YamlNode* node = find(key);
  if (node == nullptr) return {};
  double value = 0.0;
  const bool good = node->kind == Kind::kScalar && parseReal(node->text, value) &&
                    value == std::floor(value) && value >= static_cast<double>(least) &&
                    value <= static_cast<double>(most);
  if (!good) {
    fault(key, describe(*node) + " found; must be a whole number from " + std::to_string(least) + " to " +
                   std::to_string(most));
    return {};
  }
  return static_cast<std::int64_t>(value);
}

std::optional<std::size_t> MapReader::choice(const std::string& key, const std::vector<std::string>& words) {
  const YamlNode* node = find(key);
  if (node == nullptr) return {};
  const auto found =
      node->kind == Kind::kScalar ? std::find(words.begin(), words.end(), node->text) : words.end();
  if (found != words.end()) return static_cast<std::size_t>(found - words.begin());
  std::string list;
  for (const std::string& word : words) list += (list.empty() ? "" : ", ") + word;
  fault(key, describe(*node) + " found; must be one of: " + list);
  return {};
}

void MapReader::done() {
  for (const auto& [key, value] : entries()) {
    if (std::find(known_.begin(), known_.end(), key) != known_.end()) continue;
    // {radius: 0,1} is a map of radius and 1.
    const bool is_fraction =
        key.find_first_not_of("0123456789") == std::string::npos && value.kind == Kind::kNull;
    fault(key, "unknown key '" + key + "'" +
                   (is_fraction ? "; numbers have a decimal point, no comma" : nearestHint(key, known_)));
  }
}

}  // namespace collision_node::scene

#include "collision_node/scene/file/yaml_tree.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <sstream>

namespace collision_node::scene {
namespace {

// Aliases may nest or even hold themselves; a scene written by people stays far below both.
constexpr int kDeepest = 50;
constexpr std::size_t kMostNodes = 1000000;

std::string oneLine(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

/// Copies yaml-cpp's nodes, which share and lose their marks when edited, into a tree of our own.
class Copier {
 public:
  /// Exactly one of `file` and `override_key` is meant: the former takes the line, the latter stands alone.
  Copier(std::string file, std::string override_key, Faults& faults)
      : file_(std::move(file)), override_key_(std::move(override_key)), faults_(faults) {}

  YamlNode copy(const YAML::Node& node, const std::string& path) { return copy(node, path, 0); }

 private:
  std::string where(const YAML::Node& node) const {
    if (!override_key_.empty()) return "override " + override_key_;
    const YAML::Mark mark = node.Mark();
    return mark.is_null() ? file_ : file_ + ":" + std::to_string(mark.line + 1);
  }

  YamlNode copy(const YAML::Node& node, const std::string& path, int depth) {
    YamlNode result;
    result.where = where(node);
    if (depth > kDeepest || ++count_ > kMostNodes) {
      if (!overflowed_) {
        faults_.add(result.where + ": " + path + ": nested deeper than " + std::to_string(kDeepest) +
                    " levels or more than " + std::to_string(kMostNodes) +
                    " values; an alias that holds itself? Write the values out");
      }
      overflowed_ = true;
      return result;
    }
    if (node.IsScalar()) {
      result.kind = YamlNode::Kind::kScalar;
      result.text = node.Scalar();
    } else if (node.IsSequence()) {
      result.kind = YamlNode::Kind::kList;
      for (std::size_t i = 0; i < node.size(); ++i) {
        result.items.push_back(copy(node[i], path + "[" + std::to_string(i) + "]", depth + 1));
      }
    } else if (node.IsMap()) {
      result.kind = YamlNode::Kind::kMap;
      copyMap(node, path, depth, result);
    }
    return result;
  }

  void copyMap(const YAML::Node& node, const std::string& path, int depth, YamlNode& result) {
    const std::string prefix = path.empty() ? "" : path + "/";
    for (const auto& entry : node) {
      if (!entry.first.IsScalar() || entry.first.Scalar().empty()) {
        faults_.add(where(entry.first) + ": " + (path.empty() ? "top level" : path) +
                    ": a key is no plain word; write key: value");
        continue;
      }
      const std::string key = entry.first.Scalar();
      YamlNode value = copy(entry.second, prefix + key, depth + 1);
      value.where = where(entry.first);
      if (const YamlNode* earlier = result.find(key)) {
        faults_.add(value.where + ": " + prefix + key + ": key given twice (first at " + earlier->where +
                    "); keep one of them");
        continue;
      }
      result.entries.emplace_back(key, std::move(value));
    }
  }

  std::string file_, override_key_;
  Faults& faults_;
  std::size_t count_ = 0;
  bool overflowed_ = false;
};

/// What yaml-cpp says of a line that a tab indents does not name the tab.
std::string tabHint(const std::string& text) {
  std::istringstream lines(text);
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    const std::string indent = line.substr(0, line.find_first_not_of(" \t"));
    if (indent.size() < line.size() && indent.find('\t') != std::string::npos)
      return "; line " + std::to_string(number) + " is indented by a tab: indent by spaces";
  }
  return {};
}

/// The one document of `text`; reports and returns false when it has none or several.
bool parseOne(const std::string& text, const std::string& where, bool is_file, YAML::Node& result,
              Faults& faults) {
  try {
    const std::vector<YAML::Node> documents = YAML::LoadAll(text);
    if (documents.size() > 1) {
      faults.add(where + ": holds " + std::to_string(documents.size()) +
                 " YAML documents; one is read: remove the '---' lines");
      return false;
    }
    if (!documents.empty()) result = documents.front();
    return true;
  } catch (const YAML::Exception& error) {
    const std::string line =
        is_file && !error.mark.is_null() ? ":" + std::to_string(error.mark.line + 1) : std::string();
    faults.add(where + line + ": not valid YAML: " + oneLine(error.msg) + tabHint(text));
    return false;
  }
}

bool readText(const std::string& file, std::string& text, Faults& faults) {
  std::error_code error;
  if (std::filesystem::is_directory(file, error)) {
    faults.add(file + ": is a folder; a scene file (YAML) is needed");
    return false;
  }
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream content;
  if (!stream) {
    faults.add(file + ": the scene file cannot be opened: " + std::strerror(errno));
    return false;
  }
  content << stream.rdbuf();
  text = content.str();
  return true;
}

void applyOverride(YamlNode& root, const std::string& key, const std::string& text, Faults& faults) {
  const std::string where = "override " + key;
  std::vector<std::string> parts;
  std::istringstream stream(key);
  for (std::string part; std::getline(stream, part, '/');) parts.push_back(part);
  if (parts.empty() || key.back() == '/' || std::count(parts.begin(), parts.end(), "") > 0) {
    faults.add(where + ": not a key path; write words joined by '/', for example precision/time");
    return;
  }
  YAML::Node value;
  if (!parseOne(text, where, false, value, faults)) return;

  YamlNode* node = &root;
  std::string path;
  for (const std::string& part : parts) {
    if (node->kind == YamlNode::Kind::kNull) {
      node->kind = YamlNode::Kind::kMap;
      node->where = where;
    }
    if (node->kind != YamlNode::Kind::kMap) {
      faults.add(where + ": " + path + " (" + node->where + ") is not a map, so it has no key '" + part +
                 "'; override " + path + " as a whole");
      return;
    }
    path += (path.empty() ? "" : "/") + part;
    auto found = std::find_if(node->entries.begin(), node->entries.end(),
                              [&](const auto& entry) { return entry.first == part; });
    if (found == node->entries.end()) {
      YamlNode added;
      added.where = where;
      found = node->entries.insert(node->entries.end(), {part, std::move(added)});
    }
    node = &found->second;
  }
  *node = Copier("", key, faults).copy(value, path);
}

std::size_t editDistance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i - 1] != b[j - 1]);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, replaced});
    }
  }
  return row[b.size()];
}

}  // namespace

void Faults::throwIfAny() const {
  if (lines_.empty()) return;
  std::string text;
  for (const std::string& line : lines_) text += (text.empty() ? "" : "\n") + line;
  throw SceneError(text);
}

const YamlNode* YamlNode::find(const std::string& key) const {
  for (const auto& entry : entries) {
    if (entry.first == key) return &entry.second;
  }
  return nullptr;
}

YamlNode readYaml(const std::string& file, const Overrides& overrides, Faults& faults) {
  YamlNode root;
  root.where = file;
  std::string text;
  YAML::Node document;
  if (!readText(file, text, faults)) return root;
  if (text.rfind("#ROSBAG", 0) == 0) {
    faults.add(file + ": a bag, not a scene; the scene is named first, the bags behind it");
    return root;
  }
  if (!parseOne(text, file, true, document, faults)) return root;
  root = Copier(file, "", faults).copy(document, "");
  if (root.kind != YamlNode::Kind::kMap && root.kind != YamlNode::Kind::kNull) {
    faults.add(root.where + ": the scene is not a map; write keys such as objects:, each with its value");
    return YamlNode{};
  }
  for (const auto& [key, value] : overrides) applyOverride(root, key, value, faults);
  root.where = file;
  return root;
}

std::string nearestWord(const std::string& word, const std::vector<std::string>& known) {
  // Few mistype the first letter: of words as near as each other it decides.
  const auto farness = [&](const std::string& other) {
    return 2 * editDistance(word, other) + (word.substr(0, 1) == other.substr(0, 1) ? 0 : 1);
  };
  const auto nearest = std::min_element(
      known.begin(), known.end(), [&](const auto& a, const auto& b) { return farness(a) < farness(b); });
  return nearest == known.end() ? std::string() : *nearest;
}

std::string nearestHint(const std::string& word, const std::vector<std::string>& known) {
  const std::string nearest = nearestWord(word, known);
  if (nearest.empty()) return {};
  // What shares less than half its letters is no typing error: all that may stand there helps more.
  constexpr std::size_t kMost = 24;
  if (2 * editDistance(word, nearest) <= std::max(word.size(), nearest.size()) || known.size() > kMost)
    return "; nearest known: '" + nearest + "'";
  std::string all;
  for (const std::string& other : known) all += (all.empty() ? "" : ", ") + other;
  return "; known here: " + all;
}

}  // namespace collision_node::scene

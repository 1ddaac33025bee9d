#include "collision_node/scene/pair_reader.h"

#include <algorithm>
#include <optional>
#include <set>
#include <utility>

#include "collision_node/scene/map_reader.h"

namespace collision_node::scene {
namespace {

/// "tank" or "tank/turret", resolved.
struct Name {
  int object = -1;
  int link = -1;  ///< -1: any
};

struct NamePair {
  Name a, b;
  double contact_distance = 0.0;
  std::string place;  ///< for messages
};

/// One link that has a body.
struct Candidate {
  int object, link;
};

bool fits(const Name& name, const Candidate& candidate) {
  return name.object == candidate.object && (name.link < 0 || name.link == candidate.link);
}

bool fits(const NamePair& pair, const Candidate& a, const Candidate& b) {
  return (fits(pair.a, a) && fits(pair.b, b)) || (fits(pair.a, b) && fits(pair.b, a));
}

class PairReader {
 public:
  PairReader(const YamlNode* node, Scene& scene, Faults& faults)
      : reader_(node, "pairs", faults), scene_(scene), faults_(faults) {}

  void read() {
    if (!reader_.good()) return;
    default_distance_ = reader_.real("contact_distance", notNegative("m")).value_or(0.0);
    self_ = reader_.flag("self").value_or(false);
    has_only_ = reader_.has("only");
    ignore_ = readList("ignore");
    only_ = readList("only");
    readDistances();
    reader_.done();
    if (!reader_.good() || !faults_.empty()) return;
    pairUp();
  }

 private:
  // ---- names

  std::optional<Name> resolve(const YamlNode& node, const std::string& key) {
    if (node.kind != YamlNode::Kind::kScalar || node.text.empty()) {
      reader_.fault(key, describe(node) + " found; must be an object's name or object/link");
      return {};
    }
    const std::size_t slash = node.text.find('/');
    const std::string object_name = node.text.substr(0, slash);
    Name name;
    std::vector<std::string> known;
    for (std::size_t i = 0; i < scene_.objects.size(); ++i) {
      known.push_back(scene_.objects[i].name);
      if (scene_.objects[i].name == object_name) name.object = static_cast<int>(i);
    }
    if (name.object < 0) {
      reader_.fault(key, "unknown object '" + object_name + "'" + nearestHint(object_name, known));
      return {};
    }
    if (slash == std::string::npos) return name;
    const std::string link_name = node.text.substr(slash + 1);
    const std::vector<Link>& links = scene_.objects[name.object].links;
    known.clear();
    for (std::size_t i = 0; i < links.size(); ++i) {
      known.push_back(links[i].name);
      if (links[i].name == link_name) name.link = static_cast<int>(i);
    }
    // An object without links failed to load and has its own fault.
    if (name.link < 0 && !links.empty()) {
      reader_.fault(
          key, "unknown link '" + link_name + "' of '" + object_name + "'" + nearestHint(link_name, known));
    }
    if (name.link < 0) return {};
    return name;
  }

  std::optional<NamePair> resolvePair(const YamlNode& node, const std::string& key) {
    if (node.kind != YamlNode::Kind::kList || node.items.size() != 2) {
      reader_.fault(key, describe(node) + " found; must be a pair [a, b] of object or object/link names");
      return {};
    }
    const auto a = resolve(node.items[0], key);
    const auto b = resolve(node.items[1], key);
    if (!a || !b) return {};
    return NamePair{*a, *b, 0.0, key};
  }

  std::vector<NamePair> readList(const std::string& key) {
    std::vector<NamePair> pairs;
    const YamlNode* node = reader_.find(key);
    if (node == nullptr || node->kind == YamlNode::Kind::kNull) return pairs;
    if (node->kind != YamlNode::Kind::kList) {
      reader_.fault(key, describe(*node) + " found; must be a list of pairs [[a, b], …]");
      return pairs;
    }
    for (const YamlNode& item : node->items) {
      if (const auto pair = resolvePair(item, key)) pairs.push_back(*pair);
    }
    return pairs;
  }

  void readDistances() {
    const YamlNode* node = reader_.find("distances");
    if (node == nullptr || node->kind == YamlNode::Kind::kNull) return;
    if (node->kind != YamlNode::Kind::kList) {
      reader_.fault("distances",
                    describe(*node) + " found; must be a list of {pair: [a, b], contact_distance: <number>}");
      return;
    }
    for (std::size_t i = 0; i < node->items.size(); ++i) {
      const std::string path = "pairs/distances[" + std::to_string(i) + "]";
      MapReader entry(&node->items[i], path, faults_);
      if (!entry.good()) continue;
      if (!entry.has("pair")) entry.fault("", "no pair given; write pair: [a, b]");
      if (!entry.has("contact_distance"))
        entry.fault("", "no contact_distance given; write contact_distance: <number>");
      const auto distance = entry.real("contact_distance", notNegative("m"));
      const YamlNode* pair_node = entry.find("pair");
      auto pair = pair_node == nullptr ? std::nullopt : resolvePair(*pair_node, "distances");
      entry.done();
      if (!pair || !distance) continue;
      pair->contact_distance = *distance;
      distances_.push_back(*pair);
    }
  }

  // ---- pairs

  const Link& linkOf(const Candidate& c) const { return scene_.objects[c.object].links[c.link]; }

  static bool anyFits(const std::vector<NamePair>& pairs, const Candidate& a, const Candidate& b) {
    return std::any_of(pairs.begin(), pairs.end(), [&](const NamePair& pair) { return fits(pair, a, b); });
  }

  bool listedByLinks(const Candidate& a, const Candidate& b) const {
    return std::any_of(only_.begin(), only_.end(), [&](const NamePair& pair) {
      return pair.a.link >= 0 && pair.b.link >= 0 && fits(pair, a, b);
    });
  }

  /// Why the two are not watched; "" when they are.
  std::string reasonAgainst(const Candidate& a, const Candidate& b) const {
    const bool same_object = a.object == b.object;
    if (same_object && (linkOf(a).parent == linkOf(b).name || linkOf(b).parent == linkOf(a).name)) {
      return "neighbours in the URDF";
    }
    if (anyFits(ignore_, a, b)) return "listed in pairs/ignore";
    if (has_only_ && !anyFits(only_, a, b)) return "not listed in pairs/only";
    if (same_object && !self_ && !listedByLinks(a, b)) return "links of one object, pairs/self is not true";
    return "";
  }

  /// Two objects that no entry names follow the rule; the others get their verdicts one by one.
  void pairUp() {
    scene_.pairs = PairRules(default_distance_);
    if (has_only_) scene_.pairs.watchNothingElse("not listed in pairs/only");
    std::set<std::pair<int, int>> named;
    for (const std::vector<NamePair>* entries : {&ignore_, &only_, &distances_})
      for (const NamePair& entry : *entries) named.insert(std::minmax(entry.a.object, entry.b.object));
    for (std::size_t i = 0; i < scene_.objects.size(); ++i)
      if (scene_.objects[i].links.size() > 1) named.emplace(static_cast<int>(i), static_cast<int>(i));
    for (const auto& [a, b] : named) decide(a, b);
  }

  void decide(int object_a, int object_b) {
    std::vector<PairVerdict> verdicts;
    const std::vector<int> links_a = linksWithBody(scene_.objects[object_a]);
    const std::vector<int> links_b = linksWithBody(scene_.objects[object_b]);
    for (std::size_t i = 0; i < links_a.size(); ++i) {
      for (std::size_t k = object_a == object_b ? i + 1 : 0; k < links_b.size(); ++k) {
        const Candidate a{object_a, links_a[i]}, b{object_b, links_b[k]};
        LinkPair pair{a.object, a.link, b.object, b.link, default_distance_};
        for (const NamePair& entry : distances_) {
          if (fits(entry, a, b)) pair.contact_distance = entry.contact_distance;
        }
        verdicts.push_back({pair, reasonAgainst(a, b)});
      }
    }
    scene_.pairs.set(object_a, object_b, std::move(verdicts));
  }

  MapReader reader_;
  Scene& scene_;
  Faults& faults_;
  double default_distance_ = 0.0;
  bool self_ = false, has_only_ = false;
  std::vector<NamePair> ignore_, only_, distances_;
};

}  // namespace

void readPairs(const YamlNode* node, Scene& scene, Faults& faults) { PairReader(node, scene, faults).read(); }

}  // namespace collision_node::scene

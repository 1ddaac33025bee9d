#include "collision_node/scene/file/pair_reader.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "collision_node/scene/file/map_reader.h"

namespace collision_node::scene {
namespace {

/// "tank" or "tank/turret", resolved.
struct Name {
  std::string object;
  std::string link;  ///< "": any
};

struct NamePair {
  Name a, b;
  double contact_distance = 0.0;
  std::string place;  ///< for messages
};

/// One link that has shapes.
struct Candidate {
  int object, link;
  std::string object_name, link_name;  ///< parts of one object share its name
};

bool fits(const Name& name, const Candidate& candidate) {
  return name.object == candidate.object_name && (name.link.empty() || name.link == candidate.link_name);
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
    std::vector<std::string> objects, links;
    for (const Object& object : scene_.objects) {
      objects.push_back(object.name);
      if (object.name != object_name) continue;
      for (const Link& link : object.links) links.push_back(link.name);
    }
    const auto has = [](const std::vector<std::string>& known, const std::string& word) {
      return std::find(known.begin(), known.end(), word) != known.end();
    };
    if (!has(objects, object_name)) {
      reader_.fault(key, "unknown object '" + object_name + "'" + nearestHint(object_name, objects));
      return {};
    }
    if (slash == std::string::npos) return Name{object_name, ""};
    const std::string link_name = node.text.substr(slash + 1);
    if (has(links, link_name)) return Name{object_name, link_name};
    // An object without links failed to load and has its own fault.
    if (!links.empty()) {
      reader_.fault(
          key, "unknown link '" + link_name + "' of '" + object_name + "'" + nearestHint(link_name, links));
    }
    return {};
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
      return !pair.a.link.empty() && !pair.b.link.empty() && fits(pair, a, b);
    });
  }

  /// Why the two are not watched; "" when they are.
  std::string reasonAgainst(const Candidate& a, const Candidate& b) const {
    const bool same_object = a.object_name == b.object_name;
    if (same_object && (linkOf(a).parent == linkOf(b).name || linkOf(b).parent == linkOf(a).name)) {
      return "neighbours in the URDF";
    }
    if (anyFits(ignore_, a, b)) return "listed in pairs/ignore";
    if (has_only_ && !anyFits(only_, a, b)) return "not listed in pairs/only";
    if (same_object && !self_ && !listedByLinks(a, b)) return "links of one object, pairs/self is not true";
    return "";
  }

  /// Indices of the objects with this name.
  std::vector<int> partsOf(const std::string& name) const {
    const std::vector<Object>& objects = scene_.objects;
    auto at =
        std::lower_bound(objects.begin(), objects.end(), name,
                         [](const Object& object, const std::string& word) { return object.name < word; });
    std::vector<int> parts;
    for (; at != objects.end() && at->name == name; ++at)
      parts.push_back(static_cast<int>(at - objects.begin()));
    return parts;
  }

  /// Two objects that no entry names follow the rule; the others get their verdicts one by one.
  void pairUp() {
    scene_.pairs = PairRules(default_distance_);
    if (has_only_) scene_.pairs.watchNothingElse("not listed in pairs/only");
    std::set<std::pair<int, int>> named;
    const auto name = [&](const std::string& a, const std::string& b) {
      for (const int i : partsOf(a))
        for (const int k : partsOf(b)) named.insert(std::minmax(i, k));
    };
    for (const std::vector<NamePair>* entries : {&ignore_, &only_, &distances_})
      for (const NamePair& entry : *entries) name(entry.a.object, entry.b.object);
    for (const Object& object : scene_.objects)
      if (object.links.size() > 1 || !object.part.empty()) name(object.name, object.name);
    for (const auto& [a, b] : named) decide(a, b);
  }

  Candidate candidate(int object, int link) const {
    return {object, link, scene_.objects[object].name, scene_.objects[object].links[link].name};
  }

  void decide(int object_a, int object_b) {
    std::vector<PairVerdict> verdicts;
    const std::vector<int> links_a = linksWithShapes(scene_.objects[object_a]);
    const std::vector<int> links_b = linksWithShapes(scene_.objects[object_b]);
    for (std::size_t i = 0; i < links_a.size(); ++i) {
      for (std::size_t k = object_a == object_b ? i + 1 : 0; k < links_b.size(); ++k) {
        const Candidate a = candidate(object_a, links_a[i]), b = candidate(object_b, links_b[k]);
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

std::set<std::string> watchedObjects(const YamlNode* node, const std::vector<std::string>& names) {
  const YamlNode nothing;
  if (node == nullptr) node = &nothing;
  // Calls with both names of each entry that is well formed: readPairs() complains of the others.
  const auto forEach = [](const YamlNode* list, const auto& call) {
    if (list == nullptr) return;
    for (const YamlNode& item : list->items)
      if (item.items.size() == 2) call(item.items[0].text, item.items[1].text);
  };
  std::set<std::string> watched;
  if (const YamlNode* only = node->find("only")) {
    forEach(only, [&](const std::string& a, const std::string& b) {
      for (const std::string& name : {a, b}) watched.insert(name.substr(0, name.find('/')));
    });
    return watched;
  }
  std::map<std::string, std::set<std::string>> ignored;
  const std::set<std::string> known(names.begin(), names.end());
  forEach(node->find("ignore"), [&](const std::string& a, const std::string& b) {
    if (known.count(a) == 0 || known.count(b) == 0) return;  // a link of one, or unknown
    ignored[a].insert(b);
    ignored[b].insert(a);
  });
  const YamlNode* self = node->find("self");
  const bool has_self = self != nullptr && self->text != "false";
  for (const std::string& name : names) {
    const std::set<std::string>& others = ignored[name];
    const std::size_t needed = names.size() - (has_self || others.count(name) != 0 ? 0 : 1);
    if (others.empty() || others.size() < needed) watched.insert(name);
  }
  return watched;
}

}  // namespace collision_node::scene

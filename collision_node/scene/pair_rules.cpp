#include "collision_node/scene/pair_rules.h"

#include <algorithm>

#include "collision_node/scene/scene.h"

namespace collision_node::scene {

std::vector<int> linksWithShapes(const Object& object) {
  std::vector<int> links;
  for (std::size_t i = 0; i < object.links.size(); ++i)
    if (!object.links[i].shapes.empty()) links.push_back(static_cast<int>(i));
  std::sort(links.begin(), links.end(),
            [&](int l, int r) { return object.links[l].name < object.links[r].name; });
  return links;
}

namespace {

std::uint64_t linkCount(const Object& object) {
  return static_cast<std::uint64_t>(std::count_if(object.links.begin(), object.links.end(),
                                                  [](const Link& link) { return !link.shapes.empty(); }));
}

}  // namespace

PairRules::PairRules(std::initializer_list<LinkPair> watched) : reason_against_rest_("not listed") {
  for (const LinkPair& pair : watched) set_[{pair.object_a, pair.object_b}].push_back({pair, ""});
}

std::vector<LinkPair> PairRules::between(const std::vector<Object>& objects, int a, int b) const {
  std::vector<LinkPair> pairs;
  const auto exception = set_.find({a, b});
  if (exception != set_.end()) {
    for (const PairVerdict& verdict : exception->second) {
      const LinkPair& pair = verdict.pair;
      const bool have_shapes = !objects[pair.object_a].links[pair.link_a].shapes.empty() &&
                               !objects[pair.object_b].links[pair.link_b].shapes.empty();
      if (verdict.against.empty() && have_shapes) pairs.push_back(pair);
    }
  } else if (a != b && watchesRest()) {
    for (const int link_a : linksWithShapes(objects[a]))
      for (const int link_b : linksWithShapes(objects[b]))
        pairs.push_back({a, link_a, b, link_b, contact_distance_});
  }
  return pairs;
}

std::uint64_t PairRules::countBetween(const std::vector<Object>& objects, int a, int b) const {
  if (set_.count({a, b}) != 0) return between(objects, a, b).size();
  return a != b && watchesRest() ? linkCount(objects[a]) * linkCount(objects[b]) : 0;
}

std::uint64_t PairRules::count(const std::vector<Object>& objects) const {
  std::uint64_t count = 0;
  if (watchesRest()) {
    std::uint64_t before = 0;
    for (const Object& object : objects) {
      count += before * linkCount(object);
      before += linkCount(object);
    }
  }
  for (const auto& [key, verdicts] : set_) {
    if (watchesRest() && key.first != key.second)
      count -= linkCount(objects[key.first]) * linkCount(objects[key.second]);
    count += between(objects, key.first, key.second).size();
  }
  return count;
}

std::vector<std::vector<std::uint64_t>> PairRules::countByLink(const std::vector<Object>& objects) const {
  std::vector<std::vector<std::uint64_t>> counts;
  std::uint64_t all = 0;
  for (const Object& object : objects) {
    counts.emplace_back(object.links.size(), 0);
    all += linkCount(object);
  }
  const auto add = [&](int object, std::uint64_t pairs) {
    const std::vector<Link>& links = objects[object].links;
    for (std::size_t i = 0; i < links.size(); ++i)
      if (!links[i].shapes.empty()) counts[object][i] += pairs;
  };
  if (watchesRest())
    for (std::size_t i = 0; i < objects.size(); ++i) add(static_cast<int>(i), all - linkCount(objects[i]));
  for (const auto& [key, verdicts] : set_) {
    const auto [a, b] = key;
    if (watchesRest() && a != b) {
      add(a, -linkCount(objects[b]));
      add(b, -linkCount(objects[a]));
    }
    for (const LinkPair& pair : between(objects, a, b)) {
      ++counts[pair.object_a][pair.link_a];
      ++counts[pair.object_b][pair.link_b];
    }
  }
  return counts;
}

std::vector<LinkPair> PairRules::list(const std::vector<Object>& objects) const {
  std::vector<LinkPair> all;
  const auto append = [&](int a, int b) {
    const std::vector<LinkPair> pairs = between(objects, a, b);
    all.insert(all.end(), pairs.begin(), pairs.end());
  };
  if (watchesRest()) {
    const int count = static_cast<int>(objects.size());
    for (int a = 0; a < count; ++a)
      for (int b = a; b < count; ++b) append(a, b);
  } else {
    for (const auto& [key, verdicts] : set_) append(key.first, key.second);
  }
  std::stable_sort(all.begin(), all.end(), [&](const LinkPair& l, const LinkPair& r) {
    const auto name = [&](int object, int link) -> const std::string& {
      return objects[object].links[link].name;
    };
    if (l.object_a != r.object_a) return l.object_a < r.object_a;
    if (l.link_a != r.link_a) return name(l.object_a, l.link_a) < name(r.object_a, r.link_a);
    if (l.object_b != r.object_b) return l.object_b < r.object_b;
    return name(l.object_b, l.link_b) < name(r.object_b, r.link_b);
  });
  return all;
}

std::vector<double> PairRules::halfDistances(std::size_t objects) const {
  std::vector<double> half(objects, watchesRest() ? 0.5 * contact_distance_ : 0.0);
  for (const auto& [key, verdicts] : set_) {
    for (const PairVerdict& verdict : verdicts) {
      if (!verdict.against.empty()) continue;
      for (const int object : {key.first, key.second})
        half[object] = std::max(half[object], 0.5 * verdict.pair.contact_distance);
    }
  }
  return half;
}

}  // namespace collision_node::scene

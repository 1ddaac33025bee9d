#include "collision_node/scene/needs.h"

#include <algorithm>
#include <set>
#include <variant>

#include "collision_node/scene/scene.h"

namespace collision_node::scene {

namespace {

std::string joined(const std::set<std::string>& words, const std::string& otherwise) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : "; ") + word;
  return text.empty() ? otherwise : text;
}

/// By object: why it is not watched against others, or, without such a reason, not in itself.
std::vector<std::set<std::string>> reasonsAgainst(const Scene& scene) {
  std::vector<std::set<std::string>> among(scene.objects.size()), within(scene.objects.size());
  for (const auto& [key, verdicts] : scene.pairs.exceptions()) {
    const auto [a, b] = key;
    auto& reasons = scene.objects[a].name == scene.objects[b].name ? within : among;
    for (const PairVerdict& verdict : verdicts) {
      if (verdict.against.empty()) continue;
      reasons[a].insert(verdict.against);
      reasons[b].insert(verdict.against);
    }
  }
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    if (!scene.pairs.watchesRest()) among[i].insert(scene.pairs.reasonAgainstRest());
    if (linksWithShapes(scene.objects[i]).empty()) among[i] = {"no link of it has a shape"};
    if (among[i].empty()) among[i] = within[i];
  }
  return among;
}

/// What is not done for it.
std::string savingsOn(const Object& object, Need need) {
  bool has_mesh = false, has_shape = false;
  for (const Link& link : object.links) {
    if (link.body) continue;
    has_shape = has_shape || !link.shapes.empty();
    for (const geometry::PlacedShape& shape : link.shapes)
      has_mesh = has_mesh || std::holds_alternative<geometry::Mesh>(shape.shape) ||
                 std::holds_alternative<geometry::Convex>(shape.shape);
  }
  std::string text;
  if (has_mesh) text += "no mesh of it is read, ";
  if (has_shape) text += "no hierarchy is built, ";
  if (need == Need::kAsParent) return text + "its poses only place the parts that joints move on it";
  if (object.source.type == PoseSource::Type::kFixed) return text + "nothing can meet it";
  return text + "its poses are neither read nor waited for";
}

}  // namespace

std::vector<Need> needsOf(const Scene& scene) {
  const std::vector<Object>& objects = scene.objects;
  const std::vector<std::vector<std::uint64_t>> pairs = scene.pairs.countByLink(objects);
  std::vector<Need> needs(objects.size(), Need::kNone);
  std::size_t root = 0;  // parts of one object follow its first
  for (std::size_t i = 0; i < objects.size(); ++i) {
    if (objects[i].name != objects[root].name) root = i;
    if (std::all_of(pairs[i].begin(), pairs[i].end(), [](std::uint64_t count) { return count == 0; }))
      continue;
    needs[i] = Need::kWatched;
    if (objects[i].source.type == PoseSource::Type::kJoints && needs[root] == Need::kNone)
      needs[root] = Need::kAsParent;
  }
  return needs;
}

std::vector<std::string> leftOut(const Scene& scene) {
  const std::vector<Object>& objects = scene.objects;
  const std::vector<Need> needs = needsOf(scene);
  const std::vector<std::set<std::string>> reasons = reasonsAgainst(scene);
  std::vector<std::string> lines;
  for (std::size_t first = 0, end = 0; first < objects.size(); first = end) {
    while (end < objects.size() && objects[end].name == objects[first].name) ++end;
    const bool is_whole = std::all_of(needs.begin() + static_cast<std::ptrdiff_t>(first),
                                      needs.begin() + static_cast<std::ptrdiff_t>(end),
                                      [](Need need) { return need == Need::kNone; });
    for (std::size_t i = first; i < end; ++i) {
      if (needs[i] == Need::kWatched || (is_whole && i > first)) continue;
      lines.push_back((is_whole ? objects[i].name : objects[i].label()) + ": in no watched pair (" +
                      joined(reasons[i], "nothing else is there") + "): " + savingsOn(objects[i], needs[i]));
    }
  }
  return lines;
}

}  // namespace collision_node::scene

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

#include "collision_node/scene/file/map_reader.h"
#include "collision_node/scene/file/object_reader.h"
#include "collision_node/scene/file/pair_reader.h"
#include "collision_node/scene/file/resources.h"
#include "collision_node/scene/needs.h"
#include "collision_node/scene/scene.h"

namespace collision_node::scene {
namespace {

void readTime(MapReader reader, TimeOptions& time) {
  if (const auto value = reader.real("reorder", durationOrZero())) time.reorder = *value;
  if (const auto value = reader.real("max_gap", positiveDuration())) time.max_gap = *value;
  if (const auto value = reader.real("timeout", positiveDuration())) time.timeout = *value;
  if (const auto value = reader.real("jump", positiveDuration())) time.jump = *value;
  // Compared in whole nanoseconds: 0.1 + 0.2 is more than 0.3 in doubles.
  const auto nanoseconds = [](double seconds) { return std::llround(seconds * 1e9); };
  if (reader.good() && nanoseconds(time.timeout) < nanoseconds(time.max_gap) + nanoseconds(time.reorder)) {
    reader.fault("timeout", formatReal(time.timeout) + " is less than max_gap + reorder; must be >= " +
                                formatReal(time.max_gap) + " + " + formatReal(time.reorder) + " [s]");
  }
  reader.done();
}

void readPrecision(MapReader reader, Scene& scene) {
  if (const auto value = reader.real("time", positive("s"))) scene.time_precision = *value;
  if (const auto value = reader.real("distance", positive("m"))) scene.distance_precision = *value;
  reader.done();
}

void readStats(MapReader reader, Scene& scene) {
  if (const auto value = reader.real("period", positiveDuration())) scene.stats_period = *value;
  reader.done();
}

void readObjects(MapReader& top, ObjectContext context, Scene& scene, Faults& faults) {
  if (!top.has("objects")) {
    top.fault("", "no objects; write objects: with one entry per object");
    return;
  }
  MapReader reader = top.map("objects", "objects: {<name>: {pose: …, <shape>: …}}");
  if (!reader.good()) return;
  if (reader.entries().empty()) reader.fault("", "an empty scene; name at least one object");
  std::vector<std::string> names;
  for (const auto& entry : reader.entries()) names.push_back(entry.first);
  const std::set<std::string> watched = watchedObjects(top.find("pairs"), names);
  for (const auto& [name, node] : reader.entries()) {
    context.is_watched = watched.count(name) != 0;
    if (name.find('/') != std::string::npos) {
      reader.fault(name, "an object's name must not hold '/': it separates object and link");
      continue;
    }
    for (Object& part : readObject(name, node, context, faults, scene.warnings))
      scene.objects.push_back(std::move(part));
  }
  std::stable_sort(scene.objects.begin(), scene.objects.end(),
                   [](const Object& a, const Object& b) { return a.name < b.name; });
}

/// Of links that are in some pair.
void buildBodies(Scene& scene, Faults& faults) {
  const std::vector<std::vector<std::uint64_t>> pairs = scene.pairs.countByLink(scene.objects);
  for (std::size_t i = 0; i < pairs.size(); ++i)
    for (std::size_t k = 0; k < pairs[i].size(); ++k) {
      if (pairs[i][k] == 0) continue;
      Link& link = scene.objects[i].links[k];
      std::vector<geometry::PlacedShape> in_object = link.shapes;
      for (geometry::PlacedShape& shape : in_object) shape.origin = link.T_o_l * shape.origin;
      try {
        link.body = std::make_shared<geometry::Body>(std::move(in_object));
      } catch (const std::invalid_argument& error) {
        const std::string part =
            link.name.empty() || link.name == scene.objects[i].name ? "" : ": link '" + link.name + "'";
        faults.add(scene.file + ": objects/" + scene.objects[i].name + part + ": " + error.what());
      }
    }
}

}  // namespace

std::shared_ptr<const Scene> loadScene(const std::string& file, const Resources& resources,
                                       const Overrides& overrides) {
  Faults faults;
  const YamlNode root = readYaml(file, overrides, faults);
  // Text that is no YAML says nothing about keys: no second fault about missing objects.
  if (root.kind == YamlNode::Kind::kNull && !faults.empty()) faults.throwIfAny();

  auto scene = std::make_shared<Scene>();
  scene->file = file;
  MapReader top(&root, "", faults);
  if (const auto frame = top.text("world_frame")) {
    scene->world_frame = (*frame)[0] == '/' ? frame->substr(1) : *frame;
    if (scene->world_frame.empty()) top.fault("world_frame", "'/' is no frame; write the frame's name");
  }
  readPrecision(top.map("precision"), *scene);
  readTime(top.map("time"), scene->time);
  readStats(top.map("stats"), *scene);
  if (const auto budget = top.whole("node_budget", 1, std::int64_t{1} << 50)) {
    scene->node_budget = static_cast<std::uint64_t>(*budget);
  }
  readObjects(top, ObjectContext{folderOf(file), resources}, *scene, faults);
  readPairs(top.find("pairs"), *scene, faults);
  top.done();
  faults.throwIfAny();

  buildBodies(*scene, faults);
  faults.throwIfAny();
  const bool has_pairs = scene->pairs.count(scene->objects) > 0;
  if (!has_pairs) {
    scene->warnings.push_back(
        file +
        ": no pair is watched: no pose is read, nothing can be reported; give two objects, or see pairs");
  }
  const std::vector<Need> needs = needsOf(*scene);
  bool moves = false;
  for (std::size_t i = 0; i < needs.size(); ++i)
    moves =
        moves || (needs[i] == Need::kWatched && scene->objects[i].source.type != PoseSource::Type::kFixed);
  if (!moves && has_pairs) {
    scene->warnings.push_back(file +
                              ": no watched object moves: each pair is tested once, at the end, with stamp "
                              "0; give one a topic or tf");
  }
  return scene;
}

}  // namespace collision_node::scene

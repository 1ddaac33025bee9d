#include "collision_node/scene/file/object_reader.h"

#include <algorithm>
#include <sstream>

#include "collision_node/scene/file/map_reader.h"
#include "collision_node/scene/file/resources.h"
#include "collision_node/scene/file/source_reader.h"

namespace collision_node::scene {
namespace {

using geometry::LoadError;
using geometry::PlacedShape;
using geometry::SolidChoice;

const std::vector<std::string> kShapeKeys = {"point", "sphere", "box",  "cylinder", "capsule",
                                             "mesh",  "convex", "urdf", "param"};

std::string joinWords(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

void addLines(MapReader& reader, const std::string& key, const std::string& lines) {
  std::istringstream stream(lines);
  for (std::string line; std::getline(stream, line);) reader.fault(key, line);
}

class ObjectReader {
 public:
  ObjectReader(const YamlNode& node, const std::string& path, const ObjectContext& context, Faults& faults,
               std::vector<std::string>& warnings)
      : reader_(&node, path, faults), context_(context), warnings_(warnings) {}

  std::vector<Object> read(const std::string& name) {
    object_.name = name;
    if (!reader_.good()) return {std::move(object_)};
    readLinks();
    readMotion();
    readZones();
    std::vector<Object> parts = readSource(reader_, std::move(object_));
    warnOfBounds(parts.back());  // of several, it hangs on the others
    reader_.done();
    return parts;
  }

 private:
  // ---- shapes

  void readLinks() {
    std::vector<std::string> given;
    for (const std::string& key : kShapeKeys) {
      if (reader_.has(key)) given.push_back(key);
    }
    if (given.empty()) {
      reader_.fault("", "no shape; give exactly one of: " + joinWords(kShapeKeys));
      return;
    }
    if (given.size() > 1) {
      reader_.fault(
          "", "several shapes (" + joinWords(given) + "); give exactly one, or a urdf with several elements");
      return;
    }
    const std::string& key = given.front();
    if (key == "param") {
      if (const auto name = reader_.text("param")) readUrdfParameter(reader_, "param", *name);
    } else if (key == "urdf") {
      readUrdf();
    } else if (const std::optional<PlacedShape> shape = readShape(key)) {
      Link link;
      link.name = object_.name;
      link.shapes = {*shape};
      object_.links.push_back(std::move(link));
    }
  }

  std::optional<PlacedShape> readShape(const std::string& key) {
    std::optional<PlacedShape> result;
    const YamlNode& node = *reader_.find(key);
    if (node.kind != YamlNode::Kind::kMap && node.kind != YamlNode::Kind::kNull) {
      reader_.fault(key, describe(node) + " is not a map; write " + key + ": " + keysOf(key));
      return result;
    }
    MapReader shape = reader_.map(key);
    if (key == "point") {
      result = PlacedShape{geometry::Point{}, {}, key};
    } else if (key == "sphere") {
      if (const auto radius = needReal(shape, "radius", positive("m"))) {
        result = PlacedShape{geometry::Sphere{*radius}, {}, key};
      }
    } else if (key == "box") {
      if (const auto size = readSize(shape)) result = PlacedShape{geometry::Box{*size}, {}, key};
    } else if (key == "cylinder" || key == "capsule") {
      const bool is_capsule = key == "capsule";
      const auto radius = needReal(shape, "radius", positive("m"));
      const auto length = needReal(shape, "length", is_capsule ? notNegative("m") : positive("m"));
      if (radius && length && is_capsule) result = PlacedShape{geometry::Capsule{*radius, *length}, {}, key};
      if (radius && length && !is_capsule)
        result = PlacedShape{geometry::Cylinder{*radius, *length}, {}, key};
    } else {
      result = readMesh(shape, key == "convex");
    }
    shape.done();
    return shape.good() ? result : std::nullopt;
  }

  static const char* keysOf(const std::string& shape) {
    if (shape == "point") return "{}";
    if (shape == "sphere") return "{radius: <number>}";
    if (shape == "box") return "{size: [x, y, z]}";
    if (shape == "cylinder" || shape == "capsule") return "{radius: <number>, length: <number>}";
    return "{file: <path or package:// URI>}";
  }

  static std::optional<double> needReal(MapReader& reader, const std::string& key, const Limit& limit) {
    if (!reader.has(key)) reader.fault("", "no " + key + " given; write " + key + ": <number>");
    return reader.real(key, limit);
  }

  static std::optional<Vec3> readSize(MapReader& reader) {
    if (!reader.has("size")) reader.fault("", "no size given; write size: [x, y, z], full lengths [m]");
    const auto size = reader.vec3("size");
    if (!size) return {};
    for (int i = 0; i < 3; ++i) {
      if (!((*size)[i] > 0.0)) {
        reader.fault("size",
                     "element " + std::to_string(i) + " is " + formatReal((*size)[i]) + "; must be > 0 [m]");
        return {};
      }
    }
    return size;
  }

  std::optional<PlacedShape> readMesh(MapReader& shape, bool is_convex) {
    if (!shape.has("file")) shape.fault("", "no file given; write file: <path or package:// URI>");
    const auto file = shape.text("file");
    Vec3 scale = Vec3::Ones();
    if (const YamlNode* node = shape.find("scale")) {
      if (node->kind == YamlNode::Kind::kScalar) {
        const auto factor = shape.real("scale", {-std::numeric_limits<double>::max(), true, ""});
        if (factor) scale = Vec3::Constant(*factor);
      } else if (const auto factors = shape.vec3("scale")) {
        scale = *factors;
      }
      if (shape.good() && (scale.array() == 0.0).any()) {
        shape.fault("scale", "a factor is 0; must not be 0 (negative factors mirror)");
      }
    }
    SolidChoice solid = is_convex ? SolidChoice::kNo : SolidChoice::kAuto;
    if (!is_convex) {
      static const std::vector<std::string> words = {"auto", "yes", "no", "true", "false"};
      static constexpr SolidChoice kMeaning[] = {SolidChoice::kAuto, SolidChoice::kYes, SolidChoice::kNo,
                                                 SolidChoice::kYes, SolidChoice::kNo};
      if (const auto word = shape.choice("solid", words)) solid = kMeaning[*word];
    }
    if (!file || !shape.good()) return {};
    try {
      const auto mesh = getMesh(*file, context_.folder, scale, solid);
      if (is_convex) return PlacedShape{geometry::Convex{mesh}, {}, *file};
      return PlacedShape{geometry::Mesh{mesh}, {}, *file};
    } catch (const LoadError& error) {
      addLines(shape, "file", error.what());
      return {};
    }
  }

  /// Empty where nothing watches the object; the file must be there all the same.
  std::shared_ptr<const geometry::TriangleMesh> getMesh(const std::string& uri, const std::string& folder,
                                                        const Vec3& scale, SolidChoice solid) const {
    const std::string path = resolveUri(uri, folder, context_.resources);
    auto mesh = std::make_shared<geometry::TriangleMesh>();
    if (context_.is_watched) {
      *mesh = geometry::loadMesh(path, scale, solid);
    } else {
      geometry::checkMeshFile(path);
    }
    mesh->report.source = uri;
    return mesh;
  }

  // ---- URDF

  void readUrdf() {
    const YamlNode* node = reader_.find("urdf");
    if (node->kind == YamlNode::Kind::kMap) {
      MapReader urdf = reader_.map("urdf");
      const auto param = urdf.text("param");
      const auto file = urdf.text("file");
      if (urdf.has("param") == urdf.has("file")) {
        urdf.fault("",
                   "give exactly one of: file (a path or package:// URI), param (e.g. robot_description)");
      }
      urdf.done();
      if (!urdf.good()) return;
      if (param) readUrdfParameter(urdf, "param", *param);
      if (file) readUrdfFile(urdf, "file", *file);
    } else if (const auto file = reader_.text("urdf")) {
      readUrdfFile(reader_, "urdf", *file);
    }
  }

  void readUrdfFile(MapReader& reader, const std::string& key, const std::string& uri) {
    try {
      const std::string path = resolveUri(uri, context_.folder, context_.resources);
      addUrdf(reader, key, readFile(path), uri, folderOf(path));
    } catch (const LoadError& error) {
      addLines(reader, key, error.what());
    }
  }

  void readUrdfParameter(MapReader& reader, const std::string& key, const std::string& name) {
    std::string xml, why;
    try {
      if (context_.resources.parameter) xml = context_.resources.parameter(name);
    } catch (const std::exception& error) {
      why = std::string(" (") + error.what() + ")";
    }
    if (xml.empty()) {
      reader.fault(key, "parameter '" + name + "' is not set or cannot be read here" + why +
                            "; set it before the start, or name a file: urdf: <path or package:// URI>");
      return;
    }
    addUrdf(reader, key, xml, "parameter " + name, context_.folder);
  }

  void addUrdf(MapReader& reader, const std::string& key, const std::string& xml, const std::string& source,
               const std::string& folder) {
    const auto get_mesh = [&](const std::string& uri, const Vec3& scale) {
      return getMesh(uri, folder, scale, SolidChoice::kAuto);
    };
    geometry::UrdfModel model;
    try {
      model = geometry::parseUrdf(xml, source, get_mesh);
    } catch (const LoadError& error) {
      addLines(reader, key, error.what());
      return;
    }
    for (geometry::UrdfLink& urdf_link : model.links) {
      Link link;
      link.name = urdf_link.name;
      link.parent = urdf_link.parent;
      link.joint = std::move(urdf_link.joint);
      link.T_parent_l = urdf_link.T_parent_l;
      link.T_o_l = urdf_link.T_root_l;
      link.shapes = std::move(urdf_link.shapes);
      object_.links.push_back(std::move(link));
    }
    const bool has_shape = std::any_of(object_.links.begin(), object_.links.end(),
                                       [](const Link& link) { return !link.shapes.empty(); });
    if (!has_shape) reader.fault(key, source + ": no link has a collision element; at least one must");
    object_.movable_joints = std::move(model.movable_joints);
    for (const std::string& warning : model.warnings) warnings_.push_back(object_.name + ": " + warning);
  }

  // ---- motion

  void readMotion() {
    static constexpr MotionModel kModels[] = {MotionModel::kSlerp, MotionModel::kHermite, MotionModel::kSpin};
    if (const auto model = reader_.choice("motion", {"slerp", "hermite", "spin"}))
      object_.motion = kModels[*model];
    if (const auto word = reader_.choice("on_timeout", {"drop", "freeze"})) {
      object_.on_timeout = *word == 0 ? OnTimeout::kDrop : OnTimeout::kFreeze;
    }
    if (const auto speed = reader_.real("max_speed", positive("m/s"))) object_.max_speed = *speed;
    if (const auto spin = reader_.real("max_spin", positive("rad/s"))) object_.max_spin = *spin;
    if (const auto value = reader_.real("acceleration", notNegative("m/s^2"))) object_.acceleration = *value;
    if (const auto value = reader_.real("angular_acceleration", notNegative("rad/s^2"))) {
      object_.angular_acceleration = *value;
    }
    const bool asks_turning = reader_.has("angular_acceleration");
    if (asks_turning && !reader_.has("max_spin"))
      warnings_.push_back(object_.name +
                          ": angular_acceleration says nothing without max_spin: the model_ fields of events "
                          "stay NaN, and events are UNCERTIFIED, reason ALIAS");
  }

  void warnOfBounds(const Object& part) {
    const PoseSource::Type type = part.source.type;
    if ((type == PoseSource::Type::kTf || type == PoseSource::Type::kJoints) &&
        (reader_.has("acceleration") || reader_.has("angular_acceleration")))
      warnings_.push_back(
          part.name +
          ": a pose from tf or joints may be composed of several, at whose stamps the body need not have "
          "been there; accelerations are not used, the model_ fields of events stay NaN");
  }

  // ---- zones

  void readZones() {
    MapReader zones = reader_.map("zones");
    std::vector<std::string> link_names;
    for (const Link& link : object_.links) link_names.push_back(link.name);
    for (const auto& [name, node] : zones.entries()) {
      MapReader reader = zones.map(name);
      if (!reader.good()) continue;
      Zone zone;
      zone.name = name;
      if (reader.has("link")) {
        zone.link = reader.text("link").value_or("");
      } else if (link_names.size() == 1) {
        zone.link = link_names.front();
      } else if (!link_names.empty()) {
        reader.fault("", "no link given; write link: <one of the URDF's links>");
      }
      // Without links the geometry has a fault of its own, and any name would look unknown.
      const bool known = std::find(link_names.begin(), link_names.end(), zone.link) != link_names.end();
      if (!zone.link.empty() && !link_names.empty() && !known) {
        reader.fault("link", "unknown link '" + zone.link + "' of '" + object_.name + "'" +
                                 nearestHint(zone.link, link_names));
      }
      if (reader.has("box")) {
        MapReader box = reader.map("box");
        const auto size = box.good() ? readSize(box) : std::nullopt;
        const auto pose = box.pose();
        box.done();
        zone.has_box = true;
        if (size) zone.size = *size;
        if (pose) zone.pose = *pose;
      }
      reader.done();
      object_.zones.push_back(zone);
    }
  }

  MapReader reader_;
  const ObjectContext& context_;
  std::vector<std::string>& warnings_;
  Object object_;
};

}  // namespace

std::vector<Object> readObject(const std::string& name, const YamlNode& node, const ObjectContext& context,
                               Faults& faults, std::vector<std::string>& warnings) {
  return ObjectReader(node, "objects/" + name, context, faults, warnings).read(name);
}

}  // namespace collision_node::scene

#include <algorithm>
#include <cmath>
#include <locale>
#include <map>
#include <set>
#include <sstream>
#include <tuple>

#include "collision_node/scene/broad_phase/broad_phase.h"
#include "collision_node/scene/file/map_reader.h"
#include "collision_node/scene/needs.h"
#include "collision_node/scene/scene.h"

namespace collision_node::scene {
namespace {

namespace geo = geometry;

constexpr std::uint64_t kPairsListed = 10000;

std::string count(std::size_t n, const std::string& one, const std::string& many) {
  return std::to_string(n) + " " + (n == 1 ? one : many);
}

std::string formatVec3(const Vec3& v) {
  return "[" + formatReal(v.x()) + ", " + formatReal(v.y()) + ", " + formatReal(v.z()) + "]";
}

/// Six digits: what a float32 file holds, without its rounding noise.
std::string formatBriefly(double value, int digits) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text.precision(digits);
  text << value;
  return text.str();
}

std::string formatBriefly(const Vec3& v) {
  return "[" + formatBriefly(v.x(), 6) + ", " + formatBriefly(v.y(), 6) + ", " + formatBriefly(v.z(), 6) +
         "]";
}

std::string formatPose(const Pose& pose) {
  const geo::Quat& q = pose.orientation;
  std::string text = "at " + formatVec3(pose.position) + " m";
  if (q.x() != 0.0 || q.y() != 0.0 || q.z() != 0.0) {
    text += ", turned [" + formatReal(q.x()) + ", " + formatReal(q.y()) + ", " + formatReal(q.z()) + ", " +
            formatReal(q.w()) + "]";
  }
  return text;
}

const geo::TriangleMesh* meshOf(const geo::Shape& shape) {
  if (const auto* mesh = std::get_if<geo::Mesh>(&shape)) return mesh->mesh.get();
  if (const auto* convex = std::get_if<geo::Convex>(&shape)) return convex->mesh.get();
  return nullptr;
}

bool wasRead(const geo::TriangleMesh& mesh) { return mesh.report.triangles > 0; }

/// Short names for "mesh x sphere", long ones for the list of shapes.
struct ShapeWords {
  std::string kind, size;
};

ShapeWords wordsFor(const geo::PlacedShape& placed) {
  struct Visitor {
    const std::string& source;
    ShapeWords operator()(const geo::Point&) const { return {"point", ""}; }
    ShapeWords operator()(const geo::Sphere& s) const {
      return {"sphere", "radius " + formatReal(s.radius) + " m"};
    }
    ShapeWords operator()(const geo::Box& s) const { return {"box", "size " + formatVec3(s.size) + " m"}; }
    ShapeWords operator()(const geo::Cylinder& s) const {
      return {"cylinder", "radius " + formatReal(s.radius) + " m, length " + formatReal(s.length) + " m"};
    }
    ShapeWords operator()(const geo::Capsule& s) const {
      return {"capsule", "radius " + formatReal(s.radius) + " m, length " + formatReal(s.length) + " m"};
    }
    ShapeWords operator()(const geo::Mesh&) const { return {"mesh", source}; }
    ShapeWords operator()(const geo::Convex&) const { return {"convex", "hull of " + source}; }
  };
  return std::visit(Visitor{placed.source}, placed.shape);
}

std::string meshLine(const geo::TriangleMesh& mesh, bool is_hull) {
  const geo::MeshReport& report = mesh.report;
  std::string text = count(report.vertices, "vertex", "vertices") + ", " +
                     count(report.triangles, "triangle", "triangles") + "; ";
  if (is_hull) {
    text += "the hull of its vertices is a solid";
  } else if (report.closed) {
    text += mesh.solid ? "closed: a solid" : "closed, but a surface as the scene asks";
  } else {
    text += "open (" + count(report.open_edges, "open edge", "open edges") + ", " +
            count(report.odd_edges, "odd one", "odd ones") + "): a surface, nothing is inside it";
  }
  if (report.degenerate_triangles > 0)
    text += "; " + std::to_string(report.degenerate_triangles) + " degenerate";
  if (report.duplicate_triangles > 0)
    text += "; " + std::to_string(report.duplicate_triangles) + " duplicate";
  text += "; from " + formatBriefly(report.lower) + " to " + formatBriefly(report.upper) + " m";
  if (report.coordinate_rounding > 0.0) {
    text += "; the file reader's float32 moved no vertex by more than " +
            formatBriefly(report.coordinate_rounding, 2) + " m";
  }
  return text;
}

std::string sourceLine(const PoseSource& source) {
  switch (source.type) {
    case PoseSource::Type::kFixed:
      return "fixed " + formatPose(source.fixed);
    case PoseSource::Type::kTf:
      return "tf frame " + source.tf_frame;
    case PoseSource::Type::kJoints: {
      std::string text = "moved by joints";
      for (const PartJoint& joint : source.joints) {
        text += (&joint == &source.joints.front() ? " " : ", ") + joint.joint.name;
        if (joint.joint.driver != joint.joint.name) text += " (mimics " + joint.joint.driver + ")";
      }
      return text + " of topic " + source.topic;
    }
    case PoseSource::Type::kTopic:
      break;
  }
  std::string text = "topic " + source.topic;
  if (source.index >= 0) text += ", element " + std::to_string(source.index);
  if (!source.model.empty()) text += ", model " + source.model;
  if (!source.link.empty()) text += ", link " + source.link;
  return text;
}

const char* motionName(MotionModel model) {
  switch (model) {
    case MotionModel::kHermite:
      return "hermite";
    case MotionModel::kSpin:
      return "spin";
    case MotionModel::kSlerp:
      break;
  }
  return "slerp";
}

bool isFixed(const Object& object) { return object.source.type == PoseSource::Type::kFixed; }

class Plan {
 public:
  explicit Plan(const Scene& scene) : scene_(scene) {}

  std::string write() {
    out_ << "plan of " << scene_.file << "\n";
    out_ << "world frame: " << scene_.world_frame << "\n";
    out_ << "precision: time " << formatReal(scene_.time_precision) << " s, distance "
         << formatReal(scene_.distance_precision) << " m; at most " << scene_.node_budget
         << " node tests per pair and piece\n";
    out_ << "time: reorder " << formatReal(scene_.time.reorder) << " s, max_gap "
         << formatReal(scene_.time.max_gap) << " s, timeout " << formatReal(scene_.time.timeout)
         << " s, jump " << formatReal(scene_.time.jump) << " s; stats every "
         << formatReal(scene_.stats_period) << " s\n";
    std::set<std::string> names;
    for (const Object& object : scene_.objects) names.insert(object.name);
    out_ << "\nobjects (" << names.size() << "):\n";
    for (const Object& object : scene_.objects) writeObject(object);
    writePairs();
    writeFarPairs();
    writeUnwatched();
    writeLeftOut();
    out_ << "\nwarnings (" << scene_.warnings.size() << "):\n";
    for (const std::string& warning : scene_.warnings) out_ << "  " << warning << "\n";
    return out_.str();
  }

 private:
  void writeObject(const Object& object) {
    out_ << "  " << object.label() << ": " << sourceLine(object.source);
    if (!isFixed(object)) {
      out_ << "; motion " << motionName(object.motion) << "; on timeout "
           << (object.on_timeout == OnTimeout::kDrop ? "drop" : "freeze");
    }
    writeLimit("max_speed", object.max_speed, "m/s");
    writeLimit("max_spin", object.max_spin, "rad/s");
    writeLimit("acceleration", object.acceleration, "m/s^2");
    writeLimit("angular_acceleration", object.angular_acceleration, "rad/s^2");
    out_ << "\n";
    for (const Link& link : object.links) writeLink(link);
    for (const std::string& joint : object.movable_joints)
      out_ << "    movable joint " << joint << ": held at 0\n";
    for (const Zone& zone : object.zones) {
      out_ << "    zone " << zone.name << ": link " << zone.link;
      if (zone.has_box) out_ << ", box of size " << formatVec3(zone.size) << " m " << formatPose(zone.pose);
      out_ << "\n";
    }
  }

  void writeLimit(const char* name, double value, const char* unit) {
    if (std::isfinite(value)) out_ << "; " << name << " " << formatReal(value) << " " << unit;
  }

  void writeLink(const Link& link) {
    out_ << "    link " << link.name;
    if (!link.parent.empty()) out_ << ", child of " << link.parent;
    out_ << ", " << formatPose(link.T_o_l);
    if (link.shapes.empty()) out_ << ": no collision element, touches nothing";
    out_ << "\n";
    for (std::size_t i = 0; i < link.shapes.size(); ++i) {
      const geo::PlacedShape& shape = link.shapes[i];
      const ShapeWords words = wordsFor(shape);
      out_ << "      shape " << i << ": " << words.kind << (words.size.empty() ? "" : " " + words.size)
           << ", " << formatPose(shape.origin) << "\n";
      const geo::TriangleMesh* mesh = meshOf(shape.shape);
      if (mesh != nullptr && !wasRead(*mesh)) {
        out_ << "        not read: the object is in no watched pair\n";
      } else if (mesh != nullptr) {
        out_ << "        " << meshLine(*mesh, std::holds_alternative<geo::Convex>(shape.shape)) << "\n";
      }
    }
  }

  std::string nameOf(int object, int link) const {
    return scene_.objects[object].name + "/" + scene_.objects[object].links[link].name;
  }

  /// "mesh", or "{box, mesh}" for a link of several kinds.
  static std::string kindsOf(const Link& link) {
    std::set<std::string> kinds;
    for (const geo::PlacedShape& shape : link.shapes) kinds.insert(wordsFor(shape).kind);
    std::string text;
    for (const std::string& kind : kinds) text += (text.empty() ? "" : ", ") + kind;
    return kinds.size() == 1 ? text : "{" + text + "}";
  }

  /// A point or a sphere past nothing but triangles has a solver of its own: see StraightPath::of.
  static bool walksAlongPath(const Link& a, const Link& b) {
    const auto isVertex = [](const Link& link) {
      return link.shapes.size() == 1 && (std::holds_alternative<geo::Point>(link.shapes[0].shape) ||
                                         std::holds_alternative<geo::Sphere>(link.shapes[0].shape));
    };
    const auto isMesh = [](const Link& link) {
      return std::all_of(link.shapes.begin(), link.shapes.end(), [](const geo::PlacedShape& shape) {
        return std::holds_alternative<geo::Mesh>(shape.shape);
      });
    };
    return (isVertex(a) && isMesh(b)) || (isMesh(a) && isVertex(b));
  }

  void writeFarPairs() {
    const std::size_t count = scene_.objects.size();
    out_ << "far pairs: not solved until their objects have travelled what keeps them apart; ";
    if (hasBroadPhase(scene_)) {
      out_ << "broad phase: of " << count << " objects, pairs exist only where two may meet\n";
    } else {
      out_ << "no broad phase: " << (scene_.pairs.watchesRest() ? "few objects" : "pairs/only lists them")
           << ", every pair exists\n";
    }
  }

  void writePairs() {
    const std::uint64_t count = scene_.pairs.count(scene_.objects);
    out_ << "\npairs watched (" << count << "):\n";
    if (count > kPairsListed) {
      out_ << "  too many to list; every link of an object against those of every other, but for "
           << scene_.pairs.exceptions().size() << " pairs of objects with rules of their own\n";
      return;
    }
    for (const LinkPair& pair : scene_.pairs.list(scene_.objects)) {
      const Object& a = scene_.objects[pair.object_a];
      const Object& b = scene_.objects[pair.object_b];
      out_ << "  " << nameOf(pair.object_a, pair.link_a) << " x " << nameOf(pair.object_b, pair.link_b)
           << ": certified: " << kindsOf(a.links[pair.link_a]) << " x " << kindsOf(b.links[pair.link_b]);
      if (walksAlongPath(a.links[pair.link_a], b.links[pair.link_b]))
        out_ << ", along the path while it is straight and the mesh does not turn";
      if (pair.object_a == pair.object_b) {
        out_ << ", links of one object: one static test";
      } else if (isFixed(a) && isFixed(b)) {
        out_ << ", both fixed: one static test";
      }
      if (pair.contact_distance > 0.0)
        out_ << ", touching within " << formatReal(pair.contact_distance) << " m";
      out_ << "\n";
    }
  }

  /// A robot of fifty links has a thousand pairs within itself: one line per two objects and reason.
  void writeUnwatched() {
    std::uint64_t links = 0, all = 0;
    for (const Object& object : scene_.objects) {
      const std::uint64_t own = linksWithShapes(object).size();
      all += links * own + own * (own - (own > 0 ? 1 : 0)) / 2;
      links += own;
    }
    const std::uint64_t count = all - scene_.pairs.count(scene_.objects);
    out_ << "\npairs left out (" << count << "):\n";
    std::uint64_t told = 0;
    std::map<std::tuple<std::string, std::string, std::string>, std::vector<const LinkPair*>> groups;
    for (const auto& [objects, verdicts] : scene_.pairs.exceptions())
      for (const PairVerdict& verdict : verdicts)
        if (!verdict.against.empty())
          groups[{scene_.objects[objects.first].name, scene_.objects[objects.second].name, verdict.against}]
              .push_back(&verdict.pair);
    for (const auto& [key, pairs] : groups) {
      const auto& [a, b, reason] = key;
      told += pairs.size();
      const LinkPair& first = *pairs.front();
      if (pairs.size() == 1) {
        out_ << "  " << nameOf(first.object_a, first.link_a) << " x " << nameOf(first.object_b, first.link_b);
      } else {
        out_ << "  " << a << " x " << b << ", " << pairs.size() << " pairs of links";
      }
      out_ << ": " << reason << "\n";
    }
    if (told < count)
      out_ << "  " << (told > 0 ? "all others" : "all") << ": " << scene_.pairs.reasonAgainstRest() << "\n";
  }

  void writeLeftOut() {
    bool mesh = false, zone = false, topic = false, tf = false;
    const std::vector<Need> needs = needsOf(scene_);
    const std::vector<std::string> left_out = leftOut(scene_);
    const bool has_pairs = scene_.pairs.count(scene_.objects) > 0;
    for (std::size_t i = 0; i < needs.size(); ++i) {
      const Object& object = scene_.objects[i];
      for (const Link& link : object.links)
        for (const geo::PlacedShape& shape : link.shapes)
          mesh = mesh || (meshOf(shape.shape) != nullptr && wasRead(*meshOf(shape.shape)));
      if (needs[i] == Need::kNone) continue;
      zone = zone || !object.zones.empty();
      topic = topic || !object.source.topic.empty();
      tf = tf || object.source.type == PoseSource::Type::kTf;
    }
    out_ << "\nnot needed:\n";
    if (!mesh) out_ << "  no mesh: assimp is not called, no triangles are kept\n";
    if (!tf) out_ << "  no object is driven through tf: no transforms are read\n";
    if (!topic) out_ << "  no object has a pose topic: none is subscribed\n";
    if (!zone) out_ << "  no zone: events name links only\n";
    for (const std::string& line : left_out) out_ << "  " << line << "\n";
    if (mesh && tf && topic && zone && has_pairs && left_out.empty())
      out_ << "  nothing: all parts are used\n";
    if (!has_pairs) out_ << "  no pair: nothing is solved\n";
  }

  const Scene& scene_;
  std::ostringstream out_;
};

}  // namespace

std::string planText(const Scene& scene) { return Plan(scene).write(); }

}  // namespace collision_node::scene

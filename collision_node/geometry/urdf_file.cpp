#include "collision_node/geometry/urdf_file.h"

#include <console_bridge/console.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <cmath>
#include <locale>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <sstream>
#include <tuple>
#include <utility>

namespace collision_node::geometry {
namespace {

/// urdfdom explains its errors only to console_bridge's process-wide handler: this one keeps them.
class CapturedLog : public console_bridge::OutputHandler {
 public:
  CapturedLog() : lock_(mutex()), previous_(console_bridge::getOutputHandler()) {
    console_bridge::useOutputHandler(this);
  }
  ~CapturedLog() override { console_bridge::useOutputHandler(previous_); }
  CapturedLog(const CapturedLog&) = delete;
  CapturedLog& operator=(const CapturedLog&) = delete;

  void log(const std::string& text, console_bridge::LogLevel level, const char*, int) override {
    if (level < console_bridge::CONSOLE_BRIDGE_LOG_ERROR) return;
    errors_.push_back(text);
    std::replace(errors_.back().begin(), errors_.back().end(), '\n', ' ');
  }
  const std::vector<std::string>& errors() const { return errors_; }

 private:
  static std::mutex& mutex() {
    static std::mutex instance;
    return instance;
  }
  std::lock_guard<std::mutex> lock_;
  console_bridge::OutputHandler* previous_;
  std::vector<std::string> errors_;
};

std::string join(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += (text.empty() ? "" : "\n") + line;
  return text;
}

std::string format(double value) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text << value;
  return text.str();
}

Vec3 toVec3(const urdf::Vector3& v) { return {v.x, v.y, v.z}; }

class Builder {
 public:
  Builder(const std::string& source, const GetMesh& get_mesh) : source_(source), get_mesh_(get_mesh) {}

  UrdfModel build(const urdf::ModelInterface& parsed) {
    model_.name = parsed.getName();
    addLink(*parsed.getRoot(), {}, Pose{}, "");
    for (UrdfLink& link : model_.links) followMimics(link.joint);
    if (!faults_.empty()) throw LoadError(join(faults_));
    return std::move(model_);
  }

 private:
  void fault(const std::string& where, const std::string& what) {
    faults_.push_back(source_ + ": " + where + ": " + what);
  }

  Pose toPose(const urdf::Pose& pose, const std::string& where) {
    const Pose result{toVec3(pose.position),
                      Quat(pose.rotation.w, pose.rotation.x, pose.rotation.y, pose.rotation.z)};
    if (!result.position.allFinite() || !result.orientation.coeffs().allFinite()) {
      fault(where, "origin is not finite; xyz [m] and rpy [rad] must be finite numbers");
      return {};
    }
    return {result.position, result.orientation.normalized()};
  }

  static UrdfJoint toJoint(const urdf::Joint& joint) {
    using Kind = UrdfJoint::Kind;
    static const std::map<int, Kind> kinds = {{urdf::Joint::FIXED, Kind::kFixed},
                                              {urdf::Joint::REVOLUTE, Kind::kRevolute},
                                              {urdf::Joint::CONTINUOUS, Kind::kContinuous},
                                              {urdf::Joint::PRISMATIC, Kind::kPrismatic}};
    UrdfJoint result;
    result.name = result.driver = joint.name;
    const auto kind = kinds.find(joint.type);
    result.kind = kind == kinds.end() ? Kind::kOther : kind->second;
    if (result.kind == Kind::kFixed) return result;
    const Vec3 axis = toVec3(joint.axis);
    if (result.kind == Kind::kOther)
      result.fault = "is planar or floating: no single position says where its link is";
    else if (!axis.allFinite() || axis.isZero(0.0))
      result.fault = "has the axis " + format(axis.x()) + " " + format(axis.y()) + " " + format(axis.z()) +
                     "; it must be finite and not zero";
    else
      result.axis = axis.stableNormalized();
    if (!joint.mimic) return result;
    result.driver = joint.mimic->joint_name;
    result.multiplier = joint.mimic->multiplier;
    result.offset = joint.mimic->offset;
    if (result.driver == joint.name) result.fault = "mimics itself";
    if (!std::isfinite(result.multiplier) || !std::isfinite(result.offset))
      result.fault = "mimics with a multiplier or offset that is not finite";
    return result;
  }

  /// A joint that mimics one that mimics another follows the one that moves by itself.
  void followMimics(UrdfJoint& joint) const {
    UrdfJoint result = joint;
    std::set<std::string> passed{joint.name};
    const bool mimics = joint.driver != joint.name;
    while (mimics && joint.fault.empty()) {
      const auto next = std::find_if(model_.links.begin(), model_.links.end(),
                                     [&](const UrdfLink& link) { return link.joint.name == result.driver; });
      if (next == model_.links.end() || next->joint.kind == UrdfJoint::Kind::kFixed) {
        joint.fault = "mimics '" + result.driver + "', which is no movable joint";
      } else if (!passed.insert(result.driver).second) {
        joint.fault = "mimics a joint that mimics it in turn";
      } else if (next->joint.driver == next->joint.name) {
        joint = result;
        return;
      } else {
        result.offset += result.multiplier * next->joint.offset;
        result.multiplier *= next->joint.multiplier;
        result.driver = next->joint.driver;
      }
    }
  }

  void addLink(const urdf::Link& link, const UrdfJoint& joint, const Pose& T_parent_l,
               const std::string& parent) {
    if (!seen_.insert(link.name).second) {  // also what ends a ring of joints
      fault("link '" + link.name + "'", "is the child of more than one joint; a link hangs from exactly one");
      return;
    }
    UrdfLink result;
    result.name = link.name;
    result.parent = parent;
    result.joint = joint;
    result.T_parent_l = T_parent_l;
    result.T_root_l = parent.empty() ? Pose{} : T_root_l_.at(parent) * T_parent_l;
    T_root_l_[link.name] = result.T_root_l;
    for (std::size_t i = 0; i < link.collision_array.size(); ++i) {
      const urdf::Collision& collision = *link.collision_array[i];
      const std::string where = "link '" + link.name + "', collision element " + std::to_string(i);
      const Pose origin = toPose(collision.origin, where);
      if (const std::optional<PlacedShape> shape = readGeometry(*collision.geometry, where)) {
        result.shapes.push_back({shape->shape, origin, shape->source});
      }
    }
    if (link.collision_array.empty()) {
      model_.warnings.push_back(source_ + ": link '" + link.name +
                                "' has no collision element: it has no shape and touches nothing");
    }
    model_.links.push_back(std::move(result));
    for (const auto& joint : link.child_joints) {
      if (joint->type != urdf::Joint::FIXED) model_.movable_joints.push_back(joint->name);
      const Pose T_l_child = toPose(joint->parent_to_joint_origin_transform, "joint '" + joint->name + "'");
      // The link's own vector is in the same order as its joints' only by accident: go by name.
      for (const auto& child : link.child_links) {
        if (child->name == joint->child_link_name) addLink(*child, toJoint(*joint), T_l_child, link.name);
      }
    }
  }

  bool isPositive(double value, const char* name, const std::string& where) {
    if (std::isfinite(value) && value > 0.0) return true;
    fault(where, std::string(name) + " is " + format(value) + "; it must be > 0 and finite [m]");
    return false;
  }

  std::optional<PlacedShape> readGeometry(const urdf::Geometry& geometry, const std::string& where) {
    switch (geometry.type) {
      case urdf::Geometry::SPHERE: {
        const auto& sphere = static_cast<const urdf::Sphere&>(geometry);
        if (!isPositive(sphere.radius, "sphere radius", where)) return {};
        return PlacedShape{Sphere{sphere.radius}, {}, "sphere"};
      }
      case urdf::Geometry::BOX: {
        const Vec3 size = toVec3(static_cast<const urdf::Box&>(geometry).dim);
        bool good = isPositive(size.x(), "box size x", where);
        good &= isPositive(size.y(), "box size y", where);
        good &= isPositive(size.z(), "box size z", where);
        if (!good) return {};
        return PlacedShape{Box{size}, {}, "box"};
      }
      case urdf::Geometry::CYLINDER: {
        const auto& cylinder = static_cast<const urdf::Cylinder&>(geometry);
        bool good = isPositive(cylinder.radius, "cylinder radius", where);
        good &= isPositive(cylinder.length, "cylinder length", where);
        if (!good) return {};
        return PlacedShape{Cylinder{cylinder.radius, cylinder.length}, {}, "cylinder"};
      }
      case urdf::Geometry::MESH: {
        const auto& mesh = static_cast<const urdf::Mesh&>(geometry);
        return readMesh(mesh.filename, toVec3(mesh.scale), where);
      }
    }
    fault(where, "geometry of a kind that is not known here; use box, cylinder, sphere or mesh");
    return {};
  }

  std::optional<PlacedShape> readMesh(const std::string& uri, const Vec3& scale, const std::string& where) {
    if (!scale.allFinite() || (scale.array() == 0.0).any()) {
      fault(where, "mesh scale is " + format(scale.x()) + " " + format(scale.y()) + " " + format(scale.z()) +
                       "; it must be three finite numbers, none of them 0");
      return {};
    }
    const auto key = std::make_tuple(uri, scale.x(), scale.y(), scale.z());
    auto found = meshes_.find(key);
    if (found == meshes_.end()) {
      std::shared_ptr<const TriangleMesh> mesh;
      try {
        mesh = get_mesh_(uri, scale);
      } catch (const LoadError& error) {
        fault(where, error.what());
      }
      found = meshes_.emplace(key, std::move(mesh)).first;
    }
    if (!found->second) return {};
    return PlacedShape{Mesh{found->second}, {}, uri};
  }

  const std::string& source_;
  const GetMesh& get_mesh_;
  UrdfModel model_;
  std::vector<std::string> faults_;
  std::set<std::string> seen_;
  std::map<std::string, Pose> T_root_l_;  // by link
  std::map<std::tuple<std::string, double, double, double>, std::shared_ptr<const TriangleMesh>> meshes_;
};

/// Joints that form a ring hang from no root, so a walk from the root would leave their links out without a
/// word.
void checkAllReached(const urdf::ModelInterface& parsed, const UrdfModel& model, const std::string& source) {
  std::vector<std::string> faults;
  for (const auto& [name, link] : parsed.links_) {
    bool reached = false;
    for (const UrdfLink& known : model.links) reached = reached || known.name == name;
    if (!reached) {
      faults.push_back(
          source + ": link '" + name +
          "' is not connected to the root link; every link but the root must be the child of one joint");
    }
  }
  if (!faults.empty()) throw LoadError(join(faults));
}

}  // namespace

UrdfModel parseUrdf(const std::string& xml, const std::string& source, const GetMesh& get_mesh) {
  urdf::ModelInterfaceSharedPtr parsed;
  std::vector<std::string> errors;
  {
    CapturedLog log;
    parsed = urdf::parseURDF(xml);
    errors = log.errors();
  }
  // urdfdom may log an error and go on without the element (a link's shapes after a bad one, for example):
  // what it complains about is refused, or a shape would be missing without a word.
  const bool unusable = !parsed || !parsed->getRoot();
  if (unusable && errors.empty()) errors.push_back("not a URDF: no <robot> with one root link");
  if (!errors.empty()) {
    for (std::string& line : errors) line = source + ": " + line;
    throw LoadError(join(errors));
  }
  UrdfModel model = Builder(source, get_mesh).build(*parsed);
  checkAllReached(*parsed, model, source);
  return model;
}

}  // namespace collision_node::geometry

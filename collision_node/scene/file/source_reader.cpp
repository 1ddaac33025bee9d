#include "collision_node/scene/file/source_reader.h"

#include <set>
#include <utility>

#include "collision_node/scene/file/moving_parts.h"

namespace collision_node::scene {
namespace {

/// tf2 knows no leading slash; ROS users still write it.
std::string withoutLeadingSlash(const std::string& frame) {
  return frame[0] == '/' ? frame.substr(1) : frame;
}

bool endsWith(const std::string& text, const std::string& end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

class SourceReader {
  static constexpr const char* kForms = "pose: {topic: …}, {tf: …} or {fixed: {position: …, orientation: …}}";

 public:
  SourceReader(MapReader& reader, Object whole) : reader_(reader), whole_(std::move(whole)) {}

  std::vector<Object> read() {
    const bool has_joints = reader_.has("joints");
    if (!reader_.has("pose")) {
      reader_.fault("", std::string("no pose; write ") + kForms);
    } else {
      MapReader pose = reader_.map("pose", kForms);
      if (pose.good()) readPose(pose);
      if (links_ && has_joints)
        pose.fault("links", "links: true and joints both say how the links move; give one of them");
    }
    if (has_joints) readJoints();
    if (!parts_.empty()) return std::move(parts_);
    return {std::move(whole_)};
  }

 private:
  void readPose(MapReader& pose) {
    PoseSource& source = whole_.source;
    const int kinds = pose.has("topic") + pose.has("tf") + pose.has("fixed");
    if (kinds != 1) pose.fault("", "give exactly one of: topic, tf, fixed; found " + std::to_string(kinds));
    if (const auto topic = pose.text("topic")) {
      source.type = PoseSource::Type::kTopic;
      source.topic = *topic;
    }
    if (const auto frame = pose.text("tf")) {
      source.type = PoseSource::Type::kTf;
      source.tf_frame = withoutLeadingSlash(*frame);
      if (source.tf_frame.empty()) pose.fault("tf", "'/' is no frame; write the frame's name");
    }
    if (pose.has("fixed")) {
      MapReader fixed =
          pose.map("fixed", "fixed: {position: [x, y, z], orientation: [x, y, z, w]} or fixed: {}");
      if (const auto value = fixed.pose()) source.fixed = *value;
      fixed.done();
    }
    readSelection(pose);
    readLinks(pose);
    pose.done();
  }

  /// The keys that pick one object out of a message with many.
  void readSelection(MapReader& pose) {
    PoseSource& source = whole_.source;
    if (const auto index = pose.whole("index", 0, 1000000)) source.index = static_cast<int>(*index);
    if (const auto model = pose.text("model")) source.model = *model;
    if (const auto link = pose.text("link")) source.link = *link;
    for (const char* key : {"index", "model", "link"}) {
      if (!pose.has(key) || pose.has("topic")) continue;
      const bool means_links = std::string(key) == "link" && pose.has("tf");
      pose.fault(key, means_links ? "only meant beside topic; links: true moves each link by its tf frame"
                                  : "only meant beside topic; remove it");
    }
    if (pose.has("index") + pose.has("model") + pose.has("link") > 1) {
      pose.fault(
          "",
          "give at most one of: index (PoseArray), model (ModelStates), link (LinkStates, as model::link)");
    }
  }

  // ---- links that move by themselves

  /// What must hold for an object of several parts. Links that failed to load have faults of their own.
  bool canBeCut(MapReader& reader, const std::string& key) {
    if (whole_.links.empty()) return false;
    if (!reader_.has("urdf") && !reader_.has("param")) {
      reader.fault(key, "only a urdf has links that move; remove it, or give the shape as a urdf");
      return false;
    }
    if (whole_.motion != MotionModel::kSlerp) {
      reader_.fault("motion",
                    "links that move by themselves move by slerp: their poses are composed and have "
                    "no twists; remove it");
      return false;
    }
    return true;
  }

  void readLinks(MapReader& pose) {
    links_ = pose.flag("links").value_or(false);
    const auto prefix = pose.text("tf_prefix");
    if (links_ && !pose.has("tf"))
      pose.fault("links", "links: true is only meant beside tf; remove it or write tf: <root frame>");
    if (prefix && !links_) pose.fault("tf_prefix", "only meant beside links: true; remove it");
    if (!links_ || !pose.good() || !canBeCut(pose, "links")) return;
    const std::string& root = whole_.links.front().name;
    const std::string& frame = whole_.source.tf_frame;
    const bool has_name = frame == root || endsWith(frame, "/" + root);
    if (!prefix && !has_name) {
      pose.fault("tf", "'" + frame +
                           "' does not end in the root link's name, so the other links' frames are "
                           "not known; write tf: [<prefix>/]" +
                           root +
                           ", or add tf_prefix: <what stands before "
                           "each link's name, or / for nothing>");
      return;
    }
    const std::string before =
        prefix ? withoutLeadingSlash(*prefix) : frame.substr(0, frame.size() - root.size());
    parts_ = cutIntoParts(whole_);
    for (Object& part : parts_)
      if (part.part != root) part.source.tf_frame = before + part.part;
  }

  void readJoints() {
    MapReader joints = reader_.map("joints");
    if (!joints.good()) return;
    const auto topic = joints.text("topic");
    if (!joints.has("topic")) joints.fault("", "no topic; write joints: {topic: joint_states}");
    joints.done();
    if (!topic || links_ || !canBeCut(reader_, "joints")) return;
    parts_ = cutIntoParts(whole_);
    for (Object& part : parts_) {
      if (part.part == whole_.links.front().name) continue;
      part.source = PoseSource();
      part.source.type = PoseSource::Type::kJoints;
      part.source.topic = *topic;
      part.source.joints = jointsTo(whole_, part.part);
      for (const PartJoint& joint : part.source.joints) {
        const std::string& fault = joint.joint.fault;
        const std::string line = "joint '" + joint.joint.name + "' " + fault +
                                 "; joint states cannot move it: give pose: {tf: <root frame>, links: true}";
        if (!fault.empty() && told_.insert(line).second) joints.fault("", line);
      }
    }
  }

  MapReader& reader_;
  Object whole_;
  bool links_ = false;
  std::vector<Object> parts_;
  std::set<std::string> told_;
};

}  // namespace

std::vector<Object> readSource(MapReader& reader, Object whole) {
  return SourceReader(reader, std::move(whole)).read();
}

}  // namespace collision_node::scene

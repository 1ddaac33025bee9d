/// Poses of objects that are driven through frames: the frame tree, reduced to what the scene asks for.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "collision_node/messages/pose_reader.h"
#include "collision_node/scene/tracks/composed_path.h"

namespace collision_node::messages {

/// A tree that cannot carry an object's pose; what() is one line that names the frames.
struct TfError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Collects transforms and hands out, for each followed frame, its pose in the world at exact stamps; nothing
/// is "latest". With one moving edge, next to the frame, its samples are handed out as they come, composed
/// with the static edges before it. With more, or with static edges behind it, a scene::ComposedPath is: at
/// the union of the edges' stamps, once every edge has delivered past them. With none the pose comes once,
/// for all time.
///
/// Samples that arrive before the chain to the world is known are kept (the newest kKept of each edge) and
/// handed out in arrival order once it is. What is wrong with frames on no followed chain does not matter, as
/// for any other listener of tf. No ROS types, no clock; frames are named without a leading slash.
class TfTree {
 public:
  using Nanoseconds = motion::Nanoseconds;
  using Pose = geometry::Pose;
  /// Called with a pose world <- frame. A transform that is not finite or not a rotation is handed on as it
  /// is, so that whoever counts bad poses sees it.
  using Sink = std::function<void(int object, const motion::StampedPose& pose, StampKind kind)>;

  static constexpr std::size_t kKept = 10000;

  TfTree(std::string world_frame, const scene::TimeOptions& time, Sink sink);

  /// From now on, `object` follows `frame`, which errors call `label`.
  void follow(int object, const std::string& frame, const std::string& label);
  void follow(int object, const std::string& frame) { follow(object, frame, frame); }

  /// A moving edge whose samples are still to come: what hangs on it can be connected.
  void announce(const std::string& parent, const std::string& child);

  /// One transform parent <- child; a twist stands in the parent's axes. Throws TfError when this concerns a
  /// followed frame: a frame between it and the world gets another parent (the first one stands), is sent
  /// both as static (kAlways) and as moving, is its own parent, or has a bad static transform. After a throw
  /// the tree is still usable.
  void add(const std::string& parent, const std::string& child, const motion::StampedPose& pose,
           StampKind kind);

  /// The end: composed paths hand out all they can. More may follow.
  void flush();
  /// /clock went back: composed paths hand out what they have and begin anew.
  void clockWentBack();

  /// What the tracks of the chains' edges dropped: late, duplicate. An edge of several chains counts once.
  scene::InputCounts dropped() const;
  /// All that the poses it hands out later depend on, of frames whose chain is known.
  void describe(scene::Fingerprint& to) const;

  /// Labels of followed frames whose chain to the world is not known yet.
  std::vector<std::string> unresolved() const;
  /// Every frame seen, in byte order.
  std::vector<std::string> frames() const;

 private:
  struct Sample {
    std::uint64_t arrival = 0;
    motion::StampedPose pose;
    StampKind kind = StampKind::kSent;
  };
  struct Edge {  // of a child to its parent
    std::string parent;
    bool is_static = false;
    Pose pose;                // is_static
    std::deque<Sample> kept;  // !is_static: while a followed frame is unresolved
  };
  struct Follower {
    int object = -1;
    std::string frame, label;
    bool resolved = false;
    // From the world to the common ancestor, children whose edge is inverted; from there to the frame.
    std::vector<std::string> up, down;
    std::map<std::string, int> moving;  // child of a moving edge -> its number in `path`
    Pose before;                        // without `path`: world <- parent of the one moving edge
    bool is_bare = false;               // without `path`: nothing is before it
    std::unique_ptr<scene::ComposedPath> path;
  };

  void addStatic(const std::string& parent, const std::string& child, const Pose& pose);
  void addMoving(const std::string& parent, const std::string& child, const Sample& sample);
  void refuse(const std::string& child, const std::string& fault);
  void checkConflicts(const std::vector<std::string>& chain, std::size_t count) const;
  bool resolve(Follower& follower) const;
  void prepare(Follower& follower) const;
  void handOutKept(const Follower& follower) const;
  void resolveAll();
  void emit(const Follower& follower, const std::string& child, const Sample& sample) const;
  std::vector<std::string> chainToRoot(const std::string& frame) const;

  std::string world_;
  scene::TimeOptions time_;
  Sink sink_;
  std::uint64_t arrivals_ = 0;
  std::map<std::string, Edge> edges_;
  std::map<std::string, std::string> conflicts_;  // by child: why the edge above it cannot be trusted
  std::vector<Follower> followers_;
};

}  // namespace collision_node::messages

/// Poses of objects that are driven through tf: the frame tree, reduced to what the scene asks for.
#pragma once

#include <deque>
#include <functional>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "collision_node/motion/stamped_pose.h"

namespace collision_node::messages {

/// A tree that cannot carry an object's pose; what() is one line that names the frames.
struct TfError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Collects transforms and hands out, for each followed frame, its pose in the world at the exact stamps of
/// the one moving edge between them; static edges are composed with it. Nothing is interpolated, nothing is
/// "latest".
///
/// Samples that arrive before the chain to the world is known are kept (the newest kKept of each edge) and
/// handed out in arrival order once it is. Not covered, and refused: two or more moving edges on one chain.
/// What is wrong with frames on no followed chain does not matter, as for any other listener of tf.
/// No ROS types, no clock; frames are named without a leading slash.
class TfTree {
 public:
  using Nanoseconds = motion::Nanoseconds;
  using Pose = geometry::Pose;
  /// Called with a pose world <- frame. A transform that is not finite or not a rotation is handed on as it
  /// is, so that whoever counts bad poses sees it.
  using Sink = std::function<void(int object, const motion::StampedPose& pose)>;

  static constexpr std::size_t kKept = 10000;

  TfTree(std::string world_frame, Sink sink);

  /// From now on, `object` follows `frame`.
  void follow(int object, const std::string& frame);

  /// One transform parent <- child. Throws TfError when this concerns a followed frame: a frame between it
  /// and the world gets another parent (the first one stands), is sent both as static and as moving, is its
  /// own parent, or has a bad static transform; or the chain has no moving edge, or more than one. After a
  /// throw the tree is still usable.
  void add(const std::string& parent, const std::string& child, Nanoseconds stamp_ns, const Pose& pose,
           bool is_static);

  /// Followed frames whose chain to the world is not known yet.
  std::vector<std::string> unresolved() const;
  /// Every frame seen, in byte order.
  std::vector<std::string> frames() const;

 private:
  struct Sample {
    Nanoseconds stamp_ns;
    Pose pose;
  };
  struct Edge {  // of a child to its parent
    std::string parent;
    bool is_static = false;
    Pose pose;                // is_static
    std::deque<Sample> kept;  // !is_static: while a followed frame is unresolved
  };
  struct Follower {
    int object = -1;
    std::string frame;
    bool resolved = false;
    std::vector<std::string>
        up;  // from the world towards the common ancestor: children whose edge is inverted
    std::vector<std::string> down;  // from the common ancestor to the frame: children in walking order
    std::string moving;             // the child of the one moving edge
  };

  void addStatic(const std::string& parent, const std::string& child, const Pose& pose);
  void addMoving(const std::string& parent, const std::string& child, const Sample& sample);
  void refuse(const std::string& child, const std::string& fault);
  void checkConflicts(const std::vector<std::string>& chain, std::size_t count) const;
  bool resolve(Follower& follower) const;
  void resolveAll();
  void emit(const Follower& follower, const Sample& sample) const;
  std::vector<std::string> chainToRoot(const std::string& frame) const;

  std::string world_;
  Sink sink_;
  std::map<std::string, Edge> edges_;
  std::map<std::string, std::string> conflicts_;  // by child: why the edge above it cannot be trusted
  std::vector<Follower> followers_;
};

}  // namespace collision_node::messages

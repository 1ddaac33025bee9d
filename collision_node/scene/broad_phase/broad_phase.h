/// Who may meet whom, among many objects: each object has stays, boxes that it is proved to be in for a
/// stretch of time, in a tree of all that move; those that stand for ever are in a tree of their own.
///
/// Guarantee (docs/broad_phase.md): two objects that no call of move() has named to each other, since the
/// epoch began or since mayMeet() said no, are apart in all the time that both have been told of. No stamp of
/// one object costs another anything: a stay lasts until its object leaves it, and fast objects have one
/// thick line for each segment.
#pragma once

#include <cstdint>
#include <vector>

#include "collision_node/motion/stamped_pose.h"
#include "collision_node/scene/broad_phase/box_tree.h"
#include "collision_node/scene/broad_phase/endings.h"
#include "collision_node/scene/broad_phase/sweep.h"

namespace collision_node::scene {

using motion::Nanoseconds;

struct Scene;

/// Many objects, and no list of who matters: pairs exist only where two may meet.
bool hasBroadPhase(const Scene& scene);

class BroadPhase {
 public:
  explicit BroadPhase(std::size_t objects) : objects_(objects) {}

  /// These objects stand in their boxes for ever, through all epochs. To be called once, before all others.
  void stand(const std::vector<int>& objects, const std::vector<Bounds>& boxes);
  /// Standing objects whose boxes meet `box`.
  const std::vector<int>& standingNear(const Bounds& box);

  /// Nothing is known of those that move.
  void startEpoch();

  /// From `from_ns` to `to_ns` the object is within `sweep`; before that, unless it `begins_anew`, it was
  /// within the sweep of its last call, which ended at `from_ns`. Returns whom it may meet that it was told
  /// apart from until now; the list holds until the next call.
  const std::vector<int>& move(int object, const Sweep& sweep, Nanoseconds from_ns, Nanoseconds to_ns,
                               bool begins_anew);
  /// From `from_ns` on the object is within `box`, until its next call.
  const std::vector<int>& stay(int object, const Bounds& box, Nanoseconds from_ns);
  /// False when the object has left its last box, or its last call ended with its segment.
  bool isStaying(int object) const { return objects_[object].open >= 0; }

  /// All objects have been told of up to `ns`: who comes later has nothing to do with what was before.
  void forgetBefore(Nanoseconds ns);

  /// Stays of these two meet in space and time.
  bool mayMeet(int a, int b) const;

 private:
  struct Stay {
    std::int32_t object, next;  ///< the object's next
    Nanoseconds from_ns, to_ns;
  };
  static constexpr std::int32_t kNone = -1, kStands = -2;
  struct alignas(32) Object {
    FloatBox box;                ///< of the stay that lasts, or of who stands
    std::int32_t open = kNone;   ///< the stay that lasts, or kStands
    std::int32_t first = kNone;  ///< of its stays
  };

  template <typename Question>
  void askStanding(const Question& question);
  template <typename Question>
  void ask(int object, const Question& question, Nanoseconds from_ns, Nanoseconds to_ns);
  std::int32_t begin(int object, const FloatBox& box, Nanoseconds from_ns, Nanoseconds to_ns);
  void close(int object, Nanoseconds ns);

  void seeFrom(const Vec3& place);

  bool has_origin_ = false;
  Vec3 origin_ = Vec3::Zero();  ///< of all boxes in floats
  std::vector<Object> objects_;
  BoxTree tree_, standing_tree_;
  std::vector<Stay> stays_;
  std::vector<FloatBox> boxes_;  ///< of the stays
  std::int32_t free_ = -1;       ///< stays that are none hang together by `next`
  Endings endings_;              ///< of stays that are over
  std::vector<std::int32_t> over_;
  BoxWalk walk_;
  std::vector<int> found_;
};

}  // namespace collision_node::scene

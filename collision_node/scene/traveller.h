/// One object as proofs at a distance see it: a core that moves with its origin, and a radius round it.
///
/// Guarantee (docs/broad_phase.md): while an object goes from one released sample to another, every point
/// that the solver could find in contact with it, its rounding budget, half the contact distance and the
/// motion model's tube included, is within `radius()` of the core, whose way is at most the difference of
/// `spent()`.
#pragma once

#include "collision_node/scene/broad_phase/sweep.h"
#include "collision_node/scene/scene.h"
#include "collision_node/scene/tracks/track.h"

namespace collision_node::scene {

class Traveller {
 public:
  /// `half_distance`: half the largest contact distance of its pairs [m]. `max_gap`: of the scene [s].
  Traveller(const Object& object, double half_distance, double max_gap);

  /// Stands at `pose` for ever: the core is then the box of its links.
  void standAt(const Pose& pose);
  /// A sample was released. The radius never shrinks; what it grows by counts as way.
  void take(const Sample& sample);

  bool isFixed() const { return is_fixed_; }
  /// Rounded up. [m]
  double radius() const { return radius_; }
  /// Way and growth since the beginning, rounded up [m]: `travelled` of the newest sample plus what the
  /// radius has grown.
  double spent() const { return spentAt(travelled_); }
  /// The same at a sample, with the radius as it is now: of what is proved from there on.
  double spentAt(double travelled) const;
  /// On the newest segment [m/s]; a guess of how fast it will spend more.
  double speed() const { return speed_; }
  /// Where the core is at a sample.
  Bounds coreAt(const Track& track, std::size_t index) const;
  /// Holds the object all the way along the segment that leads to `sample`, or at `sample` where none does.
  Sweep sweepTo(const Sample& sample) const;
  /// Holds an object that stands.
  Bounds standingBox() const { return scene::grown(core_, radius_); }

 private:
  void grow(double radius);

  const Object& object_;
  bool is_fixed_ = false;
  double max_gap_, reach_ = 0.0, half_distance_;
  double radius_ = 0.0, growth_ = 0.0, travelled_ = 0.0, speed_ = 0.0;
  Bounds core_{Vec3::Zero(), Vec3::Zero()};
};

}  // namespace collision_node::scene

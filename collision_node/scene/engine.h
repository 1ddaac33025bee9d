/// Poses in, events out: tracks -> segments -> pieces -> verdicts -> events in order, with epochs and a
/// watermark.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "collision_node/impact/pair_method.h"
#include "collision_node/scene/scene.h"
#include "collision_node/scene/tracks/segment.h"

namespace collision_node::scene {

struct EventSide {
  std::string object, link, zone;
  bool zone_certain = false;
  int shape = -1;
  impact::Feature feature = impact::Feature::kUnknown;
  int triangle = -1;
  Vec3 point = Vec3::Zero();  ///< in the link's frame [m]
  Pose pose;                  ///< world <- link at toi_lower
  Nanoseconds sample_before_ns = 0, sample_after_ns = 0;
};

/// All fields of Impact.msg as plain data.
struct Event {
  std::uint32_t epoch = 0;
  std::uint64_t event_id = 0, contact_id = 0;
  Nanoseconds stamp_ns = 0;  ///< interval_start + toi_lower, rounded down
  impact::Kind kind;
  impact::Certificate certificate;
  impact::Reason reason;
  Nanoseconds interval_start_ns = 0, interval_end_ns = 0;
  double toi_lower = 0, toi_upper = 0;  ///< [s]
  Vec3 position;
  double position_error = 0;
  bool multiple = false;
  Vec3 normal;
  double normal_error = 0;
  Vec3 relative_velocity;
  double closing_speed = 0;
  double model_toi_lower, model_toi_upper, model_position_error;  ///< NaN unless asked
  EventSide a, b;
  bool opens_contact = false;  ///< a SEPARATION with this contact_id will follow, unless the data end
};

/// Heartbeat: what has been decided up to `watermark_ns`, and what it cost. Counts are since the last
/// heartbeat for pairs, totals since the engine began for inputs, costs and worst values. A heartbeat comes
/// at each whole stats_period after the epoch's first stamp (data that leap over several bring one, at the
/// last of them), at a flush and at the end of an epoch. A pair is uncovered when nothing was known of one of
/// its objects for some of the time, undecided when one was in doubt, whatever came of it.
struct Stats {
  std::uint32_t epoch = 0;
  Nanoseconds stamp_ns = 0;  ///< data time of this heartbeat
  Nanoseconds watermark_ns =
      0;  ///< everything before it is decided and published; meaningless unless has_watermark
  bool has_watermark = false;
  double latency = std::numeric_limits<double>::quiet_NaN();  ///< [s] newest stamp delivered - watermark
  std::uint64_t pairs_culled = 0, pairs_clear = 0, pairs_impact = 0,
                pairs_undecided = 0;  ///< with pairs_uncovered: all watched pairs
  std::uint64_t pairs_uncovered = 0;  ///< for some of the time since the last heartbeat, or all of it
  std::vector<std::string> uncovered_objects;  ///< waited for in vain, dropped, or with a hole since then
  std::uint64_t accepted = 0, reordered = 0, late = 0, duplicate = 0,
                rejected = 0;  ///< reordered: of the accepted
  std::uint64_t lost = 0;      ///< filled by the caller, who sees sequence numbers
  std::uint64_t holes = 0;     ///< gaps, teleports and silences through which nothing is swept
  std::optional<Hole> first_hole;
  std::string first_hole_object;
  std::uint64_t node_tests = 0, subdivisions = 0, budget_met = 0;
  double worst_bracket = 0;         ///< [s]
  double worst_position_error = 0;  ///< [m]
  double wall_time = 0;             ///< [s] filled by the caller, NaN if not measured
};

/// A stream of poses, seen from between two of them (docs/decisions/windows.md).
struct Cut {
  std::uint32_t epoch = 0;               ///< of the scene
  std::optional<Nanoseconds> newest_ns;  ///< newest stamp delivered in that epoch
  Nanoseconds span_ns = 0;               ///< how much of it has been released
  std::uint64_t state = 0;               ///< fingerprint of all that later events depend on
  bool is_settled = false;               ///< but for the tracks, nothing from before the first poses counts
};

/// None of these changes an event.
struct EngineOptions {
  /// Solves every pair on every piece, however far apart the two are.
  bool everything = false;
  int threads = 1;  ///< at most; more than one are started only where there is work for them
};

class Engine {
 public:
  struct Sinks {
    std::function<void(const Event&)> event;  ///< in order: (epoch, toi, a, b, kind)
    std::function<void(const Stats&)> stats;  ///< every stats_period of data time
  };

  /// How the pairs are solved; called once per watched pair of links.
  using MethodFactory = std::function<std::unique_ptr<impact::PairMethod>(
      const geometry::Body& a, const geometry::Body& b, const impact::PairOptions& options)>;

  /// Throws std::invalid_argument when the scene asks for what the engine cannot do, naming the object or
  /// key. Only certified pairs are ever left unsolved: another method may have its own idea of who is apart.
  Engine(std::shared_ptr<const Scene> scene, impact::MethodName method, Sinks sinks,
         const EngineOptions& options = {});
  /// The methods must be silent about pairs that are apart, unless `options.everything`.
  Engine(std::shared_ptr<const Scene> scene, const MethodFactory& make_method, Sinks sinks,
         const EngineOptions& options);
  ~Engine();

  /// Hands in one pose of `object` (index into Scene::objects), in any order. Bad poses are counted, not
  /// thrown. `guessed_stamp`: the stamp was invented by the receiver. Throws std::invalid_argument when there
  /// is no such object or it has a fixed pose. Poses of an object in no watched pair are not looked at.
  void addPose(int object, motion::StampedPose pose, bool guessed_stamp = false);

  /// `object` stands at `pose` for all time, as its source has come to say. An object that has sent poses, or
  /// is fixed already, is left as it is.
  void fix(int object, const Pose& pose);

  /// /clock went back: every track's next pose starts a new epoch.
  void clockWentBack();

  /// The end (bag end, `~flush`, shutdown): releases all, decides, publishes. Open contacts stay open.
  /// Poses may follow: every track goes on from its last pose, and nothing between is missed. As the flush
  /// published ahead of the watermark, events after it may be older than its last ones.
  void flush();

  /// `~reset`: flush, end open contacts with reason RESET, forget all poses, start a new epoch.
  void reset();

  Stats stats() const;

  /// Solves what waits, and publishes nothing ahead of the watermark.
  Cut cut();
  /// Every event of earlier epochs, and of `epoch` up to and including `stamp_ns`, has been published.
  bool hasPublished(std::uint32_t epoch, std::optional<Nanoseconds> stamp_ns) const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace collision_node::scene

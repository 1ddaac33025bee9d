#include "collision_node/scene/tracks/scene_tracks.h"

#include <stdexcept>
#include <string>

#include "collision_node/scene/needs.h"

namespace collision_node::scene {

namespace {

void check(const Scene& scene) {
  const TimeOptions& time = scene.time;
  if (time.timeout < time.max_gap + time.reorder)
    throw std::invalid_argument(
        scene.file + ": time/timeout is " + std::to_string(time.timeout) +
        " s; it must be at least max_gap + reorder = " + std::to_string(time.max_gap + time.reorder) + " s");
  if (!(scene.stats_period > 0.0))
    throw std::invalid_argument(scene.file + ": stats/period is " + std::to_string(scene.stats_period) +
                                " s; it must be positive");
}

Track makeTrack(const Object& object, Need need, const TimeOptions& time) {
  // What is in no pair stands: nobody waits for it, and its stamps are nobody's.
  if (object.source.type == PoseSource::Type::kFixed || need != Need::kWatched)
    return Track(object.source.fixed);
  TrackOptions options;
  options.motion = object.motion;
  options.on_timeout = object.on_timeout;
  options.max_speed = object.max_speed;
  options.poses_are_composed =
      object.source.type == PoseSource::Type::kTf || object.source.type == PoseSource::Type::kJoints;
  options.bounds = {object.acceleration, object.angular_acceleration, object.max_spin};
  options.reorder_ns = toNanoseconds(time.reorder);
  options.max_gap_ns = toNanoseconds(time.max_gap);
  options.jump_ns = toNanoseconds(time.jump);
  return Track(options);
}

}  // namespace

std::vector<Track> makeTracks(const Scene& scene) {
  check(scene);
  std::vector<Track> tracks;
  const std::vector<Need> needs = needsOf(scene);
  for (std::size_t i = 0; i < needs.size(); ++i)
    tracks.push_back(makeTrack(scene.objects[i], needs[i], scene.time));
  return tracks;
}

}  // namespace collision_node::scene

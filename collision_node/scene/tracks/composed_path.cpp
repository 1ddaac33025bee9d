#include "collision_node/scene/tracks/composed_path.h"

#include <algorithm>
#include <utility>

namespace collision_node::scene {

namespace {

constexpr double kHalfTurn = 3.141592653589793;

std::vector<Track> makeEdges(int count, const TimeOptions& time) {
  TrackOptions options;
  options.reorder_ns = toNanoseconds(time.reorder);
  options.max_gap_ns = toNanoseconds(time.max_gap);
  options.jump_ns = toNanoseconds(time.jump);
  return std::vector<Track>(static_cast<std::size_t>(count), Track(options));
}

}  // namespace

ComposedPath::ComposedPath(std::vector<Part> parts, int edge_count, const TimeOptions& time, Sink sink)
    : parts_(std::move(parts)),
      sink_(std::move(sink)),
      time_line_(makeEdges(edge_count, time), toNanoseconds(time.timeout)),
      index_(static_cast<std::size_t>(edge_count), 0) {}

void ComposedPath::add(int edge, const motion::StampedPose& pose, bool guessed) {
  time_line_.add(edge, pose, guessed);
  catchUp();
}

void ComposedPath::clockWentBack() {
  time_line_.clockWentBack();
  catchUp();
}

void ComposedPath::flush() {
  time_line_.releaseAll();
  catchUp();
}

void ComposedPath::catchUp() {
  walk();
  while (time_line_.epochIsOver()) {
    time_line_.closeEpoch();
    walk();
    time_line_.nextEpoch();
    begun_ = false;
    at_ns_ = std::numeric_limits<Nanoseconds>::min();
    is_anew_ = true;
    for (std::size_t i = 0; i < index_.size(); ++i) index_[i] = time_line_.tracks()[i].firstIndex();
    walk();
  }
}

/// Moves every edge up to the first instant that all of them know and go on from.
bool ComposedPath::findStart() {
  const std::vector<Track>& edges = time_line_.tracks();
  for (;;) {
    Nanoseconds start = at_ns_;
    for (std::size_t i = 0; i < edges.size(); ++i) {
      if (!edges[i].has(index_[i])) return false;
      start = std::max(start, edges[i].stamp(index_[i]));
    }
    bool all_reach = true, moved = false;
    for (std::size_t i = 0; i < edges.size(); ++i) {
      const Reach reach = edges[i].reach(index_[i]);
      // A run that ends in this very sample still holds at its stamp.
      const bool holds = edges[i].stamp(index_[i]) == start;
      if (holds || (reach.what == Reach::What::kMoves && reach.until_ns >= start)) continue;
      all_reach = false;
      if (reach.what == Reach::What::kWait || !edges[i].has(index_[i] + 1)) continue;
      ++index_[i];
      moved = true;
    }
    if (all_reach) {
      at_ns_ = start;
      return true;
    }
    if (!moved) return false;
  }
}

void ComposedPath::walk() {
  const std::vector<Track>& edges = time_line_.tracks();
  for (;;) {
    if (!begun_) {
      if (!findStart()) break;
      begun_ = true;
      bool guessed = false;
      for (std::size_t i = 0; i < edges.size(); ++i) guessed = guessed || edges[i].sample(index_[i]).guessed;
      if (at_ns_ != newest_ns_ || is_anew_)
        emit(at_ns_, {}, guessed ? impact::Reason::kStampGuessed : impact::Reason::kNone);
    }
    Nanoseconds end = std::numeric_limits<Nanoseconds>::max();
    bool breaks = false, waits = false;
    impact::Reason doubt = impact::Reason::kNone;
    for (std::size_t i = 0; i < edges.size(); ++i) {
      Reach reach = edges[i].reach(index_[i]);
      if (reach.what == Reach::What::kMoves && reach.until_ns == at_ns_) reach = edges[i].reach(++index_[i]);
      breaks = breaks || reach.what == Reach::What::kBreak;
      waits = waits || reach.what == Reach::What::kWait;
      doubt = worseDoubt(doubt, reach.doubt);
      end = std::min(end, reach.until_ns);
    }
    if (breaks) {
      begun_ = false;
      bool anyone_goes_on = false;
      for (std::size_t i = 0; i < edges.size(); ++i) {
        if (edges[i].reach(index_[i]).what != Reach::What::kBreak) continue;
        // The next run of this edge begins behind the hole; until it has one, this sample stays.
        if (edges[i].has(index_[i] + 1)) {
          ++index_[i];
          anyone_goes_on = true;
        }
      }
      if (!anyone_goes_on) break;
      continue;
    }
    if (waits) break;
    const motion::Deviation deviation = deviationTo(end);
    at_ns_ = end;
    emit(end, deviation, doubt);
  }
  letGo();
}

/// Samples that no pose to come can need.
void ComposedPath::letGo() {
  for (std::size_t i = 0; i < index_.size(); ++i) {
    const Track& edge = time_line_.tracks()[i];
    // While the edges share no time: whoever joins later joins at the watermark or behind it.
    const auto known = time_line_.watermark();
    while (!begun_ && known && edge.has(index_[i] + 1) && edge.stamp(index_[i] + 1) <= *known) ++index_[i];
    if (edge.has(index_[i])) time_line_.dropBefore(static_cast<int>(i), index_[i]);
  }
}

Pose ComposedPath::edgeAt(int edge, Nanoseconds stamp_ns) const {
  const Track& track = time_line_.tracks()[static_cast<std::size_t>(edge)];
  const std::size_t index = index_[static_cast<std::size_t>(edge)];
  if (track.stamp(index) == stamp_ns) return track.sample(index).pose.pose;
  if (track.stamp(index + 1) == stamp_ns) return track.sample(index + 1).pose.pose;
  const motion::RigidMotion& motion = track.sample(index + 1).segment.motion;
  return motion.at(motion::secondsBetween(motion.start_ns, stamp_ns));
}

motion::Deviation ComposedPath::deviationTo(Nanoseconds end_ns) const {
  std::vector<motion::ChainPart> chain;
  for (const Part& part : parts_) {
    motion::ChainPart link;
    link.inverse = part.inverse;
    if (part.edge < 0) {
      link.motion = motion::fixedAt(part.pose);
      link.from = link.to = part.pose;
    } else {
      const std::size_t index = index_[static_cast<std::size_t>(part.edge)];
      link.motion = time_line_.tracks()[static_cast<std::size_t>(part.edge)].sample(index + 1).segment.motion;
      link.from = edgeAt(part.edge, at_ns_);
      link.to = edgeAt(part.edge, end_ns);
    }
    chain.push_back(link);
  }
  return motion::slerpDeviation(chain, motion::secondsBetween(at_ns_, end_ns));
}

void ComposedPath::emit(Nanoseconds stamp_ns, const motion::Deviation& deviation, impact::Reason doubt) {
  motion::StampedPose out;
  out.stamp_ns = stamp_ns;
  bool first = true;
  for (const Part& part : parts_) {
    const Pose step = motion::walked(part.edge < 0 ? part.pose : edgeAt(part.edge, stamp_ns), part.inverse);
    out.pose = first ? step : out.pose * step;
    first = false;
  }
  out.model_position = deviation.position;
  out.model_angle = deviation.angle;
  // The edges began anew, yet behind what was handed out: the way from there is no path.
  out.begins_anew = is_anew_ && stamp_ns > newest_ns_;
  // Where the composition may have turned by half a turn, the short way round need not be its own.
  out.may_alias = doubt == impact::Reason::kAlias || deviation.angle >= kHalfTurn;
  is_anew_ = false;
  newest_ns_ = stamp_ns;
  sink_(out, doubt == impact::Reason::kStampGuessed);
}

}  // namespace collision_node::scene

/// The path of a frame that hangs on several moving ones: each follows its own poses, the path is their
/// composition.
///
/// Guarantee: every pose handed out is the composition of its edges at one stamp of one of them, each edge on
/// its own segment (straight line and slerp between its own two stamps, as tf2 does); never "latest", never
/// extrapolated. With each pose goes a bound of how far the composition strays from the straight line and
/// slerp on the segment that ends there (docs/sources.md).
#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <vector>

#include "collision_node/motion/composed_motion.h"
#include "collision_node/scene/tracks/time_line.h"

namespace collision_node::scene {

class Fingerprint;

/// The edges are tracks under the scene's own rules of order, gaps, silence and going back in time; a knot
/// comes out once every edge has released a pose at its stamp or behind it. Where an edge has a hole the path
/// has one.
class ComposedPath {
 public:
  /// One transform of the chain, parent <- child, or child <- parent when `inverse`; outermost first.
  struct Part {
    int edge = -1;  ///< -1: does not move
    bool inverse = false;
    Pose pose;  ///< of a part that does not move
  };
  /// `guessed`: the stamp of an edge's pose was invented by the receiver.
  using Sink = std::function<void(const motion::StampedPose& pose, bool guessed)>;

  /// `parts` name the edges 0 .. edge_count - 1, at least one, each once.
  ComposedPath(std::vector<Part> parts, int edge_count, const TimeOptions& time, Sink sink);

  /// A pose of one edge, in any order. A bad one belongs to whoever counts those.
  void add(int edge, const motion::StampedPose& pose, bool guessed);
  /// /clock went back: what has arrived is handed out, every edge's next pose begins anew.
  void clockWentBack();
  /// The end: hands out all that every edge has delivered. More poses may follow.
  void flush();
  /// What became of an edge's poses.
  const InputCounts& counts(int edge) const {
    return time_line_.tracks()[static_cast<std::size_t>(edge)].counts();
  }
  /// All that the poses it hands out later depend on (cut.cpp).
  void describe(Fingerprint& to) const;

 private:
  void catchUp();
  void walk();
  bool findStart();
  void letGo();
  void emit(Nanoseconds stamp_ns, const motion::Deviation& deviation, impact::Reason doubt);
  Pose edgeAt(int edge, Nanoseconds stamp_ns) const;
  motion::Deviation deviationTo(Nanoseconds end_ns) const;

  std::vector<Part> parts_;
  Sink sink_;
  TimeLine time_line_;
  std::vector<std::size_t> index_;  // of each edge: the sample that begins its current segment
  bool begun_ = false;
  Nanoseconds at_ns_ = std::numeric_limits<Nanoseconds>::min();
  Nanoseconds newest_ns_ = std::numeric_limits<Nanoseconds>::min();  // handed out last
  bool is_anew_ = false;  // nothing has been handed out since the edges went back in time
};

}  // namespace collision_node::scene

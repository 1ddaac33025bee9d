/// What the methods need to know of a set's bodies and motions.
#pragma once

#include <algorithm>

#include "collision_node/report/contestant.h"

namespace collision_node::report {

inline Answer clear() {
  Answer answer;
  answer.verdict = Verdict::kClear;
  return answer;
}
inline Answer hitAt(double seconds) {
  Answer answer;
  answer.verdict = Verdict::kHit;
  answer.toi_lower = answer.toi_upper = seconds;
  return answer;
}

/// The one shape of a body of kind `T`, at the body's origin, or null.
template <typename T>
const T* only(const geometry::Body& body) {
  if (body.shapes().size() != 1) return nullptr;
  const geometry::PlacedShape& placed = body.shapes()[0];
  const bool at_origin = placed.origin.position.isZero(0.0) && placed.origin.orientation.vec().isZero(0.0);
  return at_origin ? std::get_if<T>(&placed.shape) : nullptr;
}

/// Seconds from a piece's start to its end.
inline double durationOf(const impact::Piece& piece) {
  return motion::secondsBetween(piece.start_ns, piece.end_ns);
}

/// Seconds from the motion's first stamp to the piece's start.
inline double leadOf(const motion::RigidMotion& motion, const impact::Piece& piece) {
  return motion.fixed ? 0.0 : motion::secondsBetween(motion.start_ns, piece.start_ns);
}

/// Poses `seconds` after the piece's start. A's first position is the common origin: no method has to bear
/// the world's offset, which no caller of it needs to hand over.
inline geometry::Pose placeA(const impact::Piece& piece, double seconds) {
  motion::RigidMotion near = piece.a;
  near.c[0].setZero();
  return near.at(leadOf(near, piece) + seconds);
}
inline geometry::Pose placeB(const impact::Piece& piece, double seconds) {
  motion::RigidMotion near = piece.b;
  near.c[0] -= piece.a.c[0];
  return near.at(leadOf(near, piece) + seconds);
}

/// Whether `holds(query)` for all of a set.
template <typename Test>
bool all(const QuerySet& set, Test&& holds) {
  return std::all_of(set.queries.begin(), set.queries.end(), holds);
}

/// Straight paths throughout.
inline bool isStraight(const QuerySet& set) {
  return all(set, [](const Query& q) { return q.piece.a.isStraight() && q.piece.b.isStraight(); });
}

/// Straight paths and no turning at all.
inline bool translates(const QuerySet& set) {
  return isStraight(set) && all(set, [](const Query& q) { return !q.piece.a.turns() && !q.piece.b.turns(); });
}

/// B's origin in A's frame at the piece's start and end; for a set that translates.
struct Path {
  geometry::Vec3 start, end;
};
inline Path relativePath(const impact::Piece& piece) {
  const geometry::Quat back = piece.a.q0.conjugate();
  const double duration = durationOf(piece);
  const auto between = [&](double t) -> geometry::Vec3 {
    return back * (placeB(piece, t).position - placeA(piece, t).position);
  };
  return {between(0.0), between(duration)};
}

}  // namespace collision_node::report

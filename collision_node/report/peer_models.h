/// What the peers' adapters need to know of a set's bodies.
#pragma once

#include "collision_node/report/query_sets.h"

namespace collision_node::report {

/// The one shape of a body of kind `T`, or null. Sets place shapes at their body's origin.
template <typename T>
const T* only(const geometry::Body& body) {
  return body.shapes().size() == 1 ? std::get_if<T>(&body.shapes()[0].shape) : nullptr;
}

/// Seconds from a piece's start to its end.
inline double durationOf(const impact::Piece& piece) {
  return motion::secondsBetween(piece.start_ns, piece.end_ns);
}

/// B's origin in A's frame at the piece's start and end, for an A at rest; sets begin their segments with
/// their pieces.
struct Path {
  geometry::Vec3 start, end;
};
inline Path pathBesideRest(const impact::Piece& piece) {
  const geometry::Quat back = piece.a.q0.conjugate();
  const geometry::Vec3 start = back * (piece.b.c[0] - piece.a.c[0]);
  return {start, start + back * (durationOf(piece) * piece.b.c[1])};
}

}  // namespace collision_node::report

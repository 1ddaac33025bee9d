/// Pairs of bodies and motions of all sizes, and their supports in 240 bits from the same doubles.
#pragma once

#include "collision_node/impact/pair_piece.h"
#include "test/impact/moving_pair.h"
#include "test/oracle/interval_path.h"

namespace exact {

namespace geometry = collision_node::geometry;
namespace motion = collision_node::motion;
using collision_node::impact::Element;
using collision_node::impact::Piece;
using collision_node::impact::Vec3;
using moving::Random;
using moving::RigidMotion;
using oracle::I3;
using oracle::Interval;
using oracle::interval3;

/// Both motions of one piece; sizes of bodies and paths apart by up to twelve decades.
inline Piece sweep(Random& random, double size) {
  Piece piece;
  const auto span = static_cast<motion::Nanoseconds>(random.decade(3, 9.5));
  piece.start_ns = 1'700'000'000'000'000'000 + static_cast<motion::Nanoseconds>(random.in(0, 1e15));
  piece.end_ns = piece.start_ns + span;
  const double duration = 1e-9 * static_cast<double>(span);
  const Vec3 world = moving::randomVec(random, random.chance(0.3) ? 0.0 : random.decade(0, 8));
  const Vec3 common = moving::randomVec(random, random.chance(0.5) ? 0.0 : random.decade(0, 4.5));
  const double path = size * random.decade(-2, 3);
  for (RigidMotion* m : {&piece.a, &piece.b}) {
    m->c[0] = world + moving::randomVec(random, size * random.decade(-1, 2));
    m->q0 = random.orientation();
    if (random.chance(0.1)) {
      m->fixed = true;
      continue;
    }
    const auto outside = [&] {
      return static_cast<motion::Nanoseconds>((random.chance(0.4) ? 0.0 : random.decade(-3, 1.5)) *
                                              static_cast<double>(span));
    };
    m->start_ns = piece.start_ns - outside();
    m->end_ns = piece.end_ns + outside();
    m->c[1] = common + moving::randomVec(random, path / duration);
    if (random.chance(0.5)) {
      m->c[2] = moving::randomVec(random, path / (duration * duration));
      m->c[3] = moving::randomVec(random, path / (duration * duration * duration));
    }
    const double turn = random.chance(0.2)   ? 0.0
                        : random.chance(0.5) ? random.decade(-9, 0)
                                             : random.in(0, 3333);
    m->omega = turn / duration * random.direction();
  }
  return piece;
}

inline geometry::PlacedShape bodyOf(Random& random, double size) {
  const auto length = [&] { return size * random.decade(-1.5, 0); };
  switch (random.below(4)) {
    case 0:
      return moving::placed(geometry::Sphere{length()});
    case 1:
      return moving::placed(geometry::Cylinder{length(), length()});
    case 2:
      return moving::placed(geometry::Box{{length(), length(), length()}});
    default:
      return moving::mesh(
          {moving::randomVec(random, size), moving::randomVec(random, size), moving::randomVec(random, size)},
          {{0, 1, 2}});
  }
}

/// Exact support of the core along u, object frame.
inline Interval supportOf(const Element& e, const I3& u) {
  if (e.vertices != nullptr) {
    Interval best = dotOf(u, interval3(e.vertices[0]));
    for (int i = 1; i < e.count; ++i) {
      const Interval at = dotOf(u, interval3(e.vertices[i]));
      if (best.lo < at.lo) best.lo = at.lo;
      if (best.hi < at.hi) best.hi = at.hi;
    }
    return best;
  }
  const I3 axis = interval3(e.axis);
  Interval along = dotOf(u, axis);
  const Interval across = lengthOf(minus(u, times(along, axis)));
  if (along.hi.sign() <= 0) along = -along;
  return dotOf(u, interval3(e.centre)) + Interval(e.half_length) * along + Interval(e.rim_radius) * across;
}

inline double upper(const Interval& v) { return v.hi.toDouble(MPFR_RNDU); }

}  // namespace exact

#include "test/impact/fuzz_case.h"

#include <cstdio>
#include <sstream>

#include "collision_node/impact/pair_piece.h"
#include "test/impact/fuzz_object.h"

namespace fuzz {

namespace g = collision_node::geometry;
namespace impact = collision_node::impact;
namespace motion = collision_node::motion;
using g::Vec3;
using impact::Nanoseconds;

namespace {

/// Stamps, spin and curvature of one object; c[0] is set later.
motion::RigidMotion makeMotion(Random& random, Nanoseconds start, Nanoseconds end, double speed) {
  motion::RigidMotion m;
  const double span = static_cast<double>(end - start);
  m.start_ns = random.chance(0.5) ? start : start - static_cast<Nanoseconds>(random.in(0, 2) * span);
  m.end_ns = random.chance(0.5) ? end : end + static_cast<Nanoseconds>(random.in(0, 2) * span);
  const double segment = motion::secondsBetween(m.start_ns, m.end_ns);
  m.q0 = random.orientation();
  const double turn = random.chance(0.3) ? 0.0 : (random.chance(0.4) ? random.in(0, 1) : random.in(0, 20));
  m.omega = turn / segment * random.direction();
  if (random.chance(0.3)) {
    m.c[2] = random.in(0, 0.5) * speed / segment * random.direction();
    m.c[3] = random.in(0, 0.3) * speed / (segment * segment) * random.direction();
  }
  return m;
}

enum class Aim { kHit, kWide, kLate, kGraze, kOverlap };

}  // namespace

Case makeCase(std::uint64_t seed, int index) {
  Random random(seed, index);
  Case out;
  out.seed = seed, out.index = index;
  const auto kind_a = static_cast<ShapeKind>(random.below(kShapeKinds));
  const auto kind_b = static_cast<ShapeKind>(random.below(kShapeKinds));
  const double scale_a = random.decade(-2, 2);
  const double scale_b = std::min(1e2, std::max(1e-2, scale_a * random.decade(-1, 1)));
  const Object a = makeObject(random, kind_a, scale_a), b = makeObject(random, kind_b, scale_b);
  out.a = a.shapes, out.b = b.shapes;
  const double reach = a.reach + b.reach + (a.reach + b.reach == 0 ? scale_a : 0);

  const auto span = static_cast<Nanoseconds>(1e9 * random.decade(-3, 0));
  const double duration = 1e-9 * static_cast<double>(span);
  impact::Piece& piece = out.piece;
  piece.start_ns = 1700000000000000000 + static_cast<Nanoseconds>(random.in(0, 1e12));
  piece.end_ns = piece.start_ns + span;
  const double path = reach * random.decade(0.3, 1.7), speed = path / duration;
  piece.a = makeMotion(random, piece.start_ns, piece.end_ns, speed);
  piece.b = makeMotion(random, piece.start_ns, piece.end_ns, speed);
  const Vec3 along = random.direction();
  const Vec3 common =
      random.chance(0.5) ? Vec3(Vec3::Zero()) : Vec3(random.in(0, 1) * speed * random.direction());
  if (random.chance(0.1)) {
    const g::Quat q0 = piece.a.q0;
    piece.a = {};
    piece.a.fixed = true, piece.a.q0 = q0;
    piece.b.c[1] = speed * along;
  } else {
    piece.a.c[1] = common;
    piece.b.c[1] = common + speed * along;
  }

  const double pick = random.unit();
  const Aim aim = pick < 0.42   ? Aim::kHit
                  : pick < 0.76 ? Aim::kWide
                  : pick < 0.92 ? Aim::kLate
                  : pick < 0.97 ? Aim::kGraze
                                : Aim::kOverlap;
  constexpr const char* kAims[] = {"hit", "wide", "late", "graze", "overlap"};
  out.kind = a.kind + " - " + b.kind + ", " + kAims[static_cast<int>(aim)];
  const double at = duration * (aim == Aim::kLate      ? random.in(1.3, 2.5)
                                : aim == Aim::kOverlap ? 0.0
                                                       : random.in(0.3, 0.95));
  Vec3 side = along.cross(random.direction());
  side.normalize();

  // Both aimed points meet at the chosen time, off by `offset` sideways; the whole possibly far from the
  // origin.
  const Vec3 world = random.chance(0.25)
                         ? Vec3(1e7 * Vec3(random.in(-1, 1), random.in(-1, 1), random.in(-1, 1)).normalized())
                         : Vec3(reach * Vec3(random.in(-1, 1), random.in(-1, 1), random.in(-1, 1)));
  const auto placeAt = [&](double offset) {
    piece.a.c[0] = world;
    piece.b.c[0] = world;
    const oracle::V3 origin = oracle::exact(world);
    const oracle::Path path_a(piece.a, piece.start_ns, origin), path_b(piece.b, piece.start_ns, origin);
    const oracle::Frame fa = path_a.at(at), fb = path_b.at(at);
    const oracle::V3 shift =
        fa.place(oracle::exact(a.aim)) - fb.place(oracle::exact(b.aim)) + offset * oracle::exact(side);
    piece.b.c[0] = Vec3(static_cast<double>(world.x() + shift.x), static_cast<double>(world.y() + shift.y),
                        static_cast<double>(world.z() + shift.z));
  };
  if (aim == Aim::kWide) {
    placeAt(reach * random.in(0.6, 2));
  } else if (aim == Aim::kGraze) {
    // The offset at which the oracle's answer turns, and then a hair to either side of it.
    double hit = 0, miss = 2.5 * reach;
    for (int i = 0; i < 34; ++i) {
      const double mid = 0.5 * (hit + miss);
      placeAt(mid);
      (out.pair().firstTouch(0, duration, 0, 3000).found ? hit : miss) = mid;
    }
    placeAt(hit + (random.chance(0.5) ? 1 : -1) * reach * random.decade(-9, -2));
  } else {
    placeAt(0);
  }
  return out;
}

oracle::Pair Case::pair() const {
  return oracle::makePair(a, b, piece.a, piece.b, piece.start_ns, piece.end_ns, options.contact_distance);
}

double Case::budget() const {
  const g::Body body_a(a), body_b(b);
  return impact::PairPiece(body_a, body_b, piece, options.contact_distance).point_error;
}

double Case::duration() const { return motion::secondsBetween(piece.start_ns, piece.end_ns); }

namespace {

void put(std::ostream& out, const char* name, const Vec3& v) {
  char text[120];
  std::snprintf(text, sizeof text, " %s=(%.17g, %.17g, %.17g)", name, v.x(), v.y(), v.z());
  out << text;
}

void put(std::ostream& out, const std::vector<g::PlacedShape>& shapes) {
  out.precision(17);
  for (const g::PlacedShape& s : shapes) {
    out << "  " << s.source;
    if (const auto* sphere = std::get_if<g::Sphere>(&s.shape)) out << " radius=" << sphere->radius;
    if (const auto* box = std::get_if<g::Box>(&s.shape)) put(out, "size", box->size);
    if (const auto* c = std::get_if<g::Cylinder>(&s.shape))
      out << " radius=" << c->radius << " length=" << c->length;
    if (const auto* c = std::get_if<g::Capsule>(&s.shape))
      out << " radius=" << c->radius << " length=" << c->length;
    if (const auto* m = std::get_if<g::Mesh>(&s.shape)) {
      out << " mesh " << m->mesh->report.source << ' ' << m->mesh->triangles.size() << " triangles";
    }
    if (const auto* c = std::get_if<g::Convex>(&s.shape))
      out << " hull of " << c->mesh->vertices.size() << " points";
    put(out, "origin", s.origin.position);
    out << '\n';
  }
}

void put(std::ostream& out, const motion::RigidMotion& m, Nanoseconds piece_start) {
  if (m.fixed) out << "  fixed";
  out << "  stamps=[" << m.start_ns - piece_start << ", " << m.end_ns - piece_start
      << "] ns from the piece's start";
  for (int k = 0; k < 4; ++k) put(out, (std::string("c") + std::to_string(k)).c_str(), m.c[k]);
  put(out, "omega", m.omega);
  put(out, "q.vec", m.q0.vec());
  out << " q.w=" << m.q0.w() << '\n';
}

}  // namespace

std::string Case::describe() const {
  std::ostringstream out;
  out << "seed " << seed << " index " << index << " (" << kind
      << "), replay with COLLISION_NODE_FUZZ_INDEX=" << index << "; piece of "
      << piece.end_ns - piece.start_ns << " ns, contact_distance " << options.contact_distance
      << " m, time_precision " << options.time_precision << " s, budget " << budget() << " m\n a:\n";
  put(out, a), put(out, piece.a, piece.start_ns);
  out << " b:\n";
  put(out, b), put(out, piece.b, piece.start_ns);
  return out.str();
}

}  // namespace fuzz

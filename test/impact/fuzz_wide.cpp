/// Pairs over the full ranges of size, speed, spin and offset; aimed where the oracle says the two touch.
#include <algorithm>
#include <cmath>

#include "test/impact/fuzz_case.h"
#include "test/impact/fuzz_object.h"

namespace fuzz {

namespace g = collision_node::geometry;
namespace impact = collision_node::impact;
namespace motion = collision_node::motion;
using g::Vec3;
using impact::Nanoseconds;
using oracle::V3;

namespace {

enum class Aim { kThrough, kTouch, kWide, kGraze, kLate, kOverlap };
constexpr const char* kAims[] = {"through", "touch", "wide", "graze", "late", "overlap"};

double turnOf(Random& random) {
  const double pick = random.unit();
  if (pick < 0.3) return 0.0;
  if (pick < 0.55) return random.in(0, 1);
  if (pick < 0.8) return random.in(0, 20);
  if (pick < 0.95) return random.decade(1.3, 2.5);
  return random.decade(2.5, std::log10(3333.0));
}

/// Stamps, spin and curvature of one object; c[0] and c[1] are set later.
motion::RigidMotion makeMotion(Random& random, Nanoseconds start, Nanoseconds end, double speed) {
  motion::RigidMotion m;
  const double span = static_cast<double>(end - start);
  m.start_ns = random.chance(0.5) ? start : start - static_cast<Nanoseconds>(random.in(0, 2) * span);
  m.end_ns = random.chance(0.5) ? end : end + static_cast<Nanoseconds>(random.in(0, 2) * span);
  const double segment = motion::secondsBetween(m.start_ns, m.end_ns);
  m.q0 = random.orientation();
  m.omega = turnOf(random) / motion::secondsBetween(start, end) * random.direction();
  if (random.chance(0.3)) {
    m.c[2] = random.in(0, 0.5) * speed / segment * random.direction();
    m.c[3] = random.in(0, 0.3) * speed / (segment * segment) * random.direction();
  }
  return m;
}

/// Moves b to where its aimed point meets a's at `at` seconds, off by `offset` [m].
class Placer {
 public:
  Placer(Case& c, const Object& a, const Object& b, const Vec3& world)
      : case_(c), a_(a), b_(b), world_(world) {}

  void place(double at, const V3& offset) {
    case_.piece.a.c[0] = case_.piece.b.c[0] = world_;
    const V3 origin = oracle::exact(world_);
    const oracle::Path path_a(case_.piece.a, case_.piece.start_ns, origin);
    const oracle::Path path_b(case_.piece.b, case_.piece.start_ns, origin);
    const V3 shift =
        path_a.at(at).place(oracle::exact(a_.aim)) - path_b.at(at).place(oracle::exact(b_.aim)) + offset;
    case_.piece.b.c[0] = {static_cast<double>(world_.x() + shift.x),
                          static_cast<double>(world_.y() + shift.y),
                          static_cast<double>(world_.z() + shift.z)};
  }

  /// How far along `way` the two come apart, looked at with `touches`.
  template <class Touches>
  double boundary(double at, const V3& way, double far, int halvings, const Touches& touches) {
    double hit = 0, miss = far;
    for (int i = 0; i < halvings; ++i) {
      const double mid = 0.5 * (hit + miss);
      place(at, mid * way);
      (touches() ? hit : miss) = mid;
    }
    return hit;
  }

 private:
  Case& case_;
  const Object &a_, &b_;
  Vec3 world_;
};

Aim pickAim(Random& random) {
  const double pick = random.unit();
  return pick < 0.09   ? Aim::kThrough
         : pick < 0.23 ? Aim::kTouch
         : pick < 0.56 ? Aim::kWide
         : pick < 0.61 ? Aim::kGraze
         : pick < 0.98 ? Aim::kLate
                       : Aim::kOverlap;
}

}  // namespace

Case makeWideCase(std::uint64_t seed, int index) {
  Random random(seed ^ 0x77696465, index);
  Case out;
  out.seed = seed, out.index = index;
  const auto kind_a = static_cast<ShapeKind>(random.below(kShapeKinds));
  const auto kind_b = static_cast<ShapeKind>(random.below(kShapeKinds));
  const double scale_a = random.decade(-6, 6), spread = random.chance(0.6)   ? 1.0
                                                        : random.chance(0.6) ? 3.0
                                                                             : 12.0;
  const double scale_b = std::clamp(scale_a * random.decade(-spread, spread), 1e-6, 1e6);
  const Object a = makeObject(random, kind_a, scale_a), b = makeObject(random, kind_b, scale_b);
  out.a = a.shapes, out.b = b.shapes;
  const double reach = a.reach + b.reach + (a.reach + b.reach == 0 ? scale_a : 0);
  const double smaller = std::min(a.reach, b.reach) > 0 ? std::min(a.reach, b.reach) : reach;
  if (random.chance(0.15)) out.options.contact_distance = smaller * random.decade(-6, 0);

  const auto span = static_cast<Nanoseconds>(1e9 * random.decade(-4, 0.3));
  const double duration = 1e-9 * static_cast<double>(span);
  if (random.chance(0.4)) out.options.time_precision = 1e-14 * duration;
  impact::Piece& piece = out.piece;
  piece.start_ns = 1700000000000000000 + static_cast<Nanoseconds>(random.in(0, 1e12));
  piece.end_ns = piece.start_ns + span;
  const double path =
      std::clamp(random.chance(0.7) ? reach * random.decade(-1, 2) : random.decade(-9, 4.5), 1e-9, 3e4);
  const double speed = path / duration;
  piece.a = makeMotion(random, piece.start_ns, piece.end_ns, speed);
  piece.b = makeMotion(random, piece.start_ns, piece.end_ns, speed);
  const Vec3 along = random.direction();
  const double rest = random.unit();
  if (rest < 0.12) piece.a = motion::fixedAt({Vec3::Zero(), piece.a.q0});
  if (rest < 0.02) piece.b = motion::fixedAt({Vec3::Zero(), piece.b.q0});
  if (rest >= 0.12) {
    const Vec3 common =
        random.chance(0.5) ? Vec3(Vec3::Zero()) : Vec3(random.in(0, 3e4) * random.direction());
    piece.a.c[1] = common, piece.b.c[1] = common;
  }
  if (rest >= 0.02) piece.b.c[1] += speed * along;

  const Aim aim = pickAim(random);
  out.kind = a.kind + " - " + b.kind + ", " + kAims[static_cast<int>(aim)];
  const Vec3 world = random.chance(0.4) ? Vec3(Vec3::Zero()) : Vec3(random.decade(0, 8) * random.direction());
  const Vec3 across = along.cross(random.direction()).normalized();
  const double far = 2.5 * (reach + out.options.contact_distance);
  Placer placer(out, a, b, world);
  const auto staticBoundary = [&](double at, const V3& way, int halvings) {
    return placer.boundary(at, way, far, halvings, [&] { return out.pair().touching(at); });
  };
  const double at = duration * (aim == Aim::kLate ? random.in(1.3, 4) : random.in(0.05, 0.95));
  const V3 back = oracle::exact(Vec3(-along)), side = oracle::exact(across);
  switch (aim) {
    case Aim::kThrough:
      placer.place(at, {});
      break;
    case Aim::kTouch:
    case Aim::kLate:
      placer.place(at, staticBoundary(at, back, 50) * back);
      break;
    case Aim::kWide:
      placer.place(at, (staticBoundary(at, side, 12) + reach * random.decade(-4, 0.3)) * side);
      break;
    case Aim::kGraze: {
      const double edge = placer.boundary(at, side, far, 46,
                                          [&] { return out.pair().firstTouch(0, duration, 0, 2000).found; });
      placer.place(at, (edge + (random.chance(0.5) ? 1 : -1) * reach * random.decade(-12.5, -2)) * side);
      break;
    }
    case Aim::kOverlap:
      placer.place(0, staticBoundary(0, back, 12) * (1 - random.decade(-9, 0)) * back);
      break;
  }
  return out;
}

}  // namespace fuzz
